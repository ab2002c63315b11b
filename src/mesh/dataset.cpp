#include "tetravox/dataset.h"

#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <tuple>
#include <vector>

namespace tetravox {
namespace {

/// Words of a name, in lower case: "GlobalNodeId" and "global_node_id" give global, node, id.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words;
  bool is_word_open = false, was_lower = false;
  for (const char character : name) {
    const unsigned char c = static_cast<unsigned char>(character);
    if (!std::isalnum(c)) {
      is_word_open = was_lower = false;
      continue;
    }
    if (!is_word_open || (std::isupper(c) && was_lower)) words.emplace_back();
    words.back() += static_cast<char>(std::tolower(c));
    is_word_open = true;
    was_lower = std::islower(c) != 0;
  }
  return words;
}

/// Whether an array numbers or marks things rather than measuring a quantity.
bool is_bookkeeping(const std::string& name) {
  if (name.rfind("vtk", 0) == 0) return true;
  static constexpr std::array<const char*, 12> kWords = {"id",   "ids",   "index",   "indices",   "ghost",    "mask",
                                                         "rank", "block", "process", "partition", "material", "region"};
  for (const std::string& word : words_of(name))
    if (std::find(kWords.begin(), kWords.end(), word) != kWords.end()) return true;
  return false;
}

bool is_constant(const ArrayInfo& array) {
  const ValueRange& range =
      array.components == 1 && !array.component_ranges.empty() ? array.component_ranges[0] : array.magnitude_range;
  return !(range.max > range.min);
}

std::string describe(const ArrayInfo& array) {
  std::string text = "'" + array.name + "' (" + (array.association == Association::kPoint ? "point" : "cell");
  if (array.components > 1) text += ", " + std::to_string(array.components) + " components";
  return text + ")";
}

std::string describe_arrays(const DatasetInfo& info) {
  constexpr std::size_t kMostNamed = 30;
  std::string text;
  for (std::size_t i = 0; i < std::min(info.arrays.size(), kMostNamed); ++i)
    text += (i == 0 ? "" : ", ") + describe(info.arrays[i]);
  if (info.arrays.size() > kMostNamed) text += " and " + std::to_string(info.arrays.size() - kMostNamed) + " more";
  return text;
}

/// What a stranger would rather see comes first: it varies, is a quantity, is a scalar, is linear in the cells.
auto preference(const ArrayInfo& array) {
  return std::make_tuple(is_constant(array), is_bookkeeping(array.name), array.components > 1,
                         array.association == Association::kCell);
}

}  // namespace

std::string cell_type_name(std::uint8_t type) {
  switch (static_cast<CellType>(type)) {
    case CellType::kTetrahedron:
      return "tetrahedron";
    case CellType::kVoxel:
      return "voxel";
    case CellType::kHexahedron:
      return "hexahedron";
    case CellType::kWedge:
      return "wedge";
    case CellType::kPyramid:
      return "pyramid";
    case CellType::kPentagonalPrism:
      return "pentagonal prism";
    case CellType::kHexagonalPrism:
      return "hexagonal prism";
    case CellType::kQuadraticTetrahedron:
      return "quadratic tetrahedron";
    case CellType::kQuadraticHexahedron:
      return "quadratic hexahedron";
    case CellType::kQuadraticWedge:
      return "quadratic wedge";
    case CellType::kQuadraticPyramid:
      return "quadratic pyramid";
    case CellType::kTriquadraticHexahedron:
      return "triquadratic hexahedron";
    case CellType::kQuadraticLinearWedge:
      return "quadratic linear wedge";
    case CellType::kBiquadraticQuadraticWedge:
      return "biquadratic quadratic wedge";
    case CellType::kBiquadraticQuadraticHexahedron:
      return "biquadratic quadratic hexahedron";
    case CellType::kTriquadraticPyramid:
      return "triquadratic pyramid";
    case CellType::kPolyhedron:
      return "polyhedron";
  }
  return "cell type " + std::to_string(type);
}

std::size_t choose_array(const DatasetInfo& info, const ArrayRequest& request) {
  const std::string source = info.source.empty() ? "the data" : info.source;
  if (info.arrays.empty())
    throw Error(ErrorCode::kNothingToDraw, source + " has no point or cell arrays: nothing to draw");
  const auto is_wanted = [&](const ArrayInfo& array) {
    return (request.name.empty() || array.name == request.name) &&
           (!request.association || array.association == *request.association) &&
           (!request.component || *request.component < array.components);
  };
  if (request.component && *request.component < kMagnitude)
    throw Error(ErrorCode::kInvalidArgument, "component " + std::to_string(*request.component) +
                                                 " makes no sense: give 0, 1, 2, ... or the magnitude");
  std::size_t chosen = info.arrays.size();
  for (std::size_t i = 0; i < info.arrays.size(); ++i)
    if (is_wanted(info.arrays[i]) &&
        (chosen == info.arrays.size() || preference(info.arrays[i]) < preference(info.arrays[chosen])))
      chosen = i;
  if (chosen < info.arrays.size()) return chosen;
  std::string wish = request.association ? (*request.association == Association::kPoint ? "point " : "cell ") : "";
  wish += request.name.empty() ? "array" : "array '" + request.name + "'";
  if (request.component) wish += " with component " + std::to_string(*request.component);
  throw Error(ErrorCode::kInvalidArgument, source + " has no " + wish + "; there are: " + describe_arrays(info));
}

std::size_t choose_other_array(const DatasetInfo& info, const ArrayRequest& request, const ArrayInfo& first) {
  if (request.name.empty())
    throw Error(ErrorCode::kInvalidArgument,
                "name the array that is wanted beside '" + first.name + "'; there are: " + describe_arrays(info));
  ArrayRequest wanted = request;
  if (!wanted.association) {
    const bool has_twin = std::any_of(info.arrays.begin(), info.arrays.end(), [&](const ArrayInfo& array) {
      return array.name == request.name && array.association == first.association;
    });
    if (has_twin) wanted.association = first.association;
  }
  const std::size_t chosen = choose_array(info, wanted);
  if (info.arrays[chosen].association != first.association)
    throw Error(ErrorCode::kInvalidArgument, describe(first) + " and " + describe(info.arrays[chosen]) +
                                                 " do not go together: give two point arrays or two cell arrays");
  return chosen;
}

int choose_component(const ArrayInfo& array, const ArrayRequest& request) {
  return array.components == 1 ? 0 : request.component.value_or(kMagnitude);
}

}  // namespace tetravox
