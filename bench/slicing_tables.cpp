/// Draws a grid by slices: every kind, classification and number of slices on functions that are hard to draw. Prints
/// errors against the CPU's picture at a tolerance of 1e-5, and seconds of a frame, as tables in Markdown; and how many
/// slices post-classification needs for the error of pre-integrated ones.
///
///     slicing_tables [FILE|SCENE.json] [--json RESULTS.json] [--quick]
///
/// Without a file an embedded grid is drawn. --quick: one round, and three numbers of slices.

#include "tetravox/error.h"
#include "tetravox/gl.h"
#include "tetravox/io.h"
#include "tetravox/render.h"
#include "tetravox/scene.h"
#include "tetravox/slicing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace {

using tetravox::Integrator;
using tetravox::SlabShape;
using tetravox::SlicingKind;

constexpr int kSide = 200;
constexpr const char* kEmbedded = "builtin:turbulence?size=64&type=float32&seed=4";
constexpr double kExactTolerance = 1e-5;
constexpr double kLong = 0.5;  ///< seconds of a frame that is drawn once

struct Options {
  std::string input = kEmbedded, json;
  int rounds = 3;
  std::vector<int> slices{32, 64, 128, 256, 512, 1024, 2048, 4096};
};
constexpr int kUsual = 1024;  ///< more are drawn by post-classification and view-3d only

/// How slabs are classified.
struct Method {
  const char* name;
  Integrator integrator;
  SlabShape slabs;
};
constexpr std::array<Method, 4> kMethods{{{"pre-integrated", Integrator::kAntiderivative, SlabShape::kCurved},
                                          {"pre-integrated, linear", Integrator::kAntiderivative, SlabShape::kLinear},
                                          {"post", Integrator::kPost, SlabShape::kCurved},
                                          {"pre", Integrator::kPre, SlabShape::kCurved}}};

struct Row {
  std::string function;
  SlicingKind kind = SlicingKind::kView3d;
  std::string method;
  int slices = 0;  ///< along the diagonal
  int drawn = 0;
  double max = 0.0, rms = 0.0, seconds = 0.0;
};

struct Subject {
  tetravox::PreparedGrid grid;
  tetravox::Camera camera;
};

/// The data and the view of a scene, or of a file alone.
Subject read_subject(const std::string& input) {
  tetravox::Scene scene;
  scene.data.file = input;
  if (input.ends_with(".json")) {
    std::ostringstream text;
    text << std::ifstream(input).rdbuf();
    scene = tetravox::parse_scene(text.str(), input);
    scene.data.file = (std::filesystem::path(input).parent_path() / scene.data.file).string();
  }
  tetravox::Dataset dataset = scene.data.file.starts_with("builtin:")
                                  ? tetravox::make_builtin(scene.data.file.substr(8))
                                  : tetravox::read_dataset(scene.data.file);
  if (!dataset.is_grid())
    throw tetravox::Error(tetravox::ErrorCode::kInvalidArgument, "'" + input + "' is a mesh: give a grid");
  Subject subject;
  subject.grid = prepare_grid(dataset.grid);
  subject.camera = complete_scene(scene, subject.grid).camera;
  return subject;
}

/// Largest and root mean square difference over all pixels and channels.
std::array<double, 2> compare(const tetravox::Image& a, const tetravox::Image& b) {
  double most = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const double difference = std::abs(static_cast<double>(a.pixels[i]) - b.pixels[i]);
    most = std::max(most, difference);
    squares += difference * difference;
  }
  return {most, std::sqrt(squares / static_cast<double>(a.pixels.size()))};
}

Row measure(tetravox::Renderer& renderer, const tetravox::Camera& camera, const tetravox::RenderSettings& settings,
            const tetravox::Image& exact, int rounds) {
  Row row;
  row.kind = settings.slicing.kind;
  row.slices = settings.slicing.slices;
  std::vector<double> seconds;
  tetravox::RenderStatistics statistics;
  for (int i = 0; i < rounds; ++i) {
    const tetravox::Image image = renderer.render(camera, settings, &statistics);
    seconds.push_back(statistics.seconds);
    const auto [most, rms] = compare(image, exact);
    row.max = most;
    row.rms = rms;
    if (statistics.seconds > kLong) break;
  }
  std::sort(seconds.begin(), seconds.end());
  row.seconds = seconds[seconds.size() / 2];
  row.drawn = statistics.slices;
  return row;
}

struct NamedFunction {
  std::string name;
  tetravox::OpticalFunction function;
};

/// A smooth ramp, and two that are hard to draw: eight narrow peaks, and points at random.
std::vector<NamedFunction> make_functions(const tetravox::ValueRange& range, double diagonal) {
  const double peak = 12.0 / diagonal;
  const auto value = [&](double t) { return range.min + t * (range.max - range.min); };
  const auto color = [](double t) { return tetravox::Color{t, 0.3 + 0.6 * std::abs(2.0 * t - 1.0), 1.0 - t}; };
  std::vector<NamedFunction> functions{{"smooth", {}}, {"spikes", {}}, {"random", {}}};
  for (int i = 0; i <= 8; ++i)
    functions[0].function.points.push_back({value(i / 8.0), peak * i * i / 64.0, color(i / 8.0)});
  for (int i = 0; i < 8; ++i)
    for (const int side : {-1, 0, 1})
      functions[1].function.points.push_back(
          {value((i + 0.6) / 8.0 + 0.01 * side), side == 0 ? 10.0 * peak : 0.0, color(i / 8.0)});
  std::mt19937 random(11);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (int i = 0; i < 64; ++i)
    functions[2].function.points.push_back(
        {value(i / 63.0), 2.0 * peak * std::pow(unit(), 4.0), {unit(), unit(), unit()}});
  return functions;
}

std::vector<Row> measure_all(const Subject& subject, const Options& options) {
  std::vector<Row> rows;
  tetravox::Renderer gl = tetravox::make_gl_renderer(subject.grid), cpu(subject.grid);
  const auto side = [&](std::size_t axis) { return subject.grid.bounds[axis].max - subject.grid.bounds[axis].min; };
  const double diagonal = std::hypot(side(0), side(1), side(2));
  for (const auto& [name, function] : make_functions(subject.grid.scalar_range, diagonal)) {
    gl.set_transfer_function(function);
    cpu.set_transfer_function(function);
    tetravox::RenderSettings settings;
    settings.width = settings.height = kSide;
    settings.tolerance = kExactTolerance;
    settings.use_early_ray_termination = false;
    const tetravox::Image exact = cpu.render(subject.camera, settings);
    settings.tolerance = tetravox::RenderSettings().tolerance;
    settings.source = tetravox::Source::kSlices;
    for (const auto& [kind, description] : tetravox::slicing_kind_names())
      for (const Method& method : kMethods)
        for (const int slices : options.slices) {
          if (slices > kUsual && (method.integrator != Integrator::kPost || kind != "view-3d")) continue;
          settings.slicing.kind = tetravox::slicing_kind_from_name(kind);
          settings.slicing.slices = slices;
          settings.slicing.slabs = method.slabs;
          settings.integrator = method.integrator;
          Row row = measure(gl, subject.camera, settings, exact, options.rounds);
          row.function = name;
          row.method = method.name;
          rows.push_back(row);
          std::fprintf(stderr, "%s %s %s %d: %.2e\n", name.c_str(), kind.c_str(), method.name, slices, row.rms);
          if (settings.slicing.kind == SlicingKind::kObject2d) break;  // as many as there are textures
        }
  }
  return rows;
}

void print_errors(const std::vector<Row>& rows) {
  std::printf(
      "\n## Slices against error and time\n\n| function | kind | classification | slices | drawn | max | RMS | seconds "
      "|\n|---|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    const std::string slices = row.kind == SlicingKind::kObject2d ? "all" : std::to_string(row.slices);
    std::printf("| %s | %s | %s | %s | %d | %.1e | %.1e | %.3f |\n", row.function.c_str(), name_of(row.kind).c_str(),
                row.method.c_str(), slices.c_str(), row.drawn, row.max, row.rms, row.seconds);
  }
}

/// Slices that post-classification needs for an RMS, between those measured; empty where all of them are worse.
std::optional<double> slices_for(const std::vector<Row>& rows, const Row& wanted) {
  const Row* before = nullptr;
  for (const Row& row : rows) {
    if (row.function != wanted.function || row.kind != wanted.kind || row.method != "post") continue;
    if (row.rms <= wanted.rms) {
      if (!before) return row.slices;
      const double share = std::log(before->rms / wanted.rms) / std::log(before->rms / row.rms);
      return before->slices * std::pow(static_cast<double>(row.slices) / before->slices, share);
    }
    before = &row;
  }
  return {};
}

void print_quarters(const std::vector<Row>& rows, const Options& options) {
  std::printf(
      "\n## Slices of post-classification for the error of pre-integrated ones\n\n| function | kind | classification | "
      "slices | RMS | slices of post for that | times "
      "|\n|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    if (!row.method.starts_with("pre-integrated") || row.kind == SlicingKind::kObject2d) continue;
    const std::optional<double> needed = slices_for(rows, row);
    const int most = std::min(options.slices.back(), row.kind == SlicingKind::kView3d ? options.slices.back() : kUsual);
    const std::string text = needed ? std::to_string(std::lround(*needed)) : "> " + std::to_string(most);
    const double times = (needed ? *needed : most) / row.slices;
    std::printf("| %s | %s | %s | %d | %.1e | %s | %s%.1f |\n", row.function.c_str(), name_of(row.kind).c_str(),
                row.method.c_str(), row.slices, row.rms, text.c_str(), needed ? "" : "> ", times);
  }
}

void write_json(const std::vector<Row>& rows, const std::string& file) {
  std::ofstream out(file);
  out << "{\"slicing\": [";
  const char* separator = "\n";
  for (const Row& row : rows) {
    char line[512];
    std::snprintf(
        line, sizeof(line),
        "%s  {\"function\": \"%s\", \"kind\": \"%s\", \"classification\": \"%s\", \"slices\": %d, \"drawn\": %d, "
        "\"max\": %.6e, \"rms\": %.6e, \"seconds\": %.6f}",
        separator, row.function.c_str(), name_of(row.kind).c_str(), row.method.c_str(), row.slices, row.drawn, row.max,
        row.rms, row.seconds);
    out << line;
    separator = ",\n";
  }
  out << "\n]}\n";
  if (!out.flush()) throw tetravox::Error(tetravox::ErrorCode::kCannotWrite, "cannot write '" + file + "'");
}

Options read_options(int argc, char** argv) {
  Options options;
  bool has_input = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick") {
      options.rounds = 1;
      options.slices = {32, 128, 512};
    } else if (word == "--json" && i + 1 < argc) {
      options.json = argv[++i];
    } else if (!has_input && !word.starts_with("--")) {
      options.input = word;
      has_input = true;
    } else {
      throw tetravox::Error(tetravox::ErrorCode::kInvalidArgument,
                            "usage: slicing_tables [FILE|SCENE.json] [--json RESULTS.json] [--quick]");
    }
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = read_options(argc, argv);
    std::printf("# Slicing\n\n");
    if (tetravox::gl_devices().empty()) {
      std::printf("There is no device with OpenGL 4.5 by EGL: nothing was measured.\n");
      return 0;
    }
    const Subject subject = read_subject(options.input);
    const auto& points = subject.grid.data.shape.dimensions;
    std::printf("Of `%s`, %u x %u x %u values, %d x %d pixels.\n", options.input.c_str(), points[0], points[1],
                points[2], kSide, kSide);
    const std::vector<Row> rows = measure_all(subject, options);
    print_errors(rows);
    print_quarters(rows, options);
    if (!options.json.empty()) write_json(rows, options.json);
    return 0;
  } catch (const tetravox::Error& error) {
    std::fprintf(stderr, "slicing_tables: %s\n", error.what());
    return 1;
  }
}
