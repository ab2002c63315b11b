/// Times frames by functions of several variables beside those by the transfer function of one, of a mesh or a grid.
/// Prints one line for each: seconds of all cores together (the least of the repeats), and how many times the frame of
/// one variable.
///
///     domain_frames bluntfin.vtu [TOLERANCE]

#include "tetravox/analysis.h"
#include "tetravox/error.h"
#include "tetravox/io.h"
#include "tetravox/render.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

namespace {

using tetravox::OpticalFunction;
using tetravox::OpticalTable;
using tetravox::Renderer;
using tetravox::RenderSettings;
using tetravox::ValueRange;
using tetravox::VariableKind;

constexpr int kRepeats = 5;

double time_frames(Renderer& renderer, const tetravox::Camera& camera, const RenderSettings& settings) {
  std::vector<double> seconds;
  for (int i = 0; i < kRepeats; ++i) {
    const std::clock_t before = std::clock();
    renderer.render(camera, settings);
    seconds.push_back(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
  }
  return *std::min_element(seconds.begin(), seconds.end());
}

/// Value by gradient magnitude: the transfer function's colours and extinctions where the gradient is above its mean,
/// or a single widget.
OpticalTable make_table(const OpticalFunction& function, const ValueRange& values, const ValueRange& gradients,
                        double unit_distance, bool is_sparse) {
  tetravox::MultidimensionalFunction widgets;
  widgets.variables = {{VariableKind::kValue, {}, {}}, {VariableKind::kGradient, {}, {}}};
  const double value_width = values.max - values.min, gradient_width = gradients.max - gradients.min;
  widgets.widgets = {{tetravox::WidgetShape::kTriangle,
                      {values.min + 0.5 * value_width, 0.5 * gradient_width, 0},
                      {0.2 * value_width, 0.4 * gradient_width, 1},
                      {1, 0.6, 0.2},
                      0.3}};
  const std::array<ValueRange, 2> ranges{values, gradients};
  OpticalTable table = make_optical_table(widgets, ranges, unit_distance);
  if (is_sparse) return table;
  for (std::size_t i = 0; i < table.entries.size(); ++i) {
    const double x = static_cast<double>(i % table.sizes[0]) / static_cast<double>(table.sizes[0] - 1);
    const double y = static_cast<double>(i / table.sizes[0]) / static_cast<double>(table.sizes[1] - 1);
    table.entries[i] = eval_optical_function(function, values.min + x * value_width);
    table.entries[i].extinction *= std::min(1.0, 4.0 * y);
  }
  return table;
}

/// Of the gradient magnitudes that occur, without a few outliers.
template <class Prepared>
ValueRange find_gradient_range(const Prepared& prepared) {
  const auto [values, gradients, bins, gradient_bins, counts] = make_gradient_histogram(prepared);
  return gradients;
}

template <class Prepared>
void measure(const Prepared& prepared, double tolerance) {
  const tetravox::CompletedScene scene = complete_scene({}, prepared);
  const ValueRange gradients = find_gradient_range(prepared);
  OpticalFunction colors;
  for (const double t : {0.0, 0.5, 1.0})
    colors.points.push_back({prepared.scalar_range.min + t * (prepared.scalar_range.max - prepared.scalar_range.min),
                             0.0,
                             {t, 0.5, 1.0 - t}});
  RenderSettings settings;
  settings.tolerance = tolerance;
  RenderSettings lit = settings;
  lit.lighting.lights.resize(1);
  const auto side = [&](int axis) { return prepared.bounds[axis].max - prepared.bounds[axis].min; };
  const double diagonal = std::hypot(side(0), side(1), side(2));
  double single = 0.0;
  const auto report = [&](const std::string& name, const std::function<void(Renderer&)>& set) {
    Renderer renderer(prepared);
    renderer.set_transfer_function(scene.optical_function);
    set(renderer);
    for (const bool is_lit : {false, true}) {
      const double seconds = time_frames(renderer, scene.camera, is_lit ? lit : settings);
      if (single == 0.0) single = seconds;
      std::printf("%-28s%-8s%8.4f s %6.2f\n", name.c_str(), is_lit ? "lit" : "", seconds, seconds / single);
    }
  };
  report("one variable", [](Renderer&) {});
  for (const bool is_sparse : {false, true})
    report(is_sparse ? "value by gradient, a widget" : "value by gradient", [&](Renderer& renderer) {
      renderer.set_multidimensional_function(
          make_table(scene.optical_function, prepared.scalar_range, gradients, diagonal / 100.0, is_sparse));
    });
  report("colour from another array", [&](Renderer& renderer) { renderer.set_color_function(0, colors); });
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 2 && argc != 3)
      throw tetravox::Error(tetravox::ErrorCode::kInvalidArgument, "usage: domain_frames FILE [TOLERANCE]");
    const double tolerance = argc == 3 ? std::atof(argv[2]) : RenderSettings().tolerance;
    const tetravox::Dataset dataset = tetravox::read_dataset(argv[1]);
    if (dataset.is_grid()) {
      tetravox::PreparedGrid grid = prepare_grid(dataset.grid);
      grid.others.push_back(prepare_grid(dataset.grid));
      measure(grid, tolerance);
    } else {
      tetravox::PreparedMesh mesh = prepare_mesh(dataset.mesh);
      mesh.others.resize(1);
      for (const tetravox::Vertex& vertex : mesh.vertices) mesh.others[0].scalars.push_back(vertex.scalar);
      mesh.others[0].offset = mesh.scalar_offset;
      mesh.others[0].scale = mesh.scalar_scale;
      measure(mesh, tolerance);
    }
    return 0;
  } catch (const tetravox::Error& error) {
    std::fprintf(stderr, "domain_frames: %s\n", error.what());
    return 1;
  }
}
