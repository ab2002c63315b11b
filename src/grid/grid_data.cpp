#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <array>
#include <string>

namespace tetravox {
namespace {

struct ScalarTypeEntry {
  const char* name;
  std::size_t bytes;
};

/// In the order of the enumerators.
constexpr std::array<ScalarTypeEntry, 10> kScalarTypes{{{"int8", 1},
                                                        {"uint8", 1},
                                                        {"int16", 2},
                                                        {"uint16", 2},
                                                        {"int32", 4},
                                                        {"uint32", 4},
                                                        {"int64", 8},
                                                        {"uint64", 8},
                                                        {"float32", 4},
                                                        {"float64", 8}}};

}  // namespace

std::string scalar_type_name(ScalarType type) { return kScalarTypes.at(static_cast<std::size_t>(type)).name; }

std::size_t scalar_type_size(ScalarType type) { return kScalarTypes.at(static_cast<std::size_t>(type)).bytes; }

ScalarType scalar_type_from_name(const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < kScalarTypes.size(); ++i) {
    if (name == kScalarTypes[i].name) return static_cast<ScalarType>(i);
    known += (i == 0 ? "" : ", ") + std::string(kScalarTypes[i].name);
  }
  throw Error(ErrorCode::kInvalidArgument, "there is no scalar type '" + name + "'; there is: " + known);
}

}  // namespace tetravox
