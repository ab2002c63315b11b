#pragma once

/// JSON for programs: the statistics of a picture, the summary of a file.

#include "tetravox/dataset.h"
#include "tetravox/mesh.h"
#include "tetravox/render.h"
#include "tetravox/visibility.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace tetravox::tool {

/// What preparing a grid met.
struct GridStatistics {
  std::array<std::uint32_t, 3> dimensions{};
  std::string type;          ///< of the values
  std::uint64_t values = 0;  ///< tuples
  std::uint64_t missing_values = 0;
  std::uint64_t bricks = 0;
  std::uint64_t value_bytes = 0;  ///< of the values, which stay as they were read
};

/// What preparing made of a mesh or a grid.
struct BodyStatistics {
  std::uint64_t bytes = 0;             ///< the prepared mesh, or the summaries of a grid's bricks
  PrepareReport mesh;                  ///< of a mesh
  std::optional<GridStatistics> grid;  ///< set for grids
};

/// What `--statistics` writes.
struct PictureStatistics {
  double read_seconds = 0, prepare_seconds = 0, write_seconds = 0, total_seconds = 0;
  double choose_seconds = 0;             ///< function and camera, from the data where nobody says
  double transfer_function_seconds = 0;  ///< from the function to tables, at each change
  std::vector<double> frame_seconds;     ///< of each frame drawn, at least one
  RenderStatistics render;               ///< of the last frame
  BodyStatistics body;
  std::uint64_t input_bytes = 0;  ///< points, cells and scalars, or values, as read
  std::uint64_t frame_bytes = 0;  ///< camera frame and tables
  RenderSettings settings;
  std::string array;
};

/// Median of the frames after the first, or the first where it is the only one.
double median_frame_seconds(const PictureStatistics& statistics);

std::string format_statistics(const PictureStatistics& statistics);

/// What `tetravox order --statistics` writes.
struct OrderStatistics {
  double read_seconds = 0, prepare_seconds = 0;
  double recover_seconds = 0;        ///< of the sorter, before it sorts
  std::vector<double> sort_seconds;  ///< of each sort, at least one
  SortMethod method = SortMethod::kXmpvo;
  SortStatistics sort;               ///< of the last one
  std::optional<OrderReport> check;  ///< where asked for
  PrepareReport mesh;
  std::uint64_t sorter_bytes = 0;
};

/// Median of the sorts after the first, or the first where it is the only one.
double median_sort_seconds(const OrderStatistics& statistics);

std::string format_statistics(const OrderStatistics& statistics);

/// Memory that rendering needs, for `info`.
struct MemoryPlan {
  std::uint64_t prepare = 0;    ///< at the peak of preparing, beside what was read
  std::uint64_t values = 0;     ///< of a grid, as read; they stay
  std::uint64_t resident = 0;   ///< the prepared mesh, or the summaries of a grid
  std::uint64_t render = 0;     ///< camera frame, tables and picture at `width` x `height`
  std::uint64_t available = 0;  ///< that may still be allocated
  int width = 0, height = 0;
};

/// `default_array`: index of what is drawn where nobody chooses.
std::string format_info_json(const DatasetInfo& info, std::optional<std::size_t> default_array,
                             const std::optional<MemoryPlan>& memory);

}  // namespace tetravox::tool
