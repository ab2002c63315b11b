/// Measures the papers' tables of cell projection again, on OpenGL: frames a second by order, by source and by
/// integrator. Prints Markdown.
///
///     projection_tables [--shared DIR] [--json FILE] [--quick]
///
/// Each frame looks from one degree further round the data, so that every order is made anew. Of the papers stands
/// beside what could be looked up; "not at hand" is what could not.

#include "tetravox/error.h"
#include "tetravox/gl.h"
#include "tetravox/io.h"
#include "tetravox/scene.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace {

using tetravox::CellSort;
using tetravox::Integrator;
using tetravox::MeshTransfer;
using tetravox::PreparedMesh;
using tetravox::Renderer;
using tetravox::RenderSettings;
using tetravox::RenderStatistics;
using tetravox::Source;
using Json = nlohmann::ordered_json;

const char* const kNotAtHand = "not at hand";
const char* const kNone = "-";  // the paper has no such row

struct Options {
  std::filesystem::path shared = "../shared";
  std::string json;
  int frames = 5;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Medians over some frames, the first one not counted.
Json measure(const PreparedMesh& mesh, const RenderSettings& settings, int frames) {
  const tetravox::CompletedScene scene = complete_scene({}, mesh);
  Renderer renderer = make_gl_renderer(mesh);
  renderer.set_transfer_function(scene.optical_function);
  std::vector<double> all, sort, decompose;
  RenderStatistics drawn;
  for (int i = 0; i <= frames; ++i) {
    renderer.render(rotate_camera(scene.camera, i, 0.0), settings, &drawn);
    if (i == 0) continue;
    all.push_back(drawn.seconds);
    sort.push_back(drawn.projection.sort_seconds);
    decompose.push_back(drawn.projection.decompose_seconds);
  }
  return {{"frames_per_second", 1.0 / median(all)}, {"seconds", median(all)},     {"sort_seconds", median(sort)},
          {"decompose_seconds", median(decompose)}, {"segments", drawn.segments}, {"cycles", drawn.projection.cycles}};
}

/// Tables on the page and in the file.
class Report {
 public:
  explicit Report(Options options) : options_(std::move(options)) {}

  void begin(const std::string& key, const std::string& title) {
    key_ = key;
    json_[key] = {{"title", title}, {"rows", Json::array()}};
    std::cout << "\n## " << title
              << "\n\n| data | cells | method | frames/s | frame (s) | sort (s) | triangles (s) | paper: frames/s "
                 "|\n|---|---|---|---|---|---|---|---|\n";
  }

  void add(const std::string& data, const PreparedMesh& mesh, const std::string& method, const RenderSettings& settings,
           const char* paper) {
    Json row = measure(mesh, settings, options_.frames);
    std::array<char, 160> numbers{};
    std::snprintf(numbers.data(), numbers.size(), "%.3g | %.3g | %.3g | %.3g", row["frames_per_second"].get<double>(),
                  row["seconds"].get<double>(), row["sort_seconds"].get<double>(),
                  row["decompose_seconds"].get<double>());
    std::cout << "| " << data << " | " << mesh.cells.size() << " | " << method << " | " << numbers.data() << " | "
              << paper << " |" << std::endl;
    row["data"] = data;
    row["cells"] = mesh.cells.size();
    row["method"] = method;
    row["paper"] = paper;
    json_[key_]["rows"].push_back(row);
  }

  const Options& options() const { return options_; }
  /// @throws Error (kCannotWrite).
  void write() const {
    if (options_.json.empty()) return;
    std::ofstream out(options_.json);
    out << json_.dump(2) << "\n";
    if (!out.flush()) throw tetravox::Error(tetravox::ErrorCode::kCannotWrite, "cannot write '" + options_.json + "'");
  }

 private:
  Options options_;
  std::string key_;
  Json json_;
};

RenderSettings make_settings(Source source, int width, int height) {
  RenderSettings settings;
  settings.source = source;
  settings.width = width;
  settings.height = height;
  return settings;
}

PreparedMesh load(const Report& report, const std::string& name) {
  if (name.starts_with("builtin:")) return prepare_mesh(tetravox::make_builtin(name.substr(8)).mesh);
  const std::filesystem::path path = report.options().shared / "data" / name;
  return prepare_mesh(tetravox::read_dataset(path.string(), {}).mesh);
}

/// Calls `draw(mesh)`, or says why there is no row.
template <class Draw>
void with_mesh(const Report& report, const std::string& name, const Draw& draw) {
  try {
    const PreparedMesh mesh = load(report, name);
    draw(mesh);
  } catch (const tetravox::Error& error) {
    std::cout << "| " << name << " | | left out: " << error.what() << " | | | | | |\n";
  }
}

void measure_orders(Report& report) {
  report.begin("guthe_2002_table_5", "Orders of projected cells, 1280 x 960 (Guthe et al. 2002, table 5)");
  for (const std::string name : {"bluntfin.vtu", "builtin:buckyball?cells=177000"})
    with_mesh(report, name, [&](const PreparedMesh& mesh) {
      for (const CellSort sort : {CellSort::kCentroid, CellSort::kMpvo, CellSort::kXmpvo}) {
        RenderSettings settings = make_settings(Source::kProject, 1280, 960);
        settings.integrator = Integrator::kPolynomial;  // of degree 2, as theirs
        settings.projection.sort = sort;
        report.add(name, mesh, name_of(sort), settings, kNotAtHand);
      }
    });
}

void measure_sources(Report& report) {
  report.begin("espinha_celes_2005_table_2",
               "Cell projection and ray casting, 512 x 512 (Espinha and Celes 2005, table 2)");
  for (const std::string name : {"bluntfin.vtu", "post.vtu"})
    with_mesh(report, name, [&](const PreparedMesh& mesh) {
      RenderSettings settings = make_settings(Source::kVicp, 512, 512);
      settings.projection.transfer = MeshTransfer::kCells;
      report.add(name, mesh, "VICP: `vicp`, cells sent", settings, kNotAtHand);
      settings.projection.transfer = MeshTransfer::kOrder;
      report.add(name, mesh, "VICP-GPU: `vicp`, order sent", settings, kNotAtHand);
      report.add(name, mesh, "HARC: `walk`", make_settings(Source::kWalk, 512, 512), kNotAtHand);
      settings = make_settings(Source::kProject, 512, 512);
      report.add(name, mesh, "`project`", settings, kNone);
      settings.projection.use_pixel_correction = false;
      report.add(name, mesh, "`project`, triangles carry segments", settings, kNone);
    });
}

void measure_integrators(Report& report) {
  report.begin("roettger_ertl_2002_figure_8",
               "Integrators of projected cells, sphere, 512 x 384 (Roettger and Ertl 2002, figure 8)");
  with_mesh(report, "builtin:sphere", [&](const PreparedMesh& mesh) {
    for (const Integrator integrator : {Integrator::kTable3d, Integrator::kCylindrical, Integrator::kPolynomial,
                                        Integrator::kAntiderivative, Integrator::kPartial, Integrator::kPost}) {
      RenderSettings settings = make_settings(Source::kProject, 512, 384);
      settings.integrator = integrator;
      const bool is_theirs = integrator == Integrator::kTable3d || integrator == Integrator::kCylindrical;
      report.add("sphere", mesh, name_of(integrator), settings, is_theirs ? kNotAtHand : kNone);
    }
  });
}

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--quick")
      options.frames = 1;
    else if (word == "--shared" && i + 1 < argc)
      options.shared = argv[++i];
    else if (word == "--json" && i + 1 < argc)
      options.json = argv[++i];
    else
      throw tetravox::Error(tetravox::ErrorCode::kInvalidArgument,
                            "usage: projection_tables [--shared DIR] [--json FILE] [--quick]");
  }
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    Report report(read_options(argc, argv));
    const std::vector<tetravox::GlDevice> devices = tetravox::gl_devices();
    if (devices.empty()) {
      std::cout << "SKIPPED: no device offers OpenGL 4.5 by EGL\n";
      return 0;
    }
    measure_orders(report);
    measure_sources(report);
    measure_integrators(report);
    report.write();
    return 0;
  } catch (const tetravox::Error& error) {
    std::cerr << "projection_tables: " << error.what() << "\n";
    return 1;
  }
}
