#include "apps/tetravox/options.h"

#include "apps/tetravox/method_choice.h"
#include "apps/tetravox/option_adding.h"
#include "apps/tetravox/options_common.h"
#include "apps/tetravox/options_effects.h"
#include "apps/tetravox/options_histogram.h"
#include "apps/tetravox/options_multidimensional.h"
#include "apps/tetravox/options_order.h"
#include "apps/tetravox/text.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

namespace tetravox::tool {
namespace {

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
  begin_group(app, "OPTIONS");
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
