/// Measures the papers' tables again with OpenGL beside the CPU. Prints Markdown.
///
///     papers_opengl [--data DIR] [--json FILE] [--quick]
///
/// DIR holds bluntfin.vtu and post.vtu (default: ../shared/data); where it does not, embedded meshes of about as many
/// tetrahedra take their place. Of the papers stands beside what could be looked up; "not at hand" is what could not.
///
/// Times are medians by the clock around glFinish: timer queries of software devices measure nothing.

#include "bench/paper_report.h"
#include "src/gl/context.h"
#include "src/gl/mesh_buffers.h"
#include "src/gl/table_maker.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"
#include "src/support/threads.h"
#include "tetravox/error.h"
#include "tetravox/gl.h"
#include "tetravox/io.h"
#include "tetravox/render.h"
#include "tetravox/scene.h"

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace tetravox::bench;
using namespace tetravox::optics;
using tetravox::Camera;
using tetravox::Integrator;
using tetravox::LengthSpacing;
using tetravox::OpticalFunction;
using tetravox::PreintegrationSettings;
using tetravox::PreparedMesh;
using tetravox::Renderer;
using tetravox::RenderSettings;
using tetravox::RenderStatistics;
using tetravox::support::Timer;

const char* const kNotAtHand = "not at hand";
constexpr int kPixels = 512;

struct Options {
  std::string data = "../shared/data", json_file;
  bool is_quick = false;
};

/// Makes tables on the device, and waits for them.
class DeviceTables {
 public:
  DeviceTables() : context_(tetravox::gl::Context::open({})), current_(context_->make_current()) {}

  tetravox::gl::DeviceTable make(const OpticalFunction& function, Integrator integrator,
                                 const PreintegrationSettings& tables) {
    RenderSettings settings;
    settings.integrator = integrator;
    settings.preintegration = tables;
    tetravox::gl::DeviceTable table = maker_->make(source_of(function), settings);
    glFinish();
    context_->require_no_error("tables");
    return table;
  }
  /// Without the first time, which compiles programs.
  double time(int rounds, const OpticalFunction& function, Integrator integrator,
              const PreintegrationSettings& tables) {
    make(function, integrator, tables);
    return median_seconds(rounds, [&] { make(function, integrator, tables); });
  }
  ~DeviceTables() { maker_.reset(); }

 private:
  std::shared_ptr<tetravox::gl::Context> context_;
  tetravox::gl::Context::Current current_;
  std::optional<tetravox::gl::TableMaker> maker_{std::in_place};
};

/// The CPU's table with the device's entries, so that one look-up serves both.
PreintegrationTable read_back(const tetravox::gl::DeviceTable& device, const OpticalFunction& function,
                              const PreintegrationSettings& settings) {
  PreintegrationTable table;
  table.domain = make_segment_domain(source_of(function));
  table.scalars = settings.scalars;
  table.lengths = settings.lengths;
  table.spacing = settings.length_spacing;
  table.entries.resize(preintegration_table_bytes(settings.scalars, settings.lengths) / sizeof(float));
  glGetTextureImage(device.table.get(), 0, GL_RGBA, GL_FLOAT,
                    static_cast<GLsizei>(table.entries.size() * sizeof(float)), table.entries.data());
  return table;
}

PreintegrationSettings size_of_table(int scalars, int lengths) {
  PreintegrationSettings settings;
  settings.scalars = scalars;
  settings.lengths = lengths;
  settings.length_spacing = LengthSpacing::kUniform;
  return settings;
}

void measure_bits_and_steps(bool is_quick, Report& report) {
  report.begin("device_entry_errors",
               "Errors of the entries of a 64 x 64 x 32 table made on the device, by bits and steps (Roettger and Ertl "
               "2002, table 1)",
               {"function", "bits", "steps", "RMS", "maximum", "CPU, 32 bits: RMS", "maximum there", "paper"});
  DeviceTables device;
  for (const NamedFunction& named : make_functions(10.0)) {
    const Samples samples = sample_entries(named.function, is_quick ? 2000 : 20000, 64, 32);
    const auto measure = [&](const PreintegrationTable& table) {
      return samples.measure([&](float a, float b, float l) { return eval_preintegration_table(table, a, b, l); });
    };
    for (const int bits : {8, 12, 16, 32})
      for (const int steps : {4, 16, 64, 256}) {
        PreintegrationSettings settings = size_of_table(64, 32);
        settings.bits = bits;
        settings.steps = steps;
        const Errors errors =
            measure(read_back(device.make(named.function, Integrator::kTable3d, settings), named.function, settings));
        settings.bits = 32;
        settings.use_incremental = false;
        PreintegrationTable table;
        build_preintegration_table(source_of(named.function), settings, table);
        const Errors cpu = measure(table);
        report.add({named.name, bits, steps, errors.rms, errors.largest, cpu.rms, cpu.largest, kNotAtHand});
      }
  }
}

void time_full_tables(int rounds, Report& report) {
  report.begin("device_full_table_seconds",
               "Seconds of a full table, 64 steps an entry (Roettger and Ertl 2002, table 2)",
               {"size", "CPU, straightforward", "CPU, incremental", "device", "paper: software", "paper: hardware"});
  DeviceTables device;
  const OpticalFunction function = make_functions(10.0)[1].function;
  for (const auto& [scalars, lengths] : {std::array{64, 32}, std::array{128, 64}, std::array{256, 128}}) {
    PreintegrationSettings settings = size_of_table(scalars, lengths);
    PreintegrationTable table;
    const auto build = [&](bool use_incremental) {
      settings.use_incremental = use_incremental;
      return median_seconds(rounds, [&] { build_preintegration_table(source_of(function), settings, table); });
    };
    const double anew = build(false), incremental = build(true);
    const std::string side = std::to_string(scalars);
    report.add({side + " x " + side + " x " + std::to_string(lengths), anew, incremental,
                device.time(rounds, function, Integrator::kTable3d, settings), kNotAtHand, kNotAtHand});
  }
}

void time_set_up(int rounds, Report& report) {
  report.begin("device_set_up_seconds",
               "Seconds of setting up 512 x 512, 64 steps an entry (Guthe et al. 2002, table 4)",
               {"table", "CPU, straightforward", "CPU, incremental", "device", "paper: software", "paper: hardware"});
  DeviceTables device;
  const OpticalFunction function = make_functions(10.0)[1].function;
  for (const int degree : {1, 2, 4}) {
    PreintegrationSettings settings;
    settings.scalars = 512;
    settings.degree = degree;
    const auto [anew, incremental] = time_polynomial(rounds, function, settings);
    report.add({"polynomial, n = " + std::to_string(degree), anew, incremental,
                device.time(rounds, function, Integrator::kPolynomial, settings), kNotAtHand, kNotAtHand});
  }
  report.add({"antiderivatives (ours)", time_antiderivatives(rounds, function), "-", "-", "-", "-"});
}

struct Subject {
  std::string name;
  PreparedMesh mesh;
  Camera camera;
};

/// The papers' meshes, or embedded ones of about as many tetrahedra.
std::vector<Subject> read_subjects(const std::string& data) {
  std::vector<Subject> subjects;
  for (const auto& [file, name, stand_in] : {std::array{"bluntfin.vtu", "blunt fin", "builtin:duct"},
                                             std::array{"post.vtu", "post", "builtin:buckyball?cells=616050"}}) {
    const std::filesystem::path path = std::filesystem::path(data) / file;
    const bool is_there = std::filesystem::exists(path);
    if (!is_there) std::cout << "\n" << path.string() << " is not there: " << stand_in << " takes its place.\n";
    Subject subject;
    subject.name = is_there ? name : stand_in;
    subject.mesh = tetravox::prepare_mesh(tetravox::read_dataset(is_there ? path.string() : stand_in).mesh);
    subject.camera = tetravox::make_default_camera(subject.mesh.bounds, 1.0);
    subjects.push_back(std::move(subject));
  }
  return subjects;
}

double diagonal_of(const PreparedMesh& mesh) {
  double square = 0.0;
  for (const tetravox::ValueRange& axis : mesh.bounds) square += (axis.max - axis.min) * (axis.max - axis.min);
  return std::sqrt(square);
}

/// So many linear pieces over the values: rainbow colours, extinctions at random, seen through to the other side.
OpticalFunction make_pieces(const PreparedMesh& mesh, int pieces, unsigned seed = 5) {
  const OpticalFunction colors =
      make_optical_function(tetravox::make_preset("rainbow:constant", {mesh.scalar_range, false, false}), 1.0);
  std::mt19937 random(seed);
  OpticalFunction function;
  for (int i = 0; i <= pieces; ++i) {
    const double place = static_cast<double>(i) / pieces;
    tetravox::OpticalPoint point =
        eval_optical_function(colors, mesh.scalar_range.min + place * (mesh.scalar_range.max - mesh.scalar_range.min));
    point.value = mesh.scalar_range.min + place * (mesh.scalar_range.max - mesh.scalar_range.min);
    point.extinction = 4.0 / diagonal_of(mesh) * static_cast<double>(random() % 1000) / 999.0;
    function.points.push_back(point);
  }
  return function;
}

struct Method {
  std::string name;
  Integrator integrator;
  int pieces;
  std::string paper;
};

RenderSettings make_settings(Integrator integrator, int pixels) {
  RenderSettings settings;
  settings.width = settings.height = pixels;
  settings.integrator = integrator;
  settings.preintegration = size_of_table(128, 128);
  settings.preintegration.length_spacing = LengthSpacing::kLogarithmic;
  return settings;
}

void time_frames(const std::vector<Subject>& subjects, int rounds, Report& report) {
  report.begin("frames",
               "Ray casting at 512 x 512 (Espinha and Celes 2005, table 3; theirs: of their abstract, for partial "
               "pre-integration, whatever the mesh)",
               {"mesh", "tetrahedra", "backend", "integrator", "pieces", "frames/s", "Mtet/s", "Msegments/s",
                "paper: frames/s", "paper: Mtet/s"});
  const Method methods[] = {{"table3d, 128 x 128 x 128", Integrator::kTable3d, 255, kNotAtHand},
                            {"partial", Integrator::kPartial, 10, "up to 2"},
                            {"partial", Integrator::kPartial, 255, "up to 2"},
                            {"antiderivative", Integrator::kAntiderivative, 255, "-"}};
  for (const Subject& subject : subjects)
    for (const std::string backend : {"gl", "cpu"}) {
      Renderer renderer = backend == "gl" ? tetravox::make_gl_renderer(subject.mesh) : Renderer(subject.mesh);
      for (const Method& method : methods) {
        renderer.set_transfer_function(make_pieces(subject.mesh, method.pieces));
        const RenderSettings settings = make_settings(method.integrator, kPixels);
        RenderStatistics statistics;
        renderer.render(subject.camera, settings, &statistics);  // tables and programs
        const double rate =
            1.0 / median_seconds(rounds, [&] { renderer.render(subject.camera, settings, &statistics); });
        report.add({subject.name, subject.mesh.cells.size(), backend, method.name, method.pieces, rate,
                    static_cast<double>(subject.mesh.cells.size()) * rate * 1e-6,
                    static_cast<double>(statistics.segments) * rate * 1e-6,
                    method.integrator == Integrator::kAntiderivative ? "-" : kNotAtHand, method.paper});
      }
    }
}

void measure_memory(const std::vector<Subject>& subjects, Report& report) {
  report.begin("bytes_a_tetrahedron",
               "Bytes a tetrahedron: cells, vertices, boundary (Espinha and Celes 2005: 144, 96, 76)",
               {"mesh", "tetrahedra", "device", "CPU", "CPU, with the camera's vertices", "paper"});
  const auto context = tetravox::gl::Context::open({});
  const auto current = context->make_current();
  for (const Subject& subject : subjects) {
    const PreparedMesh& mesh = subject.mesh;
    tetravox::gl::MeshBuffers buffers(mesh, context->limits());
    buffers.see(subject.camera, kPixels, kPixels);
    const auto cells = static_cast<double>(mesh.cells.size());
    const std::size_t vertex_bytes = mesh.vertices.size() * sizeof(tetravox::Vertex);
    const std::size_t mesh_bytes = mesh.cells.size() * sizeof(tetravox::TetrahedronLinks) + vertex_bytes +
                                   mesh.boundary.size() * sizeof(tetravox::BoundaryFace);
    // What the buffers keep on the CPU, the camera's vertices, is of that size too.
    report.add({subject.name, mesh.cells.size(), static_cast<double>(buffers.bytes() - vertex_bytes) / cells,
                static_cast<double>(mesh_bytes) / cells, static_cast<double>(mesh_bytes + vertex_bytes) / cells,
                "144, 96, 76"});
  }
}

/// Notes when the next frame draws for the first time. The library's functions are pointers, which know their targets
/// only after they were called once.
class FirstDraw {
 public:
  FirstDraw() : before_(epoxy_glDrawArrays) {
    real_ = before_;
    seconds_.reset();
    epoxy_glDrawArrays = &FirstDraw::draw;
  }
  ~FirstDraw() { epoxy_glDrawArrays = before_; }
  FirstDraw(const FirstDraw&) = delete;
  FirstDraw& operator=(const FirstDraw&) = delete;
  void start() {
    timer_ = {};
    seconds_.reset();
  }
  double seconds() const { return seconds_.value(); }

 private:
  static void EPOXY_CALLSPEC draw(GLenum mode, GLint first, GLsizei count) {
    if (!seconds_) seconds_ = timer_.seconds();
    real_(mode, first, count);
  }
  static inline Timer timer_;
  static inline std::optional<double> seconds_;
  static inline decltype(epoxy_glDrawArrays) real_ = nullptr;
  decltype(epoxy_glDrawArrays) before_;
};

double median_of(std::vector<double> numbers) {
  std::sort(numbers.begin(), numbers.end());
  return numbers[numbers.size() / 2];
}

void time_changes(const std::vector<Subject>& subjects, int rounds, Report& report) {
  report.begin("change_of_function",
               "Milliseconds from a new transfer function (255 pieces) to the next frame's first draw call, programs "
               "compiled (asked: under 5)",
               {"mesh", "integrator", "set_transfer_function", "tables to the device", "to the first draw call",
                "to the first draw call, same function"});
  for (const Subject& subject : subjects) {
    Renderer renderer = tetravox::make_gl_renderer(subject.mesh);
    for (const Integrator integrator : {Integrator::kAntiderivative, Integrator::kPartial}) {
      const RenderSettings settings = make_settings(integrator, kPixels);
      const OpticalFunction functions[] = {make_pieces(subject.mesh, 255, 5), make_pieces(subject.mesh, 255, 6)};
      for (const OpticalFunction& function : functions) {
        renderer.set_transfer_function(function);
        renderer.render(subject.camera, settings);
      }
      FirstDraw first_draw;
      std::vector<double> set, upload, changed, same;
      for (int i = 0; i < 2 * rounds + 1; ++i) {
        RenderStatistics statistics;
        first_draw.start();
        const Timer timer;
        renderer.set_transfer_function(functions[i % 2]);
        set.push_back(1e3 * timer.seconds());
        renderer.render(subject.camera, settings, &statistics);
        upload.push_back(1e3 * statistics.plan_seconds);
        changed.push_back(1e3 * first_draw.seconds());
        first_draw.start();
        renderer.render(subject.camera, settings);
        same.push_back(1e3 * first_draw.seconds());
      }
      report.add(
          {subject.name, name_of(integrator), median_of(set), median_of(upload), median_of(changed), median_of(same)});
    }
  }
}

/// Without the driver's cache on disk.
void time_first_uses(const Subject& subject, Report& report) {
  report.begin("first_use",
               "Milliseconds of the first frame with a program, and of later ones (64 x 64; tables not counted)",
               {"program", "first frame", "later frames", "difference"});
  const Timer opening;
  Renderer renderer = tetravox::make_gl_renderer(subject.mesh);
  report.add({"a new renderer: context, mesh into buffers", 1e3 * opening.seconds(), "-", "-"});
  renderer.set_transfer_function(make_pieces(subject.mesh, 255));
  // The first one compiles those of the entries, too.
  for (const Integrator integrator : {Integrator::kPost, Integrator::kAntiderivative, Integrator::kPartial,
                                      Integrator::kTable3d, Integrator::kPolynomial, Integrator::kCylindrical}) {
    const RenderSettings settings = make_settings(integrator, 64);
    const auto frame = [&] {
      RenderStatistics statistics;
      const Timer timer;
      renderer.render(subject.camera, settings, &statistics);
      return 1e3 * (timer.seconds() - statistics.plan_seconds);
    };
    const double first = frame();
    std::vector<double> later;
    for (int i = 0; i < 5; ++i) later.push_back(frame());
    const std::string name = name_of(integrator) + (integrator == Integrator::kPost ? ", lists and sorting" : "");
    report.add({name, first, median_of(later), first - median_of(later)});
  }
}

std::optional<Options> parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--quick")
      options.is_quick = true;
    else if (argument == "--json" && i + 1 < argc)
      options.json_file = argv[++i];
    else if (argument == "--data" && i + 1 < argc)
      options.data = argv[++i];
    else
      return std::nullopt;
  }
  return options;
}

void measure(const Options& options, Report& report) {
  const int rounds = options.is_quick ? 1 : 5;
  measure_bits_and_steps(options.is_quick, report);
  time_full_tables(rounds, report);
  time_set_up(rounds, report);
  const std::vector<Subject> subjects = read_subjects(options.data);
  time_frames(subjects, rounds, report);
  measure_memory(subjects, report);
  time_changes(subjects, rounds, report);
  time_first_uses(subjects.front(), report);
}

}  // namespace

int main(int argc, char** argv) {
  const std::optional<Options> options = parse(argc, argv);
  if (!options) {
    std::cerr << "usage: papers_opengl [--data DIR] [--json FILE] [--quick]\n";
    return 2;
  }
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);  // otherwise a first use is one of the first run only
  Report report;
  try {
    const std::vector<tetravox::GlDevice> devices = tetravox::gl_devices();
    std::cout << "# The papers' tables with OpenGL\n\n";
    if (devices.empty()) {
      std::cout << "There is no device with OpenGL 4.5 by EGL: nothing was measured.\n";
      report.note("device", nullptr);
    } else {
      const std::string device = tetravox::gl::Context::open({})->device().name;
      std::cout << "Device: " << device << "; CPU: " << tetravox::support::hardware_threads() << " threads.\n";
      report.note("device", device);
      report.note("threads", tetravox::support::hardware_threads());
      measure(*options, report);
    }
  } catch (const tetravox::Error& error) {
    std::cerr << "papers_opengl: " << error.what() << "\n";
    return 1;
  }
  if (options->json_file.empty() || report.write(options->json_file)) return 0;
  std::cerr << "papers_opengl: cannot write " << options->json_file << "\n";
  return 1;
}
