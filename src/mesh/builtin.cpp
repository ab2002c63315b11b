#include "src/mesh/builtin.h"

#include "src/support/memory.h"
#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <string_view>

namespace tetravox {
namespace mesh {
namespace {

constexpr std::uint64_t kFewestCells = 5;
constexpr std::uint64_t kMostCells = 500'000'000;

/// An embedded dataset: how it is called, what it holds, how it is made.
struct Builtin {
  const char* name;
  const char* description;
  std::uint64_t default_cells;
  CellType cell_type;
  std::vector<BuiltinArray> arrays;
  BuiltinStorage (*make_mesh)(std::uint64_t cells);
  void (*fill_scalars)(BuiltinStorage& storage, std::size_t array);
};

const std::vector<Builtin>& builtins() {
  static const std::vector<Builtin> all = {
      {"sphere",
       "a ball of tetrahedra with the distance to its centre",
       2560,
       CellType::kTetrahedron,
       {{"distance", Association::kPoint}},
       make_sphere_mesh,
       [](BuiltinStorage& storage, std::size_t) { fill_sphere_scalars(storage); }},
      {"buckyball",
       "a density of 60 Gaussians at the vertices of C60, on tetrahedra",
       177'000,
       CellType::kTetrahedron,
       {{"density", Association::kPoint}},
       make_buckyball_mesh,
       [](BuiltinStorage& storage, std::size_t) { fill_buckyball_scalars(storage); }},
      {"duct",
       "flow around a pin in a bent duct, on graded hexahedra",
       33'000,
       CellType::kHexahedron,
       {{"pressure", Association::kPoint}, {"speed", Association::kPoint}, {"volume", Association::kCell}},
       make_duct_mesh,
       fill_duct_scalars}};
  return all;
}

/// What "builtin:NAME?cells=N" asks for.
struct BuiltinRequest {
  const Builtin* builtin = nullptr;
  std::uint64_t cells = 0;
};

std::uint64_t parse_cells(const std::string& name, std::string_view text) {
  std::uint64_t cells = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), cells);
  if (error != std::errc() || end != text.data() + text.size() || cells < kFewestCells || cells > kMostCells)
    throw Error(ErrorCode::kInvalidArgument, name + ": cells=" + std::string(text) + " is not a number from " +
                                                 std::to_string(kFewestCells) + " to " + std::to_string(kMostCells));
  return cells;
}

BuiltinRequest parse_request(const std::string& name) {
  std::string_view rest = name;
  if (rest.starts_with("builtin:")) rest.remove_prefix(std::string_view("builtin:").size());
  const std::size_t question = rest.find('?');
  const std::string_view wanted = rest.substr(0, question);
  BuiltinRequest request;
  std::string names;
  for (const Builtin& builtin : builtins()) {
    if (wanted == builtin.name) request.builtin = &builtin;
    names += (names.empty() ? "" : ", ") + std::string(builtin.name);
  }
  if (!request.builtin)
    throw Error(ErrorCode::kInvalidArgument,
                "there is no embedded dataset '" + std::string(wanted) + "'; there are: " + names);
  request.cells = request.builtin->default_cells;
  if (question == std::string_view::npos) return request;
  rest.remove_prefix(question + 1);
  while (true) {
    const std::string_view option = rest.substr(0, rest.find('&'));
    if (!option.starts_with("cells="))
      throw Error(ErrorCode::kInvalidArgument,
                  name + ": '" + std::string(option) + "' is not an option; there is: cells=N");
    request.cells = parse_cells(name, option.substr(std::string_view("cells=").size()));
    if (option.size() == rest.size()) return request;
    rest.remove_prefix(option.size() + 1);
  }
}

ValueRange range_of(const std::vector<double>& values, std::size_t first, std::size_t stride) {
  ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = first; i < values.size(); i += stride) {
    range.min = std::min(range.min, values[i]);
    range.max = std::max(range.max, values[i]);
  }
  return range;
}

/// Everything known of the dataset; leaves the values of array `chosen` in `storage`.
DatasetInfo describe_builtin(const std::string& source, const Builtin& builtin, BuiltinStorage& storage,
                             const ArrayRequest& request, std::size_t& chosen) {
  DatasetInfo info;
  info.source = source.rfind("builtin:", 0) == 0 ? source : "builtin:" + source;
  info.format = "embedded";
  info.point_count = storage.points.size() / 3;
  info.cell_count = storage.cell_types.size();
  info.cells_by_type = {{builtin.cell_type, info.cell_count}};
  for (std::size_t axis = 0; axis < 3; ++axis) info.bounds[axis] = range_of(storage.points, axis, 3);
  for (std::size_t i = 0; i < builtin.arrays.size(); ++i) {
    builtin.fill_scalars(storage, i);
    const ValueRange range = range_of(storage.scalars, 0, 1);
    ArrayInfo array;
    array.name = builtin.arrays[i].name;
    array.association = builtin.arrays[i].association;
    array.type = "float64";
    array.component_ranges = {range};
    array.magnitude_range = range;
    info.arrays.push_back(array);
  }
  chosen = choose_array(info, request);
  if (chosen + 1 != builtin.arrays.size()) builtin.fill_scalars(storage, chosen);
  return info;
}

}  // namespace

BuiltinStorage make_builtin_storage(std::uint64_t points, std::uint64_t cells, CellType type, std::uint64_t corners,
                                    const std::string& name) {
  support::require_memory(points * 4 * sizeof(double) + cells * (corners * 4 + 8 + 1 + sizeof(double)),
                          name + " with " + std::to_string(cells) + " cells");
  BuiltinStorage storage;
  storage.points.resize(3 * points);
  storage.cell_types.assign(cells, type);
  storage.cell_offsets.resize(cells + 1);
  storage.connectivity.resize(cells * corners);
  support::parallel_chunks(cells + 1, 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) storage.cell_offsets[i] = i * corners;
  });
  return storage;
}

}  // namespace mesh

Dataset make_builtin(const std::string& name, const ArrayRequest& request) {
  const mesh::BuiltinRequest wanted = mesh::parse_request(name);
  const auto storage = std::make_shared<mesh::BuiltinStorage>(wanted.builtin->make_mesh(wanted.cells));
  Dataset dataset;
  std::size_t chosen = 0;
  dataset.info = mesh::describe_builtin(name, *wanted.builtin, *storage, request, chosen);
  dataset.mesh.points = storage->points;
  dataset.mesh.cell_types = storage->cell_types;
  dataset.mesh.cell_offsets = storage->cell_offsets;
  dataset.mesh.connectivity = storage->connectivity;
  dataset.mesh.scalars = storage->scalars;
  dataset.mesh.association = dataset.info.arrays[chosen].association;
  dataset.mesh.array_name = dataset.info.arrays[chosen].name;
  dataset.mesh.storage = storage;
  return dataset;
}

Dataset make_builtin(const std::string& name) { return make_builtin(name, {}); }

std::vector<std::pair<std::string, std::string>> builtin_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const mesh::Builtin& builtin : mesh::builtins())
    names.emplace_back(builtin.name,
                       std::string(builtin.description) + " (" + std::to_string(builtin.default_cells) + " cells)");
  return names;
}

}  // namespace tetravox
