#include "apps/tetravox/body.h"
#include "apps/tetravox/camera_choice.h"
#include "apps/tetravox/commands.h"
#include "apps/tetravox/interrupt.h"
#include "apps/tetravox/json_report.h"
#include "apps/tetravox/memory_plan.h"
#include "apps/tetravox/output_files.h"
#include "apps/tetravox/progress_line.h"
#include "apps/tetravox/scene_input.h"
#include "apps/tetravox/text.h"

#include "tetravox/error.h"
#include "tetravox/io.h"
#include "tetravox/visibility.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

namespace tetravox::tool {
namespace {

constexpr int kDefaultRays = 128;  // of a check, along an axis

/// Names of what is written, and that it can be, before any long work.
void check_outputs(const OrderCommandOptions& options) {
  const std::string ending = ending_of(options.output);
  if (!options.output.empty() && ending != ".npy" && ending != ".csv")
    throw UsageError("--output: '" + options.output + "' does not end in .npy or .csv");
  if (options.resolution && !options.use_check) throw UsageError("--resolution is that of the check: add --check");
  for (const std::string& path : {options.output, options.statistics}) {
    if (path.empty()) continue;
    std::error_code ignored;
    if (std::filesystem::equivalent(path, options.input.input, ignored))
      throw UsageError("name another file, this would replace the input " + path);
    require_writable(path);
  }
  if (!options.output.empty() && options.output == options.statistics)
    throw UsageError("give the order and the statistics names of their own");
}

double seconds_since(std::chrono::steady_clock::time_point& last) {
  const auto now = std::chrono::steady_clock::now();
  return std::chrono::duration<double>(now - std::exchange(last, now)).count();
}

/// The mesh and the camera; a grid has no order of cells to find.
std::pair<PreparedMesh, Camera> load_mesh(const OrderCommandOptions& options, OrderStatistics& statistics) {
  SceneInput input = load_scene_input(options.input);
  input.read.others.clear();
  ProgressLine line(true);
  auto last = std::chrono::steady_clock::now();
  const Dataset dataset = read_dataset(input.data_path, input.read, line.progress());
  statistics.read_seconds = seconds_since(last);
  throw_if_interrupted();
  if (dataset.is_grid())
    throw Error(ErrorCode::kUnsupported, input.data_path + ": is a grid; orders are those of the cells of a mesh");
  require_memory(plan_memory(dataset, input.scene.settings), input.data_path);
  Body body = prepare_body(dataset, line.progress());
  throw_if_interrupted();
  statistics.prepare_seconds = seconds_since(last);
  const Camera camera = override_camera(
      options.camera, input.scene.camera ? *input.scene.camera : complete_scene(input.scene, body).camera,
      find_middle(input.scene, body));
  line.clear();
  return {std::move(std::get<PreparedMesh>(body)), camera};
}

std::string format_csv(std::span<const std::uint32_t> order) {
  std::string text = "cell\n";
  for (const std::uint32_t cell : order) text += std::to_string(cell) + "\n";
  return text;
}

void write_order(const std::string& path, std::span<const std::uint32_t> order) {
  if (ending_of(path) == ".csv") {
    write_text_file(path, format_csv(order));
    return;
  }
  write_array(path, std::vector<double>(order.begin(), order.end()), {order.size()});
}

std::string share(std::uint64_t wrong, std::uint64_t all) { return format_count(wrong) + " of " + format_count(all); }

void print_order(const OrderStatistics& statistics) {
  const SortStatistics& sort = statistics.sort;
  const double seconds = median_sort_seconds(statistics);
  std::cout << name_of(statistics.method) << ": " << format_count(sort.cells) << " cells in "
            << format_number(1e3 * seconds, 4) << " ms, "
            << format_number(1e-6 * static_cast<double>(sort.cells) / std::max(1e-9, seconds), 3) << " M cells/s, "
            << sort.threads << " threads\n";
  if (statistics.method == SortMethod::kXmpvo)
    std::cout << "gaps: " << format_count(sort.boundary_relations) << " relations\n";
  if (statistics.method != SortMethod::kCentroid)
    std::cout << "cycles: " << format_count(sort.cycles) << " of " << format_count(sort.cyclic_cells) << " cells, "
              << format_count(sort.broken_relations) << " relations broken\n";
  if (!statistics.check) return;
  const OrderReport& check = *statistics.check;
  std::cout << "faces: " << share(check.face_violations, check.face_pairs) << " in the wrong order\n"
            << "rays: " << share(check.wrong_rays, check.rays) << " wrong, with "
            << share(check.wrong_segments, check.segments) << " segments; " << format_count(check.intersections)
            << " intersections not compared\n";
}

}  // namespace

void run_order(const OrderCommandOptions& options) {
  check_outputs(options);
  OrderStatistics statistics;
  const auto [mesh, camera] = load_mesh(options, statistics);
  statistics.method = options.method;
  statistics.mesh = mesh.report;

  auto last = std::chrono::steady_clock::now();
  VisibilitySorter sorter(mesh);
  statistics.recover_seconds = seconds_since(last);
  std::span<const std::uint32_t> order;
  ProgressLine line(false);
  for (int i = 0; i < options.repeat; ++i) {
    throw_if_interrupted();
    order = sorter.sort(camera, {options.method, options.direction, false, options.threads}, &statistics.sort,
                        line.progress());
    statistics.sort_seconds.push_back(statistics.sort.seconds);
  }
  statistics.sorter_bytes = sorter.bytes();
  if (options.use_check) {
    const auto [width, height] = options.resolution.value_or(std::array<int, 2>{kDefaultRays, kDefaultRays});
    statistics.check = check_order(mesh, camera, order, {options.direction, width, height, options.threads});
    if (!statistics.check->is_permutation) throw Error(ErrorCode::kInternal, "internal error: the order lost cells");
  }
  throw_if_interrupted();

  OutputFiles files;
  if (!options.output.empty()) files.write(options.output, [&](const std::string& path) { write_order(path, order); });
  if (!options.statistics.empty())
    files.write(options.statistics,
                [&](const std::string& path) { write_text_file(path, format_statistics(statistics)); });
  files.keep();
  print_order(statistics);
}

}  // namespace tetravox::tool
