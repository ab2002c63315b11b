#include "src/gl/all_programs.h"

#include "src/gl/walk_passes.h"

namespace tetravox::gl {
namespace {

constexpr Integrator kIntegrators[] = {Integrator::kAntiderivative, Integrator::kPartial, Integrator::kPost};

void add_walk(std::vector<ProgramRecipe>& programs) {
  programs.push_back({"lists", recipe_of_lists()});
  programs.push_back({"peeling", recipe_of_peeling()});
  programs.push_back({"sorting", {recipe_of_sorting()}});
  for (const EntryOrder order : {EntryOrder::kLists, EntryOrder::kPeeling}) {
    const std::string prefix = "walk by " + name_of(order) + ", ";
    for (const Integrator integrator : kIntegrators)
      programs.push_back({prefix + name_of(integrator), {recipe_of_walk(integrator, false, order)}});
    programs.push_back({prefix + "cell data", {recipe_of_walk(kIntegrators[0], true, order)}});
  }
}

}  // namespace

std::vector<ProgramRecipe> all_programs() {
  std::vector<ProgramRecipe> programs;
  add_walk(programs);
  return programs;
}

}  // namespace tetravox::gl
