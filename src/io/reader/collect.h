#pragma once

/// Blocks of VTK -> one mesh, or one regular grid, in shared memory.

#include "src/io/reader/blocks.h"
#include "src/io/reader_protocol.h"

#include <vtkDataSet.h>
#include <vtkSmartPointer.h>
#include <vtkType.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

class vtkDataArray;
class vtkDataSetAttributes;

namespace tetravox::io {

/// Views of an unstructured grid's arrays, checked once so that nothing reads past them.
struct UnstructuredCells {
  const unsigned char* types = nullptr;
  const std::int64_t* offsets64 = nullptr;  ///< either these two ...
  const std::int64_t* ids64 = nullptr;
  const std::int32_t* offsets32 = nullptr;  ///< ... or these
  const std::int32_t* ids32 = nullptr;
  std::span<const vtkIdType> faces;           ///< face streams of polyhedra
  std::span<const vtkIdType> face_locations;  ///< [cells] into `faces`, negative for other cells

  std::int64_t offset(std::size_t cell) const { return offsets64 ? offsets64[cell] : offsets32[cell]; }
  std::int64_t id(std::int64_t at) const { return ids64 ? ids64[at] : ids32[at]; }
};

/// A block, which of its cells are drawn, and where its parts go.
struct Block {
  vtkSmartPointer<vtkDataSet> data;
  std::optional<UnstructuredCells> cells;  ///< empty: a lattice of hexahedra of `dimensions`
  std::array<std::int64_t, 3> dimensions{};
  std::vector<std::uint8_t> is_drawn;       ///< [cells of the block]; empty in a grid, where all are
  std::vector<std::uint8_t> is_point_used;  ///< [points of the block]; empty in a grid
  std::uint64_t point_count = 0;
  std::uint64_t cell_count = 0;  ///< drawn
  std::uint64_t connectivity_count = 0;
  std::uint64_t first_point = 0;  ///< in the mesh
  std::uint64_t first_cell = 0;
  std::uint64_t first_connectivity = 0;

  std::uint64_t all_cells = 0;  ///< of the block
};

/// Examines the blocks: which cells are drawn, what is left out and why, counts by type, bounds, ids in range. Fills in
/// everything of `info` but the arrays. Returns the blocks that have a cell to draw.
/// @throws Error (kBadFile, kUnsupported) that names the file, block and cell.
std::vector<Block> examine_blocks(const FileContents& contents, const std::string& file, DatasetInfo& info);

/// Writes coordinates and cells of one block to its places in the mesh's arrays.
struct MeshArrays {
  double* points = nullptr;
  CellType* cell_types = nullptr;
  std::uint64_t* cell_offsets = nullptr;
  std::uint32_t* connectivity = nullptr;
};
void write_block(const Block& block, const MeshArrays& mesh);

/// What is known of all numeric arrays of the blocks. An array that some blocks lack is missing there: its values count
/// as NaN, and a note says so.
/// @throws Error (kBadFile) for an array of the wrong length.
std::vector<ArrayInfo> examine_arrays(const std::vector<Block>& blocks, const std::string& file,
                                      std::vector<std::string>& notes);

/// The block's array that `info` describes; null where the block has none.
vtkDataArray* find_array(const Block& block, const ArrayInfo& info);

/// Writes a component (or the magnitude) of an array as doubles, [points] or [drawn cells] of all blocks.
void write_scalars(const std::vector<Block>& blocks, const ArrayInfo& array, int component, double* scalars);

/// One component of tuples [first, first + count) as doubles; `kMagnitude` for the length.
void convert_values(vtkDataArray& array, int component, std::size_t first, std::size_t count, double* values);

/// A block that is handed over as a regular grid.
struct GridBlock {
  Block block;
  GridShape shape;
};

/// The contents as a grid: a single block, an image or a rectilinear grid with strictly ascending or descending axes,
/// without a ghost or hidden cell or point. Empty where they are to be taken as cells of a mesh. Notes tell of what had
/// to be mended.
std::optional<GridBlock> find_grid(const FileContents& contents, std::vector<std::string>& notes);

/// Whether the grid has less than two points along an axis, and so no volume.
bool is_flat(const GridShape& shape);

/// Fills in everything of `info` but the arrays.
/// @throws Error (kBadFile) for a grid whose bounds are not finite.
void examine_grid(const GridBlock& grid, const std::string& file, DatasetInfo& info);

/// How the values of an array are handed over.
struct GridValues {
  ScalarType type = ScalarType::kFloat64;
  int components = 1;
  int component = 0;    ///< to draw, among these
  bool is_raw = false;  ///< as they stand in `array`; otherwise the one component, or magnitude, that is asked for
  std::uint64_t bytes = 0;
};

/// Arrays of up to four components stay what they are; of others one component, or the magnitude, is made.
GridValues plan_grid_values(vtkDataArray& array, int component);

/// Writes [tuples][components] values and gives the array's memory back while it does: the array is of no use after.
void move_grid_values(vtkDataArray& array, const GridValues& plan, int component, std::byte* values);

}  // namespace tetravox::io
