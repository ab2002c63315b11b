#pragma once

/// A mesh or a grid, ready to be drawn: what the commands do alike with both.

#include "apps/tetravox/json_report.h"

#include "tetravox/grid.h"
#include "tetravox/mesh.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"
#include "tetravox/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>

namespace tetravox::tool {

using Body = std::variant<PreparedMesh, PreparedGrid>;

/// The dataset's mesh or grid, prepared. @throws Error.
Body prepare_body(const Dataset& dataset, const Progress& progress);

ValueRange scalar_range_of(const Body& body);
/// Of the further field `other`.
ValueRange other_range_of(const Body& body, std::size_t other);
std::array<ValueRange, 3> bounds_of(const Body& body);
Histogram make_histogram(const Body& body, int bins);
CompletedScene complete_scene(const Scene& scene, const Body& body);

/// The array that was read, and where it has its values.
struct ReadArray {
  std::string name;
  Association association = Association::kPoint;
  int component = 0;
};
ReadArray array_of(const Dataset& dataset);

/// Bytes of the values of a grid's fields.
std::uint64_t value_bytes(const Dataset& dataset);
/// Bytes of what was read.
std::uint64_t input_bytes(const Dataset& dataset);
/// Kind, bytes and counts of what preparing made.
BodyStatistics measure_body(const Body& body);
/// "prepared 1,234 tetrahedra", "summarised 512 bricks".
std::string describe_preparing(const BodyStatistics& body);

}  // namespace tetravox::tool
