#pragma once

/// The command line as data. Everything left out of it stays open and is chosen by the scene or from the data.

#include "apps/tetravox/option_values.h"

#include "tetravox/scene.h"
#include "tetravox/slicing.h"
#include "tetravox/visibility.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace tetravox::tool {

/// What is read: shared by `render`, `info`, `histogram` and `order`.
struct InputOptions {
  std::string input;
  std::string array;
  std::optional<Association> association;
  std::optional<int> component;
  TimeRequest time;
  std::string grid_file;        ///< PLOT3D: the grid, where `input` is the solution
  std::string solution_file;    ///< PLOT3D: the solution, where `input` is the grid
  double reader_timeout = 600;  ///< seconds
  RawLayout raw;                ///< RAW files; without its header
  std::optional<std::uint64_t> header_bytes;
};

struct FunctionOptions {
  std::string function;     ///< file or preset
  std::string preset_name;  ///< which one of a file with several
  std::optional<ValueRange> range;
  bool use_logarithm = false;
  bool invert = false;
  std::optional<double> unit_distance;

  bool changes_values() const { return range || use_logarithm || invert; }
};

/// A widget, and how many variables it was given for.
struct WidgetOption {
  Widget widget;
  std::size_t variables = 2;
};

/// Functions of several variables, and colours by another array: put over those of the scene.
struct MultidimensionalOptions {
  std::optional<std::vector<Variable>> variables;  ///< beside the value; an empty list drops the scene's function
  std::vector<WidgetOption> widgets;
  std::string table;
  std::optional<int> resolution;
  std::optional<ArrayRequest> color_array;  ///< without a name: drops the scene's
  std::string color_function;               ///< file or preset
  std::optional<ValueRange> color_range;
};

struct CameraOptions {
  std::optional<Vector3> position, focal_point, view_up;
  std::optional<double> view_angle, parallel_scale;
  double azimuth = 0, elevation = 0, zoom = 1;
};

/// Where the transfer function is applied.
enum class Classification {
  kPreintegrated,  ///< integrated along segments
  kPost,           ///< at samples of the field
  kPre             ///< at the values, before they are interpolated
};

/// Tables of ray integrals; see `PreintegrationSettings`.
struct PreintegrationOptions {
  std::optional<int> scalars, lengths, degree, planes, tile, steps, bits;
  std::optional<LengthSpacing> length_spacing;
  std::optional<OpacityModel> opacity;
  std::optional<TableDevice> device;
  std::optional<bool> use_incremental;
};

struct MethodOptions {
  std::optional<bool> use_gl;
  std::optional<int> gl_device;
  std::optional<EntryOrder> entry_order;
  std::optional<SourceChoice> source;
  std::optional<CellSort> sort;
  std::optional<Decomposition> decomposition;
  std::optional<bool> use_pixel_correction;
  std::optional<MeshTransfer> transfer;
  std::optional<int> slices;
  std::optional<SlabShape> slabs;
  std::optional<double> slices_per_voxel;
  std::optional<Classification> classification;
  std::optional<Integrator> integrator;
  PreintegrationOptions preintegration;
  std::optional<Filter> filter;
  std::optional<int> samples;
  std::optional<double> samples_per_voxel;
  std::optional<double> tolerance;
  std::optional<bool> use_early_ray_termination;
  int threads = 0;
  std::string instruction_set;
};

/// An iso-surface; its colour is the transfer function's where none is given.
struct SurfaceOption {
  double value = 0.0;
  std::optional<Color> color;
  double opacity = 1.0;
};

/// Light, surfaces and clipping: put over those of the scene. An empty list drops the scene's.
struct EffectOptions {
  bool use_headlight = false;
  std::optional<std::vector<Light>> lights;
  std::optional<std::string> environment;  ///< empty text: drops the scene's
  std::optional<double> environment_intensity, environment_rotation;
  std::optional<Vector3> environment_up;
  std::optional<Material> material;
  std::optional<GradientMethod> gradient;
  std::optional<double> gradient_threshold;
  std::optional<bool> is_two_sided;
  std::optional<ShadowKind> shadows;
  std::optional<int> shadow_resolution, ambient_occlusion;
  std::optional<double> translucency, translucency_angle;
  std::optional<std::vector<SurfaceOption>> surfaces;
  std::optional<Color> surface_back_color;
  bool are_surfaces_one_sided = false;
  std::optional<bool> shows_volume;
  std::optional<std::vector<ClipShape>> clip_shapes;
  std::optional<bool> use_union;
  std::optional<OpacityWeight> weight;
  std::optional<double> weight_scale;

  bool wants_light() const;
};

struct RenderOptions {
  InputOptions input;
  FunctionOptions function;
  MultidimensionalOptions multidimensional;
  CameraOptions camera;
  MethodOptions method;
  EffectOptions effects;
  std::string output;        ///< empty: the input's name with ".png" in the current directory
  std::string output_depth;  ///< empty: none
  std::optional<std::array<int, 2>> resolution;
  std::optional<Color> background;
  bool use_alpha = false;
  std::optional<int> bit_depth;
  int repeat = 1;
  std::string statistics;
  std::string save_scene;
  bool is_quiet = false;
  bool is_verbose = false;
};

struct InfoOptions {
  InputOptions input;
  bool use_json = false;
};

/// What a histogram counts.
enum class HistogramKind {
  kValue,     ///< the volume that each value takes
  kGradient,  ///< by value and gradient magnitude
  kJoint      ///< by value and the value of another array
};

struct HistogramCommandOptions {
  InputOptions input;
  std::string output;  ///< empty: the input's name with "-histogram.png" in the current directory
  HistogramKind kind = HistogramKind::kValue;
  std::optional<ArrayRequest> other_array;  ///< of kJoint
  std::optional<bool> use_logarithm;        ///< of the counts; empty: for histograms of two variables only
  std::optional<int> bins, other_bins;
  std::optional<ValueRange> range, other_range;
};

struct OrderCommandOptions {
  InputOptions input;
  CameraOptions camera;
  SortMethod method = SortMethod::kXmpvo;
  SortDirection direction = SortDirection::kBackToFront;
  bool use_check = false;
  std::optional<std::array<int, 2>> resolution;  ///< rays of the check
  int threads = 0;
  int repeat = 1;
  std::string output;  ///< empty: none
  std::string statistics;
};

struct ListOptions {
  enum class Topic { kPresets, kReaders, kBuiltins, kMethods, kEnvironments, kSorts, kDevices };
  Topic topic = Topic::kPresets;
};

/// Help or version: text to print.
struct TextOptions {
  std::string text;
};

using CommandLine =
    std::variant<TextOptions, RenderOptions, InfoOptions, HistogramCommandOptions, OrderCommandOptions, ListOptions>;

/// @throws UsageError that names the option.
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace tetravox::tool
