#include "apps/tetravox/commands.h"
#include "apps/tetravox/json_report.h"
#include "apps/tetravox/memory_plan.h"
#include "apps/tetravox/progress_line.h"
#include "apps/tetravox/scene_input.h"
#include "apps/tetravox/text.h"

#include "tetravox/error.h"
#include "tetravox/io.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <optional>

namespace tetravox::tool {
namespace {

std::string row(const std::string& name, const std::string& text) {
  return "  " + name + std::string(10 - name.size(), ' ') + text + "\n";
}

/// "3 tetrahedra", "1 wedge".
std::string typed_count(CellType type, std::uint64_t count) {
  std::string name = cell_type_name(static_cast<std::uint8_t>(type));
  if (count != 1 && name.ends_with("hedron"))
    name.replace(name.size() - 2, 2, "a");
  else if (count != 1)
    name += "s";
  return format_count(count) + " " + name;
}

std::string cells_text(const DatasetInfo& info) {
  std::string text;
  for (const auto& [type, count] : info.cells_by_type) text += (text.empty() ? "" : ", ") + typed_count(type, count);
  if (info.cells_by_type.size() != 1) text = format_count(info.cell_count) + (text.empty() ? "" : ": ") + text;
  if (info.block_count > 1) text += "; " + format_count(info.block_count) + " blocks";
  return text;
}

std::string left_out_text(const LeftOut& left_out) {
  std::string text;
  const auto add = [&text](std::uint64_t count, const std::string& what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + format_count(count) + " " + what;
  };
  add(left_out.lower_dimension, "without volume (vertices, lines, surfaces)");
  add(left_out.ghost, "ghost");
  add(left_out.blanked, "blanked");
  add(left_out.unsupported, "of a type that is not known");
  return text;
}

std::string times_text(const DatasetInfo& info) {
  constexpr std::size_t kShown = 8;
  std::string text = format_count(info.times.size()) + ":";
  for (std::size_t i = 0; i < info.times.size() && i < kShown; ++i)
    text.append(" ").append(format_number(info.times[i], 9)).append(i == info.time_index ? "*" : "");
  if (info.times.size() > kShown) text += " ... " + format_number(info.times.back(), 9);
  return text + "  (* was read; --time picks another)";
}

std::string array_text(const ArrayInfo& array, bool is_default) {
  std::string text = array.name + (is_default ? " *" : "") + "  " +
                     (array.association == Association::kPoint ? "point" : "cell") + "  " + array.type;
  if (array.components > 1) text += " x " + std::to_string(array.components);
  text += array.components > 1 ? "  magnitude " : "  ";
  text += format_range(array.magnitude_range);
  if (array.components > 1 && array.components <= 4)
    for (std::size_t i = 0; i < array.component_ranges.size(); ++i)
      text += ", " + std::to_string(i) + ": " + format_range(array.component_ranges[i]);
  if (array.nan_count > 0) text += ", " + format_count(array.nan_count) + " not finite";
  return text;
}

/// "1, 1, 2.5".
template <class Numbers>
std::string list_text(const Numbers& numbers) {
  std::string text;
  for (const auto number : numbers) text += (text.empty() ? "" : ", ") + format_number(static_cast<double>(number), 9);
  return text;
}

/// Rows for the lattice of a grid.
std::string grid_text(const GridShape& shape) {
  std::string dimensions, spacing;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string separator = axis == 0 ? "" : ", ";
    dimensions += (axis == 0 ? "" : " x ") + std::to_string(shape.dimensions[axis]);
    const std::vector<double>& places = shape.coordinates[axis];
    spacing += separator + (places.empty() ? format_number(shape.spacing[axis], 9)
                                           : "uneven " + format_range({places.front(), places.back()}));
  }
  std::string text = row("grid", dimensions + " points") + row("spacing", spacing);
  text += row("origin", list_text(shape.origin));
  if (shape.direction != GridShape{}.direction) text += row("direction", list_text(shape.direction));
  if (std::count(shape.dimensions.begin(), shape.dimensions.end(), 1u) > 0)
    text += row("", "a single slice: there is no volume to draw");
  return text;
}

std::string memory_text(const MemoryPlan& plan, bool is_grid) {
  const std::string end = format_bytes(plan.render) + " (" + std::to_string(plan.width) + " x " +
                          std::to_string(plan.height) + "); " + format_bytes(plan.available) + " are free";
  if (is_grid)
    return "values " + format_bytes(plan.values) + " + summaries " + format_bytes(plan.resident) + " + draw " + end;
  return "prepare " + format_bytes(plan.prepare) + ", then mesh " + format_bytes(plan.resident) + " + draw " + end;
}

std::string format_info(const DatasetInfo& info, std::optional<std::size_t> default_array,
                        const std::optional<MemoryPlan>& memory) {
  std::string text = info.source + ": " + info.format + "\n";
  text += row("cells", cells_text(info));
  text += row("points", format_count(info.point_count));
  if (info.grid) text += grid_text(*info.grid);
  text += row("bounds", format_bounds(info.bounds));
  if (!info.times.empty()) text += row("times", times_text(info));
  if (const std::string left_out = left_out_text(info.left_out); !left_out.empty()) text += row("left out", left_out);
  for (std::size_t i = 0; i < info.arrays.size(); ++i)
    text += row(i == 0 ? "arrays" : "", array_text(info.arrays[i], default_array == i));
  if (info.arrays.empty()) text += row("arrays", "none: there is nothing to draw");
  if (default_array) text += row("", "(* is drawn by default)");
  if (memory) text += row("memory", memory_text(*memory, info.grid.has_value()));
  for (const std::string& note : info.notes) text += row("note", single_line(note));
  return text;
}

/// The dataset with its values, for a close estimate; without it where there is no array to draw.
Dataset read_summary(const SceneInput& input, const Progress& progress) {
  try {
    return read_dataset(input.data_path, input.read, progress);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kNothingToDraw && error.code() != ErrorCode::kOutOfMemory) throw;
  }
  ReadOptions options = input.read;
  options.only_info = true;
  return read_dataset(input.data_path, options, progress);
}

}  // namespace

void run_info(const InfoOptions& options) {
  const SceneInput input = load_scene_input(options.input);
  ProgressLine line(true);
  const Dataset dataset = read_summary(input, line.progress());
  throw_if_interrupted();
  line.clear();

  std::optional<std::size_t> default_array;
  if (!dataset.info.arrays.empty() && dataset.info.cell_count > 0) default_array = choose_array(dataset.info, {});
  std::optional<MemoryPlan> memory;
  if (dataset.mesh.cell_count() > 0 || !dataset.grid.values.empty())
    memory = plan_memory(dataset, input.scene.settings);
  std::cout << (options.use_json ? format_info_json(dataset.info, default_array, memory)
                                 : format_info(dataset.info, default_array, memory));
}

}  // namespace tetravox::tool
