#include "apps/tetravox/backend.h"
#include "apps/tetravox/body.h"
#include "apps/tetravox/camera_choice.h"
#include "apps/tetravox/commands.h"
#include "apps/tetravox/effect_choice.h"
#include "apps/tetravox/empty_picture.h"
#include "apps/tetravox/function_choice.h"
#include "apps/tetravox/json_report.h"
#include "apps/tetravox/memory_plan.h"
#include "apps/tetravox/method_choice.h"
#include "apps/tetravox/multidimensional_choice.h"
#include "apps/tetravox/output_files.h"
#include "apps/tetravox/progress_line.h"
#include "apps/tetravox/scene_input.h"
#include "apps/tetravox/text.h"

#include "tetravox/error.h"
#include "tetravox/io.h"
#include "tetravox/render.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <utility>

namespace tetravox::tool {
namespace {

/// Seconds since it was made, or since the last lap.
class Stopwatch {
 public:
  double lap() {
    const auto now = Clock::now();
    return std::chrono::duration<double>(now - std::exchange(last_, now)).count();
  }
  double total() const { return std::chrono::duration<double>(Clock::now() - first_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point first_ = Clock::now();
  Clock::time_point last_ = first_;
};

/// Messages between the progress lines.
struct Talk {
  explicit Talk(const RenderOptions& options)
      : is_quiet(options.is_quiet), is_verbose(options.is_verbose), line(!options.is_quiet) {}

  void warn(const std::string& text) { say(text, !is_quiet); }
  void detail(const std::string& text) { say(text, is_verbose); }
  void say(const std::string& text, bool is_wanted) {
    line.clear();
    if (is_wanted) std::fprintf(stderr, "tetravox: %s\n", single_line(text).c_str());
  }

  bool is_quiet, is_verbose;
  ProgressLine line;
};

/// Everything that one run makes on its way to the picture.
struct Job {
  SceneInput input;
  std::string output;
  WriteOptions write;
  DatasetInfo info;
  Body body;
  CompletedScene completed;
  std::optional<OpticalTable> table;      ///< in place of the function of the value
  std::optional<OpticalFunction> colors;  ///< of another array
  SceneParts parts;
  PictureStatistics statistics;
};

/// Name of the picture, and that it can be written as asked, before any long work.
std::string choose_output(const RenderOptions& options, const SceneInput& input) {
  std::string output = options.output.empty() ? input.name + ".png" : options.output;
  const std::string ending = ending_of(output);
  const bool is_known = ending == ".png" || ending == ".exr" || ending == ".npy";
  if (!is_known) throw UsageError("--output: '" + output + "' does not end in .png, .exr or .npy");
  if (ending != ".png" && (options.use_alpha || options.bit_depth))
    throw UsageError("--alpha and --bit-depth are for .png; " + ending + " keeps floats with alpha");
  std::error_code ignored;
  if (options.output.empty() && std::filesystem::equivalent(output, options.input.input, ignored))
    throw UsageError("--output: name the picture, the default would replace the input " + output);
  if (!options.output_depth.empty() && ending_of(options.output_depth) != ".exr" &&
      ending_of(options.output_depth) != ".npy")
    throw UsageError("--output-depth: '" + options.output_depth + "' does not end in .exr or .npy");
  const std::array<std::string, 4> written{output, options.save_scene, options.statistics, options.output_depth};
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (written[i].empty()) continue;
    require_writable(written[i]);
    const bool is_input = i > 0 && std::filesystem::equivalent(written[i], options.input.input, ignored);
    const bool is_twice = std::count(written.begin(), written.end(), written[i]) > 1;
    if (is_input || is_twice)
      throw UsageError("'" + written[i] +
                       "' would be written over: give picture, depth, scene and statistics names of their own");
  }
  return output;
}

/// Puts the command line's picture and method options over those of the scene.
void override_scene(const RenderOptions& options, Scene& scene) {
  RenderSettings& settings = scene.settings;
  if (options.resolution) {
    settings.width = (*options.resolution)[0];
    settings.height = (*options.resolution)[1];
  }
  scene.background = options.background.value_or(scene.background);
  override_method(options.method, settings);
  override_effects(options.effects, scene);
  override_multidimensional(options.multidimensional, options.function, scene);
  if (options.effects.shows_volume && !*options.effects.shows_volume) {
    scene.multidimensional.reset();
    scene.color_by.reset();
  }
  settings.wants_depth = !options.output_depth.empty();
}

/// What was chosen from the data, written down so that the same picture can be drawn again.
void record_data(const Dataset& dataset, SceneData& data) {
  const ReadArray read = array_of(dataset);
  data.array.name = read.name;
  data.array.association = read.association;
  data.array.component.reset();
  for (const ArrayInfo& array : dataset.info.arrays)
    if (array.name == read.name && array.association == read.association && array.components > 1)
      data.array.component = read.component;
  if (!data.time.index && !data.time.value && dataset.info.times.size() > 1) data.time.index = dataset.info.time_index;
}

/// Reads and prepares; a mesh as read is gone afterwards, a grid's values stay.
void load_body(const RenderOptions& options, Job& job, Talk& talk) {
  Stopwatch watch;
  Dataset dataset = read_dataset(job.input.data_path, job.input.read, talk.line.progress());
  throw_if_interrupted();
  PictureStatistics& statistics = job.statistics;
  statistics.read_seconds = watch.lap();
  talk.detail("read " + format_count(dataset.info.cell_count) + " cells in " + format_seconds(statistics.read_seconds));
  const RenderSettings& settings = job.input.scene.settings;
  for (const std::string& line : check_method(options.method, settings, dataset, job.input.data_path))
    talk.warn("warning: " + line);
  for (const std::string& line : check_effects(options.effects, settings)) talk.warn("warning: " + line);
  for (const std::string& line :
       check_multidimensional(options.multidimensional, options.effects.shows_volume.value_or(true)))
    talk.warn("warning: " + line);
  require_memory(plan_memory(dataset, settings), job.input.data_path);
  statistics.input_bytes = input_bytes(dataset);

  watch.lap();
  job.body = prepare_body(dataset, talk.line.progress());
  throw_if_interrupted();
  statistics.prepare_seconds = watch.lap();
  statistics.body = measure_body(job.body);
  talk.detail(describe_preparing(statistics.body) + " in " + format_seconds(statistics.prepare_seconds) + ", " +
              format_bytes(statistics.body.bytes));
  record_data(dataset, job.input.scene.data);
  statistics.array = array_of(dataset).name;
  job.info = std::move(dataset.info);
}

/// Function and camera, from the options, the scene or the data.
void complete_job(const RenderOptions& options, Job& job) {
  Stopwatch watch;
  Scene& scene = job.input.scene;
  job.table = choose_table(options.multidimensional, options.function, job.body, scene);
  if (!job.table) choose_function(options.function, job.body, scene);
  job.colors = choose_colors(options.multidimensional, job.body, scene);
  job.completed = complete_scene(scene, job.body);
  job.completed.camera = override_camera(options.camera, job.completed.camera, find_middle(scene, job.body));
  complete_effects(options.effects, job.completed, scene);
  if (!scene.multidimensional) scene.transfer_function = job.completed.transfer_function;
  scene.camera = job.completed.camera;
  job.statistics.choose_seconds = watch.lap();
}

Image draw(const RenderOptions& options, Job& job, Talk& talk) {
  Renderer renderer = make_renderer(job.body, options.method, job.input.scene);
  job.parts.attach(renderer);
  Stopwatch watch;
  renderer.set_transfer_function(job.completed.optical_function);
  if (job.table) renderer.set_multidimensional_function(*job.table);
  if (job.colors) renderer.set_color_function(0, *job.colors);
  job.statistics.transfer_function_seconds = watch.lap();
  const RenderSettings& settings = job.input.scene.settings;
  Image image;
  for (int i = 0; i < options.repeat; ++i) {
    throw_if_interrupted();
    image = {};  // the frame before is not needed any more
    watch.lap();
    image = renderer.render(job.completed.camera, settings, &job.statistics.render, talk.line.progress());
    job.statistics.frame_seconds.push_back(watch.lap());
    // What a new function costs before the next frame, planning included.
    if (i == 0) job.statistics.transfer_function_seconds += job.statistics.render.plan_seconds;
  }
  job.statistics.frame_bytes = renderer.bytes();
  job.statistics.settings = settings;
  talk.detail("drew " + format_count(job.statistics.render.segments) + " segments in " +
              format_seconds(median_frame_seconds(job.statistics)) + " a frame, " +
              describe_backend(job.statistics.render));
  return image;
}

/// The scene's text for a file at `target`.
std::string scene_text(const Job& job, const std::string& target) {
  return format_scene(scene_seen_from(job.input, target));
}

WriteOptions choose_write_options(const RenderOptions& options, const Job& job) {
  WriteOptions write;
  // A picture drawn again is written as it was, unless something else is asked for.
  if (job.input.picture && ending_of(job.output) == ".png") {
    write.bit_depth = job.input.picture->bit_depth;
    write.use_alpha = job.input.picture->use_alpha && !options.background;
  }
  write.background = job.input.scene.background;
  write.use_alpha = write.use_alpha || options.use_alpha;
  write.bit_depth = options.bit_depth.value_or(write.bit_depth);
  write.scene = scene_text(job, job.output);
  return write;
}

std::string describe_array(const Job& job) {
  const ArrayRequest& array = job.input.scene.data.array;
  std::string text = array.name;
  if (array.component)
    text += *array.component == kMagnitude ? " magnitude" : " component " + std::to_string(*array.component);
  text += array.association == Association::kCell ? " (cell) " : " (point) ";
  return text + format_range(scalar_range_of(job.body));
}

void write_everything(const RenderOptions& options, Job& job, const Image& image, Talk& talk, Stopwatch& watch) {
  Stopwatch write_watch;
  OutputFiles files;
  files.write(job.output, [&](const std::string& path) {
    write_image(path, image, choose_write_options(options, job), talk.line.progress());
  });
  if (!options.output_depth.empty())
    files.write(options.output_depth, [&](const std::string& path) { write_depth(path, image); });
  job.statistics.write_seconds = write_watch.lap();
  if (!options.save_scene.empty())
    files.write(options.save_scene, [&](const std::string& path) { write_text_file(path, scene_text(job, path)); });
  job.statistics.total_seconds = watch.total();
  if (!options.statistics.empty())
    files.write(options.statistics,
                [&](const std::string& path) { write_text_file(path, format_statistics(job.statistics)); });
  files.keep();
}

}  // namespace

void run_render(const RenderOptions& options) {
  Stopwatch watch;
  Talk talk(options);
  Job job;
  job.input = load_scene_input(options.input);
  job.output = choose_output(options, job.input);
  override_scene(options, job.input.scene);
  job.input.read.others = other_arrays(job.input.scene);
  job.parts.load(job.input.scene, job.input.read.timeout, talk.line.progress());
  load_body(options, job, talk);
  complete_job(options, job);
  const Image image = draw(options, job, talk);
  throw_if_interrupted();

  for (const std::string& note : job.info.notes) talk.detail(note);
  const PictureContext context{job.input.scene, job.completed, job.body, job.info, job.statistics.render};
  for (const std::string& line : explain_picture(image, context)) talk.warn("warning: " + line);
  write_everything(options, job, image, talk, watch);
  talk.line.clear();
  if (options.is_quiet) return;
  std::cout << "wrote " << single_line(job.output) << ": " << image.width << " x " << image.height << ", "
            << format_seconds(watch.total()) << ", " << single_line(describe_array(job)) << "\n";
}

}  // namespace tetravox::tool
