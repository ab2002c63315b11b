#pragma once

/// Prepared mesh or grid + optical function + camera -> picture: on the CPU, or by OpenGL (gl.h).
///
/// The one-call function is `render`. `Renderer` keeps what can be kept between frames.

#include "tetravox/camera.h"
#include "tetravox/clipping.h"
#include "tetravox/environment.h"
#include "tetravox/grid.h"
#include "tetravox/image.h"
#include "tetravox/isosurface.h"
#include "tetravox/lighting.h"
#include "tetravox/mesh.h"
#include "tetravox/multidimensional.h"
#include "tetravox/preintegration.h"
#include "tetravox/progress.h"
#include "tetravox/projection.h"
#include "tetravox/transfer_function.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// Where segments come from.
enum class Source {
  kWalk,     ///< meshes: ray casting from cell to cell (Garrity 1990; Weiler et al. 2003)
  kProject,  ///< meshes, OpenGL: projected tetrahedra (Shirley and Tuchman 1990; Wilhelms and Van Gelder 1991)
  kVicp,     ///< meshes, OpenGL: view-independent cell projection (Weiler, Kraus, Merz, Ertl 2003)
  kMarch,    ///< grids: ray casting brick by brick (Grimm, Bruckner, Kanitsar, Groeller 2004)
  kSlices    ///< grids, OpenGL: slabs between slices, blended (Cullip and Neumann 1993; Engel and Ertl 2002)
};

/// What slices are, and what they are cut from (Engel and Ertl 2002).
enum class SlicingKind {
  kObject2d,              ///< the 2D textures of the stack that lies most across the view, one by one
  kObject2dInterpolated,  ///< the same with slices between them, interpolated from two textures
  kStripes2d,             ///< planes across the view, cut into stripes between neighbouring 2D textures of one stack
  kView3d,                ///< planes across the view through a 3D texture (default)
  kShells                 ///< spheres round the eye through a 3D texture: equal distances in a perspective
};

/// What pre-integration takes the field for between two slices.
enum class SlabShape {
  kLinear,  ///< linear along the ray: one segment (Engel, Kraus, Ertl 2001)
  kCurved   ///< the parabola through a third sample, in the middle: as many segments as it bends (default)
};

/// How grids are drawn by slices; more in slicing.h.
struct SlicingSettings {
  SlicingKind kind = SlicingKind::kView3d;
  int slices = 0;  ///< along the diagonal of the grid, in [1, kMostSlices]; 0: as the rate says
  SlabShape slabs = SlabShape::kCurved;
  double slices_per_voxel = 2.0;  ///< the rate: a mean distance of values, in (0, kHighestRate]
};

/// What turns a segment into colour and opacity.
enum class Integrator {
  kAntiderivative,  ///< tables of antiderivatives, split where the error estimate asks (default)
  kPartial,         ///< exact for piecewise linear functions (Moreland and Angel 2004; Espinha and Celes 2005)
  kPost,            ///< post-classification: N point samples a segment, for comparison
  kPre,             ///< pre-classification: colours and extinctions at the values, interpolated; for comparison
  kTable3d,         ///< full pre-integration in a 3D table (Roettger, Kraus, Ertl 2000); for comparison
  kPolynomial,      ///< separable opacity, polynomial chromaticity (Guthe et al. 2002); for comparison
  kCylindrical      ///< the 3D table as a 2D atlas, meshes only (Roettger and Ertl 2002); for comparison
};

/// What makes homogeneous regions fade: extinction is multiplied by how fast the scalar changes, in units of value
/// range / diagonal of the bounds, times `RenderSettings::opacity_weight_scale`, at most 1.
enum class OpacityWeight {
  kNone,
  kScalarDifference,  ///< along the ray: of the segment's two scalars (Engel and Ertl 2002, figure 40)
  kGradient           ///< in space: the magnitude of the gradient (Levoy 1988)
};

/// How the places where rays enter a mesh are put in order, by OpenGL.
enum class EntryOrder {
  kLists,   ///< lists of each pixel, sorted (Yang, Hensley, Gruen, Thibieroz 2010; default)
  kPeeling  ///< depth peeling of the boundary, a layer a pass (Everitt 2001; Espinha and Celes 2005)
};

inline constexpr int kLargestResolution = 16384;
inline constexpr double kSmallestTolerance = 1e-7;
inline constexpr double kLowestRate = 1e-3, kHighestRate = 64.0;  ///< samples a voxel

struct RenderSettings {
  int width = 512;  ///< pixels, in [1, kLargestResolution]
  int height = 512;
  std::optional<Source> source;  ///< empty: the one for the data
  Integrator integrator = Integrator::kAntiderivative;
  double tolerance = 2e-3;                ///< error in colour that a picture may have, in [1e-7, 1]: half an 8-bit step
  int samples = 8;                        ///< samples a segment (post), in [1, 4096]
  PreintegrationSettings preintegration;  ///< tables of table3d, polynomial and cylindrical
  EntryOrder entry_order = EntryOrder::kLists;  ///< meshes, gl
  Filter filter;                                ///< how a grid's field is reconstructed
  /// Grids: fixed rate along the ray, from kLowestRate to kHighestRate; 0: as the tolerance asks.
  double samples_per_voxel = 0.0;
  ProjectionSettings projection;  ///< of the sources kProject and kVicp
  SlicingSettings slicing;        ///< of the source kSlices
  Lighting lighting;
  std::vector<Isosurface> surfaces;
  Clipping clipping;
  OpacityWeight opacity_weight = OpacityWeight::kNone;
  double opacity_weight_scale = 0.1;  ///< > 0
  bool wants_depth = false;           ///< fill `Image::depth`
  bool use_early_ray_termination =
      true;                     ///< stop a ray when no 8-bit pixel over any background can change; grids: also when
                                ///< less than a tenth of a tolerance above one 8-bit step comes through
  int threads = 0;              ///< 0: all cores
  std::string instruction_set;  ///< "": the best there is; otherwise one of `instruction_sets()`
};

struct RenderStatistics {
  double seconds = 0.0;
  double plan_seconds = 0.0;  ///< of these, what is done only after a new transfer function, filter, tolerance or table
  std::uint64_t segments = 0;      ///< ray-cell segments, as walked or marched
  std::uint64_t rays = 0;          ///< rays that met the data
  std::uint64_t stopped_rays = 0;  ///< rays stopped by the bound on steps (damaged meshes only)
  int slices = 0;                  ///< slabs between slices that were drawn (source kSlices)
  int threads = 0;
  std::string backend;              ///< "cpu" or "gl"
  std::string device;               ///< gl: what OpenGL calls its renderer
  std::string instruction_set;      ///< cpu
  ProjectionStatistics projection;  ///< of the sources kProject and kVicp
  std::string integrator;           ///< name of the one that drew; "domain" for functions of several variables
};

/// Names of enumerators as on the command line and in scene files ("walk", "project", "vicp", "march", "slices";
/// "antiderivative", "partial", "post", "pre", "table3d", "polynomial", "cylindrical"), and back.
std::string name_of(Source source);
std::string name_of(Integrator integrator);
std::string name_of(EntryOrder order);      ///< "lists", "peeling"
std::string name_of(OpacityWeight weight);  ///< "none", "scalar-difference", "gradient"
/// @throws Error (kInvalidArgument) that lists the names there are.
Source source_from_name(const std::string& name);
Integrator integrator_from_name(const std::string& name);
EntryOrder entry_order_from_name(const std::string& name);
OpacityWeight opacity_weight_from_name(const std::string& name);
/// The integrator with its number, as command lines and scene files have it: "polynomial=2"; its name where it has
/// none.
std::string format_integrator(const RenderSettings& settings);
/// The same read: sets the integrator, and `PreintegrationSettings::degree` where the text has a number.
/// @throws Error (kInvalidArgument) that lists the names there are, or the numbers.
void parse_integrator(const std::string& text, RenderSettings& settings);
/// Names, one-line descriptions with the paper.
std::vector<std::pair<std::string, std::string>> source_names();
std::vector<std::pair<std::string, std::string>> integrator_names();
std::vector<std::pair<std::string, std::string>> entry_order_names();
std::vector<std::pair<std::string, std::string>> opacity_weight_names();

/// The integrators that a source of a backend draws by.
struct SourceMethods {
  std::string backend;  ///< "cpu" or "gl"
  Source source = Source::kWalk;
  std::vector<Integrator> integrators;
};

/// Those of the CPU; those of OpenGL are in gl.h.
std::vector<SourceMethods> cpu_methods();

/// The instruction sets compiled in and supported by this machine, best first.
std::vector<std::string> instruction_sets();

namespace scene {
class FrameRenderer;
}

/// Draws one mesh or grid many times. Views it: it must outlive the renderer. Not safe for concurrent calls; use one
/// for each thread.
class Renderer {
 public:
  explicit Renderer(const PreparedMesh& mesh);
  explicit Renderer(const PreparedGrid& grid);
  /// For backends: `make_gl_renderer` in gl.h.
  explicit Renderer(std::unique_ptr<scene::FrameRenderer> frames);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// One pass over a 1D table, under a millisecond; tables of ray integrals (`RenderSettings::preintegration`) are made
  /// in the next frame that looks them up. What was set by the two functions below is dropped.
  /// Extinctions beyond what is opaque within a millionth of the mesh's diagonal are taken as that.
  /// @throws Error (kInvalidArgument) for no points, values that descend or are not finite, negative extinctions.
  void set_transfer_function(const OpticalFunction& function);

  /// Draws by a function of two or three variables instead (docs/methods/multidimensional.md). `others`: for each of
  /// its variables of kind kArray, in their order, which of `PreparedMesh::others` or `PreparedGrid::others` it is;
  /// empty: 0, 1, ... A gradient comes from where `Lighting::gradient` says, whether lit or not.
  /// @throws Error (kInvalidArgument) for a table that makes no sense, or others that there are not. Such pictures know
  /// no post- and pre-classification, no fixed rate and no exact shadows: `render` throws kUnsupported.
  void set_multidimensional_function(const OpticalTable& table, const std::vector<std::size_t>& others = {});

  /// Keeps the opacities of the transfer function set last, and takes the colours from another array: `colors` (its
  /// extinctions do not count) at the values of `others[other]` of the prepared mesh or grid. Errors as above.
  void set_color_function(std::size_t other, const OpticalFunction& colors);

  /// The grid of the clip volume at index `shape` of `RenderSettings::clipping`. Views it.
  void set_clip_volume(std::size_t shape, const PreparedGrid& grid);

  /// The surroundings that `Lighting::environment` stands for. Views them. They are filtered at the next frame that
  /// they light, and again only where the material's shininess has changed.
  /// @throws Error (kInvalidArgument); see `validate_environment`.
  void set_environment(const Environment& environment);

  /// The picture. The same bytes for any number of threads, on every run and with every instruction set.
  /// @throws Error: kInvalidArgument for settings or camera out of range, kOutOfMemory, kCancelled.
  Image render(const Camera& camera, const RenderSettings& settings, RenderStatistics* statistics = nullptr,
               const Progress& progress = {});

  /// Bytes held for the camera's frame and the tables.
  std::uint64_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One call for one picture; see `Renderer`.
Image render(const PreparedMesh& mesh, const OpticalFunction& function, const Camera& camera,
             const RenderSettings& settings = {});
Image render(const PreparedGrid& grid, const OpticalFunction& function, const Camera& camera,
             const RenderSettings& settings = {});

/// Bytes that rendering needs beside the prepared mesh: the camera's vertices, tables, picture. Upper estimate.
std::uint64_t estimate_render_memory(std::uint64_t vertices, std::uint64_t boundary_faces,
                                     const RenderSettings& settings);
/// The same for a grid: copies that the filter asks for, tables, picture.
std::uint64_t estimate_render_memory(const GridData& grid, const RenderSettings& settings);

}  // namespace tetravox
