#include "apps/tetravox/body.h"

#include "apps/tetravox/text.h"

#include <cstddef>
#include <set>

namespace tetravox::tool {
namespace {

std::uint64_t bytes_of(const PreparedMesh& mesh) {
  std::uint64_t bytes = mesh.vertices.size() * sizeof(Vertex) + mesh.cells.size() * sizeof(TetrahedronLinks) +
                        mesh.cell_scalars.size() * sizeof(float) + mesh.boundary.size() * sizeof(BoundaryFace);
  for (const OtherScalars& other : mesh.others) bytes += other.scalars.size() * sizeof(float);
  return bytes;
}

/// Of the summaries; the values stay where they are.
std::uint64_t bytes_of(const PreparedGrid& grid) {
  std::uint64_t bytes = (grid.bricks.min.size() + grid.bricks.max.size()) * sizeof(float);
  for (const std::vector<float>& deviation : grid.bricks.deviation) bytes += deviation.size() * sizeof(float);
  for (const PreparedGrid& other : grid.others) bytes += bytes_of(other);
  return bytes + grid.bricks.has_missing.size();
}

BodyStatistics measure(const PreparedMesh& mesh) {
  BodyStatistics statistics;
  statistics.bytes = bytes_of(mesh);
  statistics.mesh = mesh.report;
  return statistics;
}

BodyStatistics measure(const PreparedGrid& grid) {
  BodyStatistics statistics;
  statistics.bytes = bytes_of(grid);
  const GridData& data = grid.data;
  GridStatistics& counts = statistics.grid.emplace();
  counts.dimensions = data.shape.dimensions;
  counts.value_bytes = data.values.size_bytes();
  counts.values = counts.value_bytes / (scalar_type_size(data.type) * static_cast<std::size_t>(data.components));
  counts.missing_values = grid.missing_values;
  counts.bricks = grid.bricks.count();
  counts.type = scalar_type_name(data.type);
  return statistics;
}

}  // namespace

Body prepare_body(const Dataset& dataset, const Progress& progress) {
  if (dataset.is_grid()) return prepare_grid(dataset.grid, dataset.other_grids, progress);
  return prepare_mesh(dataset.mesh, progress);
}

ValueRange scalar_range_of(const Body& body) {
  return std::visit([](const auto& prepared) { return prepared.scalar_range; }, body);
}

ValueRange other_range_of(const Body& body, std::size_t other) {
  if (const auto* mesh = std::get_if<PreparedMesh>(&body)) return mesh->others.at(other).range;
  return std::get<PreparedGrid>(body).others.at(other).scalar_range;
}

std::array<ValueRange, 3> bounds_of(const Body& body) {
  return std::visit([](const auto& prepared) { return prepared.bounds; }, body);
}

Histogram make_histogram(const Body& body, int bins) {
  return std::visit([&](const auto& prepared) { return tetravox::make_histogram(prepared, bins); }, body);
}

CompletedScene complete_scene(const Scene& scene, const Body& body) {
  return std::visit([&](const auto& prepared) { return tetravox::complete_scene(scene, prepared); }, body);
}

ReadArray array_of(const Dataset& dataset) {
  const auto read = [](const auto& data) { return ReadArray{data.array_name, data.association, data.component}; };
  return dataset.is_grid() ? read(dataset.grid) : read(dataset.mesh);
}

std::uint64_t value_bytes(const Dataset& dataset) {
  // Components of one array share their values.
  std::set<const std::byte*> counted{dataset.grid.values.data()};
  std::uint64_t bytes = dataset.grid.values.size_bytes();
  for (const GridData& other : dataset.other_grids)
    if (counted.insert(other.values.data()).second) bytes += other.values.size_bytes();
  return bytes;
}

std::uint64_t input_bytes(const Dataset& dataset) {
  if (dataset.is_grid()) return value_bytes(dataset);
  const MeshData& mesh = dataset.mesh;
  std::uint64_t others = 0;
  for (const OtherField& other : mesh.others) others += other.scalars.size_bytes();
  return others + mesh.points.size_bytes() + mesh.cell_types.size_bytes() + mesh.cell_offsets.size_bytes() +
         mesh.connectivity.size_bytes() + mesh.scalars.size_bytes();
}

BodyStatistics measure_body(const Body& body) {
  return std::visit([](const auto& prepared) { return measure(prepared); }, body);
}

std::string describe_preparing(const BodyStatistics& body) {
  if (body.grid) return "summarised " + format_count(body.grid->bricks) + " bricks";
  return "prepared " + format_count(body.mesh.tetrahedra) + " tetrahedra";
}

}  // namespace tetravox::tool
