#include "apps/tetravox/options.h"

#include "apps/tetravox/method_choice.h"
#include "apps/tetravox/option_adding.h"
#include "apps/tetravox/options_effects.h"
#include "apps/tetravox/options_histogram.h"
#include "apps/tetravox/options_multidimensional.h"
#include "apps/tetravox/options_order.h"
#include "apps/tetravox/options_preintegration.h"
#include "apps/tetravox/text.h"

#include "tetravox/error.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tetravox::tool {
namespace {

constexpr int kLargestThreadCount = 4096;
constexpr int kMostDevices = 31;
constexpr int kLargestRepeat = 1'000'000;
constexpr int kLargestSampleCount = 4096;

constexpr int kLargestComponentCount = 4;
constexpr double kHighestRate = 64.0;  // samples per voxel
constexpr std::int64_t kLargestHeader = std::int64_t{1} << 53;

constexpr char kIntroduction[] =
    "tetravox draws scalar fields on meshes of cells and on regular grids, exactly, without a GPU.";

constexpr char kExamples[] = R"(Examples:
  tetravox render engine.vtu                        a good picture of any file: engine.png
  tetravox render builtin:buckyball -o ball.png     an embedded dataset
  tetravox render head.nii.gz                       a regular grid, as easily
  tetravox render engine.vtu -o engine.exr --array pressure --transfer-function viridis:ramp --range -0.5,1
  tetravox render engine.vtu --shade                lit by a headlight; --lights and --shadows say more
  tetravox render engine.vtu --isosurface 0.3 --clip-plane 0,0,0,1,0,0
  tetravox render scene.json --resolution 1920,1080 the scene in a file, larger
  tetravox render engine.png -o again.png           the scene that a picture holds
  tetravox info engine.vtu                          cells, arrays, bounds, memory
  tetravox render head.nii.gz --variables gradient  where materials meet: opacity by value and gradient
  tetravox render engine.vtu --array density --color-array pressure
  tetravox histogram engine.vtu                     how much volume each value takes: engine-histogram.png
  tetravox order engine.vtu --check                 cells back to front, for renderers that project them
  tetravox list presets                             names for --transfer-function
)";

constexpr char kRenderExamples[] = R"(Examples:
  tetravox render engine.vtu
  tetravox render engine.vtu -o engine.png --array velocity --component magnitude
  tetravox render engine.vtu --transfer-function coolwarm:peaks=5 --range -0.5,1 --camera-azimuth 90
  tetravox render run.pvd --time 3                  the fourth time step; --time 3.0: the step nearest to time 3
  tetravox render foot_256x256x256_uint8.raw        RAW by its name; any other: --dimensions 256,256,256 --scalar-type uint8
  tetravox render head.nii.gz --classification post --samples-per-voxel 2 --filter catmull-rom
  tetravox render grid.xyz --solution-file flow.q   PLOT3D
  tetravox render engine.vtu --save-scene engine.json, then: tetravox render engine.json --resolution 4096,4096
)";

constexpr char kInputHelp[] =
    "Mesh or grid file, builtin:NAME, scene (.json), picture with a scene (.png, .exr), or a directory (a case, DICOM "
    "or TIFF slices)";

void add_input(CLI::App& app, InputOptions& input) {
  app.add_option("INPUT", input.input, kInputHelp)->type_name("");
  const std::string group = "Data";
  app.option_defaults()->group(group);
  add(app, "--array", "NAME", "Array to draw (default: chosen from the data)", store_text(input.array));
  add(app, "--association", "point|cell", "Where a point and a cell array share a name",
      [&input](const std::string& option, const std::string& text) {
        input.association =
            parse_choice(option, text, {"point", "cell"}) == 0 ? Association::kPoint : Association::kCell;
      });
  add(app, "--component", "N|magnitude", "Component of a vector array (default: magnitude)",
      store(input.component, parse_component));
  add(app, "--time", "INDEX|VALUE", "Time step: a whole number is an index, a number with a decimal point is a time",
      store(input.time, parse_time));
  add(app, "--solution-file", "FILE", "PLOT3D: the solution (Q) file; INPUT is the grid",
      store_text(input.solution_file));
  add(app, "--grid-file", "FILE", "PLOT3D: the grid (XYZ) file; INPUT is the solution", store_text(input.grid_file));
  add(app, "--reader-timeout", "SECONDS", "Longest time that reading may take (default: 600)",
      store(input.reader_timeout, parse_positive_number));
}

/// How to understand the bytes of a RAW file.
void add_raw_layout(CLI::App& app, InputOptions& input) {
  app.option_defaults()->group("RAW files (what is left out is taken from a name such as foot_256x256x256_uint8.raw)");
  RawLayout& raw = input.raw;
  add(app, "--dimensions", "X,Y,Z", "Values along each axis", store(raw.dimensions, parse_dimensions));
  add(app, "--scalar-type", "TYPE", "int8, uint8, int16, ..., float32, float64",
      store(raw.type, named(scalar_type_from_name)));
  add(app, "--components", "N", "Interleaved components of a value, 1 to 4 (default: 1)",
      store(raw.components, integer(1, kLargestComponentCount)));
  add(app, "--spacing", "X,Y,Z", "Distance between values (default: 1,1,1)", store(raw.spacing, parse_spacing));
  app.add_flag_callback(
      "--big-endian", [&raw] { raw.is_big_endian = true; }, "Most significant byte first");
  add(app, "--header-bytes", "N", "Bytes to leave out at the beginning (default: 0)",
      [&input](const std::string& option, const std::string& text) {
        input.header_bytes = static_cast<std::uint64_t>(parse_integer(option, text, 0, kLargestHeader));
      });
}

void add_function(CLI::App& app, FunctionOptions& function) {
  app.option_defaults()->group("Transfer function");
  add(app, "--transfer-function", "FILE|PRESET", "Scene or ParaView JSON file, or a preset (tetravox list presets)",
      store_text(function.function));
  add(app, "--preset-name", "NAME", "Which one of a ParaView file with several", store_text(function.preset_name));
  add(app, "--range", "A,B", "Values at the two ends of the function (default: the data's range)",
      store(function.range, parse_range));
  app.add_flag("--log", function.use_logarithm, "Equal steps of the value's logarithm");
  app.add_flag("--invert", function.invert, "Colours the other way round");
  add(app, "--unit-distance", "LENGTH", "World length for which opacities hold (default: diagonal / 100)",
      store(function.unit_distance, parse_positive_number));
}

void add_camera(CLI::App& app, CameraOptions& camera) {
  app.option_defaults()->group("Camera");
  add(app, "--camera-position", "X,Y,Z", "Where the eye is", store(camera.position, parse_vector));
  add(app, "--camera-focal-point", "X,Y,Z", "What it looks at", store(camera.focal_point, parse_vector));
  add(app, "--camera-view-up", "X,Y,Z", "What is up in the picture", store(camera.view_up, parse_vector));
  add(app, "--camera-view-angle", "DEGREES", "Vertical view angle, perspective",
      store(camera.view_angle, parse_positive_number));
  add(app, "--camera-parallel-scale", "LENGTH", "Half the height of the picture, orthographic",
      store(camera.parallel_scale, parse_positive_number));
  add(app, "--camera-azimuth", "DEGREES", "Turn about the view-up direction", store(camera.azimuth, parse_number));
  add(app, "--camera-elevation", "DEGREES", "Turn upwards", store(camera.elevation, parse_number));
  add(app, "--camera-zoom", "FACTOR", "Above 1: closer", store(camera.zoom, parse_positive_number));
}

void add_picture(CLI::App& app, RenderOptions& options) {
  app.option_defaults()->group("Picture");
  add(app, "-o,--output", "FILE", "Picture to write: .png, .exr or .npy (default: INPUT's name with .png, here)",
      store_text(options.output));
  add(app, "--resolution", "W,H", "Pixels (default: 512,512)", store(options.resolution, parse_resolution));
  add(app, "--background", "R,G,B", "Colour behind the data, numbers from 0 to 1 (default: 0,0,0)",
      store(options.background, parse_color));
  app.add_flag("--alpha", options.use_alpha, "Keep transparency in a PNG");
  add(app, "--bit-depth", "8|16", "Bits a channel of a PNG (default: 8)",
      [&options](const std::string& option, const std::string& text) {
        options.bit_depth = parse_choice(option, text, {"8", "16"}) == 0 ? 8 : 16;
      });
  add(app, "--output-depth", "FILE", "Write the depth of what is seen first: .exr (channel Z) or .npy",
      store_text(options.output_depth));
  add(app, "--save-scene", "FILE", "Write everything that the picture depends on as a scene file",
      store_text(options.save_scene));
  add(app, "--statistics", "FILE", "Write times, memory and counts as JSON", store_text(options.statistics));
  app.add_flag("--quiet", options.is_quiet, "Say nothing but errors");
  app.add_flag("--verbose", options.is_verbose, "Say how long each step takes");
}

bool parse_backend(const std::string& option, const std::string& text) {
  return parse_choice(option, text, {"cpu", "gl"}) == 1;
}

void add_method(CLI::App& app, RenderOptions& options) {
  MethodOptions& method = options.method;
  app.option_defaults()->group("Method");
  add(app, "--backend", "cpu|gl", "What draws: vector code on all cores (default), or OpenGL",
      store(method.use_gl, parse_backend));
  add(app, "--gl-device", "N", "Device that draws (tetravox list devices; default: the first that is no software)",
      store(method.gl_device, integer(0, kMostDevices)));
  add(app, "--entry-order", "NAME", "Meshes, gl: how entries of rays are put in order: lists (default), peeling",
      store(method.entry_order, named(entry_order_from_name)));
  add(app, "--source", "NAME", "Where segments come from (tetravox list methods)",
      store(method.source, named(source_choice_from_name)));
  add(app, "--sort", "NAME", "project, vicp: order of cells, xmpvo (default) or another (tetravox list methods)",
      store(method.sort, named(cell_sort_from_name)));
  add(app, "--decomposition", "cpu|gpu", "project: where cells become triangles (default: cpu)",
      store(method.decomposition, named(decomposition_from_name)));
  add(app, "--pixel-correction", "on|off", "project: exact segments, or those that triangles carry (default: on)",
      store(method.use_pixel_correction, parse_switch));
  add(app, "--mesh-transfer", "order|cells", "project, vicp: what is sent for a frame (default: order, the mesh stays)",
      store(method.transfer, named(mesh_transfer_from_name)));
  add(app, "--slices", "N", "Source slices: slices along the diagonal of the grid, up to 16384",
      store(method.slices, integer(1, kMostSlices)));
  add(app, "--slabs", "NAME", "Source slices, pre-integrated: what lies between two slices: curved (default), linear",
      store(method.slabs, named(slab_shape_from_name)));
  add(app, "--slices-per-voxel", "N", "Source slices: their rate, up to 64 (default: 2)",
      [&method](const std::string& option, const std::string& text) {
        method.slices_per_voxel = parse_positive_number(option, text);
        if (*method.slices_per_voxel > kHighestRate)
          throw UsageError(option + ": '" + text + "' is not a number above 0, at most 64");
      });
  add_integrator(app, method);
  add(app, "--classification", "NAME", "Where the function is applied: preintegrated (default), post, pre",
      store(method.classification, parse_classification));
  add(app, "--filter", "NAME", "How a grid's field is reconstructed (tetravox list methods; default: linear)",
      store(method.filter, named(filter_from_name)));
  add(app, "--samples-per-voxel", "N", "Grids: fixed rate along rays, up to 64 (default: as the tolerance asks)",
      [&method](const std::string& option, const std::string& text) {
        method.samples_per_voxel = parse_positive_number(option, text);
        if (*method.samples_per_voxel > kHighestRate)
          throw UsageError(option + ": '" + text + "' is not a number above 0, at most 64");
      });
  add(app, "--samples", "N", "Samples a segment of the integrator post, where no rate is fixed",
      store(method.samples, integer(1, kLargestSampleCount)));
  add(app, "--tolerance", "ERROR",
      "Error in colour that the picture may have, 1e-7 to 1 (default: 0.002, half an 8-bit step)",
      [&method](const std::string& option, const std::string& text) {
        method.tolerance = parse_positive_number(option, text);
        if (*method.tolerance < kSmallestTolerance || *method.tolerance > 1.0)
          throw UsageError(option + ": '" + text + "' is not a number in [1e-7, 1]");
      });
  add(app, "--early-ray-termination", "on|off", "Stop rays when no 8-bit pixel can change any more (default: on)",
      store(method.use_early_ray_termination, parse_switch));
  add(app, "--threads", "N", "Threads (default: 0, all cores)", store(method.threads, integer(0, kLargestThreadCount)));
  add(app, "--instruction-set", "NAME", "Vector instructions (default: the best there is)",
      [&method](const std::string& option, const std::string& text) {
        parse_choice(option, text, instruction_sets());
        method.instruction_set = text;
      });
  add(app, "--repeat", "N", "Frames to draw, for timing (default: 1)",
      store(options.repeat, integer(1, kLargestRepeat)));
}

void require_consistent(const CameraOptions& camera) {
  if (camera.view_angle && camera.parallel_scale)
    throw UsageError("give --camera-view-angle (perspective) or --camera-parallel-scale (orthographic), not both");
}

ListOptions::Topic topic_from_name(const std::string& text) {
  return static_cast<ListOptions::Topic>(
      parse_choice("list", text, {"presets", "readers", "builtins", "methods", "environments", "sorts", "devices"}));
}

/// Usage lines in the order in which people type.
class HelpFormatter final : public CLI::Formatter {
 public:
  std::string make_usage(const CLI::App* app, std::string name) const override {
    const bool is_main = app->get_parent() == nullptr;
    const std::string path = is_main ? name : "tetravox " + app->get_name();
    const std::string argument = is_main ? "COMMAND" : app->get_name() == "list" ? "TOPIC" : "INPUT";
    return "Usage: " + path + " " + argument + " [OPTIONS]\n";
  }
};

/// The help text without runs of empty lines.
std::string make_help(const CLI::App& app) {
  std::string text = app.help();
  for (std::size_t at = text.find("\n\n\n"); at != std::string::npos; at = text.find("\n\n\n", at)) text.erase(at, 1);
  return text;
}

/// The tool's parser and what it fills.
struct Parser {
  CLI::App app{kIntroduction, "tetravox"};
  CLI::App* render = nullptr;
  CLI::App* info = nullptr;
  CLI::App* histogram = nullptr;
  CLI::App* order = nullptr;
  CLI::App* list = nullptr;
  RenderOptions render_options;
  InfoOptions info_options;
  HistogramCommandOptions histogram_options;
  OrderCommandOptions order_options;
  std::string topic;

  Parser();
  CommandLine result();
  void refuse_unknown(const CLI::App& command) const;
};

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& help) {
  CLI::App* command = app.add_subcommand(name, help);
  command->allow_extras();
  command->set_help_flag("-h,--help", "Print this help and exit");
  return command;
}

Parser::Parser() {
  app.allow_extras();
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.set_version_flag("--version", std::string("tetravox ") + TETRAVOX_VERSION);
  app.footer(kExamples);
  const auto formatter = std::make_shared<HelpFormatter>();
  formatter->column_width(40);
  app.formatter(formatter);

  render = add_command(app, "render", "Draw a picture of a mesh, a grid, a scene or a picture's scene");
  add_input(*render, render_options.input);
  add_raw_layout(*render, render_options.input);
  add_function(*render, render_options.function);
  add_multidimensional(*render, render_options.multidimensional);
  add_camera(*render, render_options.camera);
  add_picture(*render, render_options);
  add_method(*render, render_options);
  add_light(*render, render_options.effects);
  add_shapes(*render, render_options.effects);
  render->footer(kRenderExamples);

  info = add_command(app, "info", "Tell what a file holds and what drawing it needs");
  add_input(*info, info_options.input);
  add_raw_layout(*info, info_options.input);
  app.option_defaults()->group("OPTIONS");
  info->add_flag("--json", info_options.use_json, "Print JSON");

  histogram = add_command(app, "histogram", "Count the volume of each value, gradient or pair of values");
  add_input(*histogram, histogram_options.input);
  add_raw_layout(*histogram, histogram_options.input);
  add_histogram(*histogram, histogram_options);

  order = add_command(app, "order", "Sort the cells of a mesh by visibility, and check the order");
  add_input(*order, order_options.input);
  add_camera(*order, order_options.camera);
  add_order(*order, order_options);

  list = add_command(app, "list", "List presets, readers, builtins, methods, environments, sorts or devices");
  list->add_option("TOPIC", topic, "presets, readers, builtins, methods, environments, sorts or devices")
      ->type_name("");
}

/// The first argument that nothing wanted, with the option that was probably meant.
void Parser::refuse_unknown(const CLI::App& command) const {
  const std::vector<std::string> extras = command.remaining();
  if (extras.empty()) return;
  const auto dashed =
      std::find_if(extras.begin(), extras.end(), [](const auto& text) { return text.size() > 1 && text[0] == '-'; });
  const std::string word = dashed == extras.end() ? extras.front() : dashed->substr(0, dashed->find('='));
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  const bool is_main = &command == &app;
  if (is_main) known = {"render", "info", "histogram", "order", "list", "--help", "--version"};
  const std::string closest = closest_word(word, known);
  std::string message = (word[0] == '-' ? "unknown option '"
                         : is_main      ? "unknown command '"
                                        : "unexpected argument '") +
                        word + "'";
  if (!closest.empty())
    message += ": did you mean " + closest + "?";
  else if (is_main && word[0] != '-')
    message += ": to draw a file, tetravox render " + word;
  throw UsageError(message);
}

CommandLine Parser::result() {
  for (const CLI::App* command : {render, info, histogram, order, list})
    if (command->parsed()) refuse_unknown(*command);
  refuse_unknown(app);
  const auto require_input = [](const InputOptions& input) {
    if (input.input.empty()) throw UsageError("name what to read: a file, a scene, a picture or builtin:NAME");
    if (!input.grid_file.empty() && !input.solution_file.empty())
      throw UsageError("give --grid-file or --solution-file, not both: INPUT is the other one");
  };
  if (render->parsed()) {
    require_input(render_options.input);
    require_consistent(render_options.camera);
    require_consistent(render_options.method);
    if (render_options.is_quiet && render_options.is_verbose) throw UsageError("give --quiet or --verbose, not both");
    return render_options;
  }
  if (info->parsed()) {
    require_input(info_options.input);
    return info_options;
  }
  if (histogram->parsed()) {
    require_input(histogram_options.input);
    return histogram_options;
  }
  if (order->parsed()) {
    require_input(order_options.input);
    require_consistent(order_options.camera);
    return order_options;
  }
  if (list->parsed()) {
    if (topic.empty())
      throw UsageError("list what? presets, readers, builtins, methods, environments, sorts or devices");
    return ListOptions{topic_from_name(topic)};
  }
  throw UsageError("name a command: render, info, histogram, order or list");
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  Parser parser;
  try {
    parser.app.parse(argc, argv);
    return parser.result();
  } catch (const CLI::CallForHelp&) {
    return TextOptions{make_help(parser.app)};
  } catch (const CLI::CallForVersion&) {
    return TextOptions{parser.app.version() + "\n"};
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace tetravox::tool
