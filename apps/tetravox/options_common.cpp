#include "apps/tetravox/options_common.h"

#include "apps/tetravox/method_choice.h"
#include "apps/tetravox/option_adding.h"
#include "apps/tetravox/options_preintegration.h"

#include <cstdint>
#include <string>

namespace tetravox::tool {
namespace {

constexpr int kLargestThreadCount = 4096;
constexpr int kMostDevices = 31;
constexpr int kLargestRepeat = 1'000'000;
constexpr int kLargestSampleCount = 4096;

constexpr int kLargestComponentCount = 4;
constexpr std::int64_t kLargestHeader = std::int64_t{1} << 53;

constexpr char kInputHelp[] =
    "Mesh or grid file, builtin:NAME, scene (.json), picture with a scene (.png, .exr), or a directory (a case, DICOM "
    "or TIFF slices)";

}  // namespace

void add_input(CLI::App& app, InputOptions& input) {
  add_positional(app, "INPUT", input.input, kInputHelp);
  begin_group(app, "Data");
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

void add_raw_layout(CLI::App& app, InputOptions& input) {
  begin_group(app, "RAW files (what is left out is taken from a name such as foot_256x256x256_uint8.raw)");
  RawLayout& raw = input.raw;
  add(app, "--dimensions", "X,Y,Z", "Values along each axis", store(raw.dimensions, parse_dimensions));
  add(app, "--scalar-type", "TYPE", "int8, uint8, int16, ..., float32, float64",
      store(raw.type, named(scalar_type_from_name)));
  add(app, "--components", "N", "Interleaved components of a value, 1 to 4 (default: 1)",
      store(raw.components, integer(1, kLargestComponentCount)));
  add(app, "--spacing", "X,Y,Z", "Distance between values (default: 1,1,1)", store(raw.spacing, parse_spacing));
  add_flag(
      app, "--big-endian", [&raw] { raw.is_big_endian = true; }, "Most significant byte first");
  add(app, "--header-bytes", "N", "Bytes to leave out at the beginning (default: 0)",
      [&input](const std::string& option, const std::string& text) {
        input.header_bytes = static_cast<std::uint64_t>(parse_integer(option, text, 0, kLargestHeader));
      });
}

void add_function(CLI::App& app, FunctionOptions& function) {
  begin_group(app, "Transfer function");
  add(app, "--transfer-function", "FILE|PRESET", "Scene or ParaView JSON file, or a preset (tetravox list presets)",
      store_text(function.function));
  add(app, "--preset-name", "NAME", "Which one of a ParaView file with several", store_text(function.preset_name));
  add(app, "--range", "A,B", "Values at the two ends of the function (default: the data's range)",
      store(function.range, parse_range));
  add_flag(app, "--log", function.use_logarithm, "Equal steps of the value's logarithm");
  add_flag(app, "--invert", function.invert, "Colours the other way round");
  add(app, "--unit-distance", "LENGTH", "World length for which opacities hold (default: diagonal / 100)",
      store(function.unit_distance, parse_positive_number));
}

void add_camera(CLI::App& app, CameraOptions& camera) {
  begin_group(app, "Camera");
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
  begin_group(app, "Picture");
  add(app, "-o,--output", "FILE", "Picture to write: .png, .exr or .npy (default: INPUT's name with .png, here)",
      store_text(options.output));
  add(app, "--resolution", "W,H", "Pixels (default: 512,512)", store(options.resolution, parse_resolution));
  add(app, "--background", "R,G,B", "Colour behind the data, numbers from 0 to 1 (default: 0,0,0)",
      store(options.background, parse_color));
  add_flag(app, "--alpha", options.use_alpha, "Keep transparency in a PNG");
  add(app, "--bit-depth", "8|16", "Bits a channel of a PNG (default: 8)",
      [&options](const std::string& option, const std::string& text) {
        options.bit_depth = parse_choice(option, text, {"8", "16"}) == 0 ? 8 : 16;
      });
  add(app, "--output-depth", "FILE", "Write the depth of what is seen first: .exr (channel Z) or .npy",
      store_text(options.output_depth));
  add(app, "--save-scene", "FILE", "Write everything that the picture depends on as a scene file",
      store_text(options.save_scene));
  add(app, "--statistics", "FILE", "Write times, memory and counts as JSON", store_text(options.statistics));
  add_flag(app, "--quiet", options.is_quiet, "Say nothing but errors");
  add_flag(app, "--verbose", options.is_verbose, "Say how long each step takes");
}

namespace {

bool parse_backend(const std::string& option, const std::string& text) {
  return parse_choice(option, text, {"cpu", "gl"}) == 1;
}

}  // namespace

void add_method(CLI::App& app, RenderOptions& options) {
  MethodOptions& method = options.method;
  begin_group(app, "Method");
  add(app, "--backend", "cpu|gl",
      "What draws: vector code on all cores (default), or OpenGL (default for what it alone has)",
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
  add(app, "--samples-per-voxel", "N|auto",
      "Grids: fixed rate along rays, 0.001 to 64 (default: auto, as the tolerance asks)",
      store(method.samples_per_voxel, parse_rate));
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

}  // namespace tetravox::tool
