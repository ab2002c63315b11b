/// Times all methods of visibility sorting and counts their errors, over views around each mesh. Prints the table of
/// docs/methods/sorting.md:
///
///     visibility_orders [--pixels N] [--views N] INPUT...
///
/// INPUT is a file or builtin:NAME. Cells a second are those of the median view, with all cores; violations are sums
/// over the views, perspective and orthographic in turn, the last one from inside.

#include "tetravox/error.h"
#include "tetravox/io.h"
#include "tetravox/mesh.h"
#include "tetravox/scene.h"
#include "tetravox/visibility.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using tetravox::Camera;
using tetravox::OrderReport;
using tetravox::PreparedMesh;
using tetravox::SortMethod;
using tetravox::SortStatistics;

constexpr int kRepeats = 5;

struct Settings {
  int pixels = 128, views = 6;
  std::vector<std::string> inputs;
};

/// Views round the mesh, one inside it at the end.
std::vector<Camera> make_views(const PreparedMesh& mesh, int count) {
  const Camera first = tetravox::make_default_camera(mesh.bounds, 1.0);
  std::vector<Camera> views;
  for (int i = 0; i + 1 < count; ++i) {
    views.push_back(tetravox::rotate_camera(first, 360.0 * i / (count - 1), 17.0 * i - 40.0));
    if (i % 2 == 1) {
      const double distance =
          std::hypot(first.position[0] - first.focal_point[0], first.position[1] - first.focal_point[1],
                     first.position[2] - first.focal_point[2]);
      views.back().parallel_scale = 0.27 * distance;
    }
  }
  Camera inside = first;
  for (int k = 0; k < 3; ++k)
    inside.position[k] = mesh.bounds[k].min + (0.41 + 0.13 * k) * (mesh.bounds[k].max - mesh.bounds[k].min);
  inside.view_angle = 80.0;
  views.push_back(inside);
  return views;
}

struct Row {
  std::vector<double> rates;
  OrderReport errors;
  std::uint64_t cycles = 0, cyclic_cells = 0, broken = 0, relations = 0;
  double gap_ms = 0;
};

void add_view(const PreparedMesh& mesh, const Camera& camera, SortMethod method, int pixels, Row& row) {
  tetravox::VisibilitySorter sorter(mesh);
  SortStatistics statistics;
  std::vector<double> seconds;
  for (int i = 0; i <= kRepeats; ++i) {
    sorter.sort(camera, {method, {}, false, 0}, &statistics);
    if (i > 0) seconds.push_back(statistics.seconds);  // the first one makes room
  }
  std::nth_element(seconds.begin(), seconds.begin() + kRepeats / 2, seconds.end());
  row.rates.push_back(static_cast<double>(statistics.cells) / seconds[kRepeats / 2]);
  const auto order = sorter.sort(camera, {method, {}, true, 0});
  const OrderReport report = check_order(mesh, camera, order, {{}, pixels, pixels, 0});
  if (!report.is_permutation) throw tetravox::Error(tetravox::ErrorCode::kInternal, "the order is no permutation");
  row.errors.face_pairs += report.face_pairs;
  row.errors.face_violations += report.face_violations;
  row.errors.rays += report.rays;
  row.errors.segments += report.segments;
  row.errors.wrong_segments += report.wrong_segments;
  row.errors.wrong_rays += report.wrong_rays;
  row.errors.intersections += report.intersections;
  row.gap_ms += statistics.boundary_seconds * 1e3;
  row.cycles += statistics.cycles;
  row.cyclic_cells += statistics.cyclic_cells;
  row.broken += statistics.broken_relations;
  row.relations += statistics.boundary_relations;
}

void measure(const std::string& input, const Settings& settings) {
  const PreparedMesh mesh = tetravox::prepare_mesh(tetravox::read_dataset(input).mesh);
  const std::vector<Camera> views = make_views(mesh, settings.views);
  for (const auto& [name, description] : tetravox::sort_method_names()) {
    Row row;
    for (const Camera& camera : views)
      add_view(mesh, camera, tetravox::sort_method_from_name(name), settings.pixels, row);
    std::sort(row.rates.begin(), row.rates.end());
    std::printf("| %s | %s | %.1f M | %llu of %llu | %llu of %llu | %llu | %llu (%llu) | %llu |\n", input.c_str(),
                name.c_str(), row.rates[row.rates.size() / 2] * 1e-6,
                static_cast<unsigned long long>(row.errors.face_violations),
                static_cast<unsigned long long>(row.errors.face_pairs),
                static_cast<unsigned long long>(row.errors.wrong_segments),
                static_cast<unsigned long long>(row.errors.segments),
                static_cast<unsigned long long>(row.errors.intersections), static_cast<unsigned long long>(row.cycles),
                static_cast<unsigned long long>(row.cyclic_cells), static_cast<unsigned long long>(row.relations));
    std::fflush(stdout);
  }
}

Settings parse(int argc, char** argv) {
  Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string text = argv[i];
    if ((text == "--pixels" || text == "--views") && i + 1 < argc)
      (text == "--pixels" ? settings.pixels : settings.views) = std::atoi(argv[++i]);
    else
      settings.inputs.push_back(text);
  }
  return settings;
}

}  // namespace

int main(int argc, char** argv) {
  const Settings settings = parse(argc, argv);
  std::printf(
      "| mesh | method | cells/s | face violations | pixel violations | intersections | cycles (cells) | gap relations "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|\n");
  for (const std::string& input : settings.inputs) {
    try {
      measure(input, settings);
    } catch (const tetravox::Error& error) {
      std::fprintf(stderr, "%s\n", error.what());
      return 1;
    }
  }
  return 0;
}
