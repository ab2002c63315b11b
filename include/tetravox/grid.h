#pragma once

/// Any regular (or rectilinear) grid -> what rays march through.
///
/// Values stay where they are and as they are: a prepared grid adds a summary of each brick of 8^3 cells, from which a
/// renderer tells what it may skip, and how finely it must look at the rest.

#include "tetravox/dataset.h"
#include "tetravox/mesh.h"
#include "tetravox/progress.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// How the field between the values is reconstructed (docs/methods/classification.md). Cell data are constant in their
/// cell with kLinear and kNearest; with any other filter they count as values at the middles of the cells.
enum class FilterKind : std::uint8_t {
  kLinear,                ///< trilinear: exactly what the values say, and nothing between
  kNearest,               ///< constant around each value
  kBspline,               ///< cubic B-spline: smooth, blurs
  kInterpolatingBspline,  ///< cubic B-spline through the values (prefiltered; Unser, Aldroubi, Eden 1991)
  kCatmullRom,            ///< cubic, interpolates, may overshoot
  kMitchell,              ///< cubic, B = C = 1/3 (Mitchell and Netravali 1988)
  kLanczos                ///< windowed sinc
};

struct Filter {
  FilterKind kind = FilterKind::kLinear;
  int radius = 3;  ///< of kLanczos, in [2, 8]

  bool operator==(const Filter&) const = default;
};

/// "linear", "nearest", "bspline", "bspline-interpolating", "catmull-rom", "mitchell", "lanczos=N", and back.
/// @throws Error (kInvalidArgument) that lists the names there are.
std::string name_of(const Filter& filter);
Filter filter_from_name(const std::string& name);
/// Names, one-line descriptions with the paper.
std::vector<std::pair<std::string, std::string>> filter_names();

/// Cells along the side of a brick.
inline constexpr int kBrickCells = 8;

/// What is known of each brick, [bricks] with i fastest; bricks at the upper ends may hold fewer cells. Stored scalars.
struct BrickSummaries {
  std::array<std::uint32_t, 3> counts{};  ///< bricks along i, j, k
  std::vector<float> min, max;            ///< of the field in the brick; min > max where it is missing throughout
  /// [l]: bound on the distance of the field from the chord of a ray through a lattice cell of 2^l cells a side, whose
  /// corners keep their values; infinite where it was not measured (bricks that are not whole, uneven axes).
  std::array<std::vector<float>, 4> deviation;
  std::vector<std::uint8_t> has_missing;  ///< whether a value in the brick is not finite

  std::size_t count() const { return min.size(); }
};

/// A grid ready to be drawn. Views the values of `data`, which its `storage` keeps alive. Immutable once made; safe to
/// read from many threads.
///
/// Scalars: value = scalar_offset + stored * scalar_scale (a power of two), chosen as for `PreparedMesh`.
struct PreparedGrid {
  GridData data;
  BrickSummaries bricks;  ///< of the field as kLinear (point data) or kNearest (cell data) reconstructs it

  double scalar_offset = 0.0;
  double scalar_scale = 1.0;
  ValueRange scalar_range;           ///< of the finite values
  std::array<ValueRange, 3> bounds;  ///< world units
  std::uint64_t missing_values = 0;  ///< values that are not finite: the cells around are transparent
  std::vector<PreparedGrid> others;  ///< further fields of the same shape and association
};

/// Checks the grid and summarises its bricks: one pass over the values. Deterministic.
/// @throws Error: kInvalidArgument for a shape or values that make no sense, kNothingToDraw for a grid without volume
/// or without a finite value, kOutOfMemory, kCancelled.
PreparedGrid prepare_grid(const GridData& grid, const Progress& progress = {});

/// The same with `others` of the same shape and association beside it: `PreparedGrid::others`, in this order.
PreparedGrid prepare_grid(const GridData& grid, const std::vector<GridData>& others, const Progress& progress = {});

/// Bytes that `prepare_grid` holds at its peak (values not counted), and bytes of what it adds to the values; for each
/// field.
MemoryEstimate estimate_prepare_memory(const GridData& grid);

}  // namespace tetravox
