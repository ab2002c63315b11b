#include "src/cpu/kernels/kernels.h"

#include "src/cpu/kernels/kernel_sets.h"
#include "tetravox/error.h"

#include <hwy/highway.h>

#include <cstdint>
#include <string>
#include <vector>

namespace tetravox::cpu {
namespace {

struct NamedKernels {
  std::string name;
  Kernels kernels;
};

/// Kernels of every target that this machine supports, best first, made once.
const std::vector<NamedKernels>& all_kernels() {
  static const std::vector<NamedKernels> all = [] {
    std::vector<NamedKernels> made;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::GetChosenTarget().Update(target);
      made.push_back({hwy::TargetName(target), {}});
      add_walk_kernels(made.back().kernels);
      add_march_kernels(made.back().kernels);
      add_packet_kernels(made.back().kernels);
      add_effect_kernels(made.back().kernels);
      add_table_kernels(made.back().kernels);
      add_domain_kernels(made.back().kernels);
    }
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return made;
  }();
  return all;
}

}  // namespace

std::vector<std::string> available_instruction_sets() {
  std::vector<std::string> names;
  for (const NamedKernels& named : all_kernels()) names.push_back(named.name);
  return names;
}

std::string best_instruction_set() { return all_kernels().front().name; }

const Kernels& kernels_for(const std::string& instruction_set) {
  std::string names;
  for (const NamedKernels& named : all_kernels()) {
    if (instruction_set.empty() || instruction_set == named.name) return named.kernels;
    names += (names.empty() ? "" : ", ") + named.name;
  }
  throw Error(ErrorCode::kInvalidArgument,
              "instruction set '" + instruction_set + "' is not available here: choose one of " + names);
}

}  // namespace tetravox::cpu
