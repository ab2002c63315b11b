#pragma once

/// The embedded meshes, and what they have in common.

#include "tetravox/dataset.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::mesh {

inline constexpr std::uint64_t kFewestCells = 5;
inline constexpr std::uint64_t kMostCells = 500'000'000;

/// An embedded mesh as people see it.
struct BuiltinMeshEntry {
  std::string name;
  std::string description;
  std::uint64_t default_cells = 0;
};
const std::vector<BuiltinMeshEntry>& builtin_meshes();

/// Which embedded mesh is wanted.
struct BuiltinMeshRequest {
  std::uint64_t cells = 0;  ///< about so many, in [kFewestCells, kMostCells]
  ArrayRequest array;
  std::vector<ArrayRequest> others;
};

/// Makes the mesh with this entry's name. Messages and the summary call it `source`.
/// @throws Error: kInvalidArgument for an array that it has not, kOutOfMemory.
Dataset make_builtin_mesh(const BuiltinMeshEntry& entry, const BuiltinMeshRequest& request, const std::string& source);

/// Memory of an embedded mesh; `MeshData` views it.
struct BuiltinStorage {
  std::vector<double> points;
  std::vector<CellType> cell_types;
  std::vector<std::uint64_t> cell_offsets;
  std::vector<std::uint32_t> connectivity;
  std::vector<double> scalars;
  std::vector<std::vector<double>> others;
};

/// An array that an embedded mesh can be asked for.
struct BuiltinArray {
  const char* name;
  Association association;
};

/// Resizes for `points` points and `cells` cells of one type with `corners` corners; fills types and offsets.
/// @throws Error (kOutOfMemory) before anything is allocated.
BuiltinStorage make_builtin_storage(std::uint64_t points, std::uint64_t cells, CellType type, std::uint64_t corners,
                                    const std::string& name);

/// Points and cells, without scalars.
BuiltinStorage make_sphere_mesh(std::uint64_t cells);
BuiltinStorage make_buckyball_mesh(std::uint64_t cells);
BuiltinStorage make_duct_mesh(std::uint64_t cells);

/// Values of array `array` of the names above.
void fill_sphere_scalars(BuiltinStorage& storage);
void fill_buckyball_scalars(BuiltinStorage& storage);
/// 0: pressure, 1: speed (points), 2: volume (cells).
void fill_duct_scalars(BuiltinStorage& storage, std::size_t array);

}  // namespace tetravox::mesh
