#pragma once

/// Light: what makes shape visible. Blinn-Phong as in Engel and Ertl 2002, shadows, ambient occlusion, surroundings.
///
/// Without lights a picture is emission and absorption alone (docs/conventions.md). With them, the emitted colour c of
/// each stretch of a ray is multiplied by the light that arrives there, and a highlight is added
/// (docs/methods/light.md).

#include "tetravox/camera.h"
#include "tetravox/transfer_function.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// Where normals come from.
enum class GradientMethod {
  kDefault,  ///< meshes: kVertex; grids: kFilter, but kCentral where the filter is linear or nearest
  kFilter,   ///< grids: the exact derivative of the reconstructed field (jumps from cell to cell where that is linear)
  kCentral,  ///< grids: central differences of the values, linear in between
  kVertex,   ///< meshes: volume-weighted averages at the vertices, linear in between
  kCell      ///< meshes: the constant gradient of each tetrahedron
};

/// Weights of the terms; each in [0, 1].
struct Material {
  double ambient = 0.3;
  double diffuse = 0.7;
  double specular = 0.3;
  double shininess = 32.0;  ///< exponent of the highlight, in [1, 1000]
};

enum class LightKind {
  kHeadlight,    ///< shines from the eye
  kDirectional,  ///< parallel rays
  kPoint         ///< shines from a place, equally strong at any distance
};

struct Light {
  LightKind kind = LightKind::kHeadlight;
  Vector3 direction{0, 0, -1};  ///< kDirectional: in which it travels, world; any length but 0
  Vector3 position{};           ///< kPoint: world
  Color color{1, 1, 1};
  double intensity = 1.0;  ///< >= 0
};

enum class ShadowKind {
  kNone,
  kVolume,  ///< optical depth towards each light, on a lattice that it sees
  kExact,   ///< a ray from each light to each place that is lit, for stills
  /// Source kSlices: slices half way between view and light, drawn from both in turns (Kniss, Premoze, Hansen, Ebert
  /// 2002). One directional light.
  kHalfAngle
};

/// Light from all around, as a picture of the surroundings has it (environment.h). It throws no shadows; ambient
/// occlusion darkens its diffuse part.
struct EnvironmentLight {
  std::string file;        ///< as `read_environment` takes it, or "builtin:NAME"; the renderer is handed what it holds
  double intensity = 1.0;  ///< in [0, 1e6]
  double rotation = 0.0;   ///< degrees about `up`, counter-clockwise as seen from above; see `environment_axes`
  Vector3 up{0, 0, 1};     ///< world direction of the picture's upper edge; any length but 0
};

struct Lighting {
  std::vector<Light> lights;
  std::optional<EnvironmentLight> environment;
  Material material;
  GradientMethod gradient = GradientMethod::kDefault;
  /// Gradient magnitude at which shading is at half its strength, in units of value range / diagonal of the bounds;
  /// below it light fades to what needs no normal, so that homogeneous regions are not noise. 0: full everywhere.
  double gradient_threshold = 2.0;
  bool is_two_sided = true;  ///< whether sides that look away from a light are lit as if they faced it
  ShadowKind shadows = ShadowKind::kNone;
  int shadow_resolution = 128;       ///< of all but kExact: lattice points along each axis, in [8, 512]
  double translucency = 0.0;         ///< of kHalfAngle: part of the light that is scattered forward, in [0, 1]
  double translucency_angle = 20.0;  ///< of the cone that it is scattered into, degrees off its axis, in [0, 80]
  int ambient_occlusion = 0;         ///< directions over the sphere, in [0, 1024]; 0: none
  std::uint64_t occlusion_seed = 1;  ///< of the order of directions
  bool is_lit() const { return !lights.empty() || environment.has_value(); }
};

/// Names of enumerators as on the command line and in scene files, and back.
/// @throws Error (kInvalidArgument) that lists the names there are.
std::string name_of(GradientMethod method);  ///< "default", "filter", "central", "vertex", "cell"
GradientMethod gradient_method_from_name(const std::string& name);
std::string name_of(LightKind kind);  ///< "headlight", "directional", "point"
LightKind light_kind_from_name(const std::string& name);
std::string name_of(ShadowKind kind);  ///< "none", "volume", "exact", "half-angle"
ShadowKind shadow_kind_from_name(const std::string& name);
/// Names, one-line descriptions.
std::vector<std::pair<std::string, std::string>> gradient_method_names();
std::vector<std::pair<std::string, std::string>> shadow_kind_names();

/// @throws Error (kInvalidArgument) that names the member.
void validate_lighting(const Lighting& lighting);

}  // namespace tetravox
