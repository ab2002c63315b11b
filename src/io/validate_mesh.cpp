#include "src/io/validate_mesh.h"

#include "src/support/threads.h"
#include "tetravox/error.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

namespace tetravox::io {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 16;

[[noreturn]] void fail(const std::string& file, const std::string& what) {
  throw Error(ErrorCode::kBadFile, "'" + file + "': " + what + "; the file is damaged, write it again");
}

/// The least index in [0, count) for which `is_bad` holds, found in parallel.
template <class Predicate>
std::optional<std::size_t> find_first(std::size_t count, const Predicate& is_bad) {
  std::atomic<std::size_t> first{count};
  support::parallel_chunks(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && i < first.load(std::memory_order_relaxed); ++i) {
      if (!is_bad(i)) continue;
      std::size_t known = first.load();
      while (i < known && !first.compare_exchange_weak(known, i)) {
      }
      return;
    }
  });
  if (first.load() == count) return std::nullopt;
  return first.load();
}

/// Whether a face stream (face count, then for each face its point count and point ids) is whole.
bool is_face_stream(std::span<const std::uint32_t> stream, std::size_t point_count) {
  if (stream.empty() || stream[0] < 4) return false;
  std::size_t at = 1;
  for (std::uint32_t face = 0; face < stream[0]; ++face) {
    if (at >= stream.size()) return false;
    const std::size_t corners = stream[at++];
    if (corners < 3 || corners > stream.size() - at) return false;
    for (std::size_t i = 0; i < corners; ++i)
      if (stream[at + i] >= point_count) return false;
    at += corners;
  }
  return at == stream.size();
}

void validate_sizes(const MeshData& mesh, const std::string& file) {
  if (mesh.points.size() % 3 != 0) fail(file, "the coordinates are not triples");
  if (mesh.point_count() >= std::numeric_limits<std::uint32_t>::max()) fail(file, "more than 2^32 - 2 points");
  if (mesh.cell_count() >= std::numeric_limits<std::uint32_t>::max()) fail(file, "more than 2^32 - 2 cells");
  if (mesh.cell_offsets.size() != mesh.cell_count() + 1) fail(file, "the cell offsets do not fit the number of cells");
  const std::size_t values = mesh.association == Association::kPoint ? mesh.point_count() : mesh.cell_count();
  const auto validate_size = [&](const std::string& name, std::size_t size) {
    if (size != values)
      fail(file, "array '" + name + "' has " + std::to_string(size) + " values instead of " + std::to_string(values));
  };
  validate_size(mesh.array_name, mesh.scalars.size());
  for (const OtherField& other : mesh.others) validate_size(other.array_name, other.scalars.size());
}

void validate_offsets(const MeshData& mesh, const std::string& file) {
  const auto offsets = mesh.cell_offsets;
  if (offsets.front() != 0 || offsets.back() != mesh.connectivity.size())
    fail(file, "the cell offsets do not fit the connectivity");
  const auto bad = find_first(mesh.cell_count(), [&](std::size_t i) { return offsets[i] >= offsets[i + 1]; });
  if (bad) fail(file, "cell " + std::to_string(*bad) + ": the cell offsets do not ascend");
}

bool is_bad_cell(const MeshData& mesh, std::size_t i) {
  const auto ids = mesh.connectivity.subspan(mesh.cell_offsets[i], mesh.cell_offsets[i + 1] - mesh.cell_offsets[i]);
  if (mesh.cell_types[i] == CellType::kPolyhedron) return !is_face_stream(ids, mesh.point_count());
  const int corners = corner_count(mesh.cell_types[i]);
  if (corners == 0 || ids.size() < static_cast<std::size_t>(corners)) return true;
  for (const std::uint32_t id : ids)
    if (id >= mesh.point_count()) return true;
  return false;
}

/// Says what is wrong with a cell that `is_bad_cell`.
std::string describe_bad_cell(const MeshData& mesh, std::size_t i) {
  const std::string place = "cell " + std::to_string(i) + ": ";
  const CellType type = mesh.cell_types[i];
  const std::size_t size = mesh.cell_offsets[i + 1] - mesh.cell_offsets[i];
  if (type == CellType::kPolyhedron) return place + "the faces of a polyhedron are inconsistent";
  const int corners = corner_count(type);
  if (corners == 0) return place + "unknown cell type " + std::to_string(static_cast<int>(type));
  if (size < static_cast<std::size_t>(corners))
    return place + std::to_string(size) + " points where its type needs " + std::to_string(corners);
  return place + "a point id is not below the number of points, " + std::to_string(mesh.point_count());
}

}  // namespace

int corner_count(CellType type) {
  switch (type) {
    case CellType::kTetrahedron:
      return 4;
    case CellType::kVoxel:
    case CellType::kHexahedron:
      return 8;
    case CellType::kWedge:
      return 6;
    case CellType::kPyramid:
      return 5;
    case CellType::kPentagonalPrism:
      return 10;
    case CellType::kHexagonalPrism:
      return 12;
    case CellType::kQuadraticTetrahedron:
      return 10;
    case CellType::kQuadraticHexahedron:
      return 20;
    case CellType::kQuadraticWedge:
      return 15;
    case CellType::kQuadraticPyramid:
      return 13;
    case CellType::kTriquadraticHexahedron:
      return 27;
    case CellType::kQuadraticLinearWedge:
      return 12;
    case CellType::kBiquadraticQuadraticWedge:
      return 18;
    case CellType::kBiquadraticQuadraticHexahedron:
      return 24;
    case CellType::kTriquadraticPyramid:
      return 19;
    case CellType::kPolyhedron:
      return 0;
  }
  return 0;
}

void validate_mesh(const MeshData& mesh, const std::string& file) {
  validate_sizes(mesh, file);
  validate_offsets(mesh, file);
  const auto bad_cell = find_first(mesh.cell_count(), [&](std::size_t i) { return is_bad_cell(mesh, i); });
  if (bad_cell) fail(file, describe_bad_cell(mesh, *bad_cell));
  const auto bad_point = find_first(mesh.points.size(), [&](std::size_t i) { return !std::isfinite(mesh.points[i]); });
  if (bad_point) fail(file, "point " + std::to_string(*bad_point / 3) + ": a coordinate is not finite");
}

}  // namespace tetravox::io
