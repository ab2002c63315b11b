/// Names of sort methods, for command lines.

#include "tetravox/error.h"
#include "tetravox/visibility.h"

#include <array>
#include <string_view>

namespace tetravox {
namespace {

struct Name {
  SortMethod value;
  std::string_view name;
  std::string_view description;
};

constexpr std::array<Name, 4> kSortMethods{
    {{SortMethod::kCentroid, "centroid",
      "distance of centroids, radix sort; for comparison, and when only speed counts"},
     {SortMethod::kMpvo, "mpvo", "meshed polyhedra visibility ordering: exact for convex meshes (Williams 1992)"},
     {SortMethod::kMpvonc, "mpvonc", "his heuristic for other meshes, depth first from the boundary (Williams 1992)"},
     {SortMethod::kXmpvo, "xmpvo",
      "with relations across gaps: exact for all meshes without cycles (Silva, Mitchell, Williams 1998)"}}};

}  // namespace

std::string name_of(SortMethod method) {
  for (const Name& entry : kSortMethods)
    if (entry.value == method) return std::string(entry.name);
  throw Error(ErrorCode::kInvalidArgument, "an enumerator without a name: " + std::to_string(static_cast<int>(method)));
}

SortMethod sort_method_from_name(const std::string& name) {
  std::string known;
  for (const Name& entry : kSortMethods) {
    if (entry.name == name) return entry.value;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw Error(ErrorCode::kInvalidArgument, "there is no sort method '" + name + "'; there is: " + known);
}

std::vector<std::pair<std::string, std::string>> sort_method_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const Name& entry : kSortMethods) names.emplace_back(entry.name, entry.description);
  return names;
}

}  // namespace tetravox
