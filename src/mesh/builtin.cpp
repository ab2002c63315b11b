#include "src/mesh/builtin.h"

#include "src/support/check.h"
#include "src/support/memory.h"
#include "src/support/threads.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>

namespace tetravox::mesh {
namespace {

/// An embedded mesh: how it is called, what it holds, how it is made.
struct Builtin {
  BuiltinMeshEntry entry;
  CellType cell_type;
  std::vector<BuiltinArray> arrays;
  BuiltinStorage (*make_mesh)(std::uint64_t cells);
  void (*fill_scalars)(BuiltinStorage& storage, std::size_t array);
};

const std::vector<Builtin>& builtins() {
  static const std::vector<Builtin> all = {
      {{"sphere", "a ball of tetrahedra with the distance to its centre", 2560},
       CellType::kTetrahedron,
       {{"distance", Association::kPoint}},
       make_sphere_mesh,
       [](BuiltinStorage& storage, std::size_t) { fill_sphere_scalars(storage); }},
      {{"buckyball", "a density of 60 Gaussians at the vertices of C60, on tetrahedra", 177'000},
       CellType::kTetrahedron,
       {{"density", Association::kPoint}},
       make_buckyball_mesh,
       [](BuiltinStorage& storage, std::size_t) { fill_buckyball_scalars(storage); }},
      {{"duct", "flow around a pin in a bent duct, on graded hexahedra", 33'000},
       CellType::kHexahedron,
       {{"pressure", Association::kPoint}, {"speed", Association::kPoint}, {"volume", Association::kCell}},
       make_duct_mesh,
       fill_duct_scalars}};
  return all;
}

ValueRange range_of(const std::vector<double>& values, std::size_t first, std::size_t stride) {
  ValueRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (std::size_t i = first; i < values.size(); i += stride) {
    range.min = std::min(range.min, values[i]);
    range.max = std::max(range.max, values[i]);
  }
  return range;
}

/// Everything known of the mesh; leaves the values of its last array in `storage`.
DatasetInfo describe_builtin(const std::string& source, const Builtin& builtin, BuiltinStorage& storage) {
  DatasetInfo info;
  info.source = source;
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
  return info;
}

/// Makes the values of the arrays that are asked for, and views them.
void add_fields(const DatasetInfo& info, const Builtin& builtin, const BuiltinMeshRequest& request,
                BuiltinStorage& storage, MeshData& mesh) {
  const std::size_t chosen = choose_array(info, request.array);
  mesh.association = info.arrays[chosen].association;
  mesh.array_name = info.arrays[chosen].name;
  support::require_memory(request.others.size() * storage.scalars.size() * sizeof(double),
                          info.source + " with further arrays");
  for (const ArrayRequest& other : request.others) {
    const std::size_t index = choose_other_array(info, other, info.arrays[chosen]);
    builtin.fill_scalars(storage, index);
    storage.others.push_back(std::move(storage.scalars));
    mesh.others.push_back({storage.others.back(), info.arrays[index].name, 0});
  }
  builtin.fill_scalars(storage, chosen);
  mesh.scalars = storage.scalars;
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

const std::vector<BuiltinMeshEntry>& builtin_meshes() {
  static const std::vector<BuiltinMeshEntry> entries = [] {
    std::vector<BuiltinMeshEntry> all;
    for (const Builtin& builtin : builtins()) all.push_back(builtin.entry);
    return all;
  }();
  return entries;
}

Dataset make_builtin_mesh(const BuiltinMeshEntry& entry, const BuiltinMeshRequest& request, const std::string& source) {
  const auto builtin = std::find_if(builtins().begin(), builtins().end(),
                                    [&](const Builtin& one) { return one.entry.name == entry.name; });
  TETRAVOX_CHECK_LT(std::distance(builtins().begin(), builtin), std::ssize(builtins()));
  const auto storage = std::make_shared<BuiltinStorage>(builtin->make_mesh(request.cells));
  Dataset dataset;
  dataset.info = describe_builtin(source, *builtin, *storage);
  add_fields(dataset.info, *builtin, request, *storage, dataset.mesh);
  dataset.mesh.points = storage->points;
  dataset.mesh.cell_types = storage->cell_types;
  dataset.mesh.cell_offsets = storage->cell_offsets;
  dataset.mesh.connectivity = storage->connectivity;
  dataset.mesh.storage = storage;
  return dataset;
}

}  // namespace tetravox::mesh
