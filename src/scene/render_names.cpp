/// Names of enumerators, for command lines and scene files.

#include "tetravox/error.h"
#include "tetravox/multidimensional.h"
#include "tetravox/render.h"
#include "tetravox/slicing.h"

#include <array>
#include <string_view>

namespace tetravox {
namespace {

template <class Enumerator>
struct Name {
  Enumerator value;
  std::string_view name;
  std::string_view description;
};

constexpr std::array<Name<Source>, 5> kSources{
    {{Source::kWalk, "walk", "meshes: ray casting from cell to cell (Garrity 1990; Weiler et al. 2003)"},
     {Source::kProject, "project",
      "meshes, by OpenGL: projected tetrahedra (Shirley and Tuchman 1990; Wilhelms and Van Gelder 1991)"},
     {Source::kVicp, "vicp", "meshes, by OpenGL: view-independent cell projection (Weiler, Kraus, Merz, Ertl 2003)"},
     {Source::kMarch, "march", "grids: ray casting brick by brick (Grimm, Bruckner, Kanitsar, Groeller 2004)"},
     {Source::kSlices, "slices",
      "grids, by OpenGL: slabs between slices, blended; slices=KIND (Engel and Ertl 2002)"}}};

constexpr std::array<Name<SlicingKind>, 5> kSlicingKinds{
    {{SlicingKind::kObject2d, "object-2d", "the 2D textures of the stack most across the view, one by one"},
     {SlicingKind::kObject2dInterpolated, "object-2d-interpolated",
      "slices between them too, interpolated from two textures (Rezk-Salama et al. 2000)"},
     {SlicingKind::kStripes2d, "stripes-2d",
      "planes across the view, cut into stripes between 2D textures (Engel and Ertl 2002)"},
     {SlicingKind::kView3d, "view-3d", "planes across the view through a 3D texture (Cullip and Neumann 1993)"},
     {SlicingKind::kShells, "shells", "spheres round the eye (LaMar, Hamann, Joy 1999)"}}};

constexpr std::array<Name<SlabShape>, 2> kSlabShapes{
    {{SlabShape::kLinear, "linear", "one segment, linear between two slices (Engel, Kraus, Ertl 2001)"},
     {SlabShape::kCurved, "curved", "as many as the field bends, by a third sample in the middle (default)"}}};

constexpr std::array<Name<CellSort>, 5> kCellSorts{
    {{CellSort::kCentroid, "centroid", "cells by the distance of centroids: wrong now and then"},
     {CellSort::kMpvo, "mpvo", "cells by shared faces: exact for convex meshes (Williams 1992)"},
     {CellSort::kMpvonc, "mpvonc", "his heuristic for non-convex meshes: wrong now and then (Williams 1992)"},
     {CellSort::kXmpvo, "xmpvo",
      "exact for every mesh without cycles (Silva, Mitchell, Williams 1998); used by default"},
     {CellSort::kExact, "exact",
      "the segments of each pixel by their depth: right for cyclic meshes, too (Carpenter 1984; Yang, Hensley, Gruen, "
      "Thibieroz 2010)"}}};

constexpr std::array<Name<Decomposition>, 2> kDecompositions{
    {{Decomposition::kCpu, "cpu", "by threads (Shirley and Tuchman 1990)"},
     {Decomposition::kGpu, "gpu", "by a compute shader (after Wylie, Moreland, Fisk, Crossno 2002)"}}};

constexpr std::array<Name<MeshTransfer>, 2> kMeshTransfers{
    {{MeshTransfer::kOrder, "order", "the order of cells; the mesh stays in graphics memory (Espinha and Celes 2005)"},
     {MeshTransfer::kCells, "cells", "vertices and cells in order (Weiler, Kraus, Merz, Ertl 2003)"}}};

constexpr std::array<Name<Integrator>, 7> kIntegrators{
    {{Integrator::kAntiderivative, "antiderivative",
      "tables of antiderivatives, split where the error estimate asks (Max, Hanrahan, Crawfis 1990; Lum, Wilson, Ma "
      "2004)"},
     {Integrator::kPartial, "partial",
      "exact for piecewise linear functions (Moreland and Angel 2004; Espinha and Celes 2005)"},
     {Integrator::kPost, "post",
      "post-classification: point samples along each segment; for comparison (Engel and Ertl 2002)"},
     {Integrator::kPre, "pre",
      "pre-classification: colours and extinctions at the values, interpolated; for comparison (Wittenbrink, "
      "Malzbender, Goss 1998)"},
     {Integrator::kTable3d, "table3d",
      "full pre-integration in a table over both scalars and the length; for comparison (Roettger, Kraus, Ertl 2000)"},
     {Integrator::kPolynomial, "polynomial",
      "polynomial=N: separable opacity, chromaticity as a polynomial of degree N, 0 to 4, in the length; for "
      "comparison "
      "(Guthe, Roettger, Schieber, Strasser, Ertl 2002)"},
     {Integrator::kCylindrical, "cylindrical",
      "meshes: the table in sheared cylindrical coordinates, tiles of a 2D atlas; for comparison (Roettger and Ertl "
      "2002)"}}};

constexpr std::array<Name<LengthSpacing>, 2> kLengthSpacings{
    {{LengthSpacing::kUniform, "uniform", "equal steps (Roettger, Kraus, Ertl 2000)"},
     {LengthSpacing::kLogarithmic, "logarithmic", "fine where short (after Kraus, Qiao, Ebert 2004)"}}};

constexpr std::array<Name<OpacityModel>, 2> kOpacityModels{
    {{OpacityModel::kExponential, "exponential", "1 - exp(-x) of the optical depth x"},
     {OpacityModel::kLinear, "linear", "min(1, x), for comparison"}}};

constexpr std::array<Name<TableDevice>, 2> kTableDevices{
    {{TableDevice::kCpu, "cpu", "exact means of every step, in double precision"},
     {TableDevice::kGpu, "gpu", "the device that draws, by blended samples as in the papers"}}};

constexpr std::array<Name<EntryOrder>, 2> kEntryOrders{
    {{EntryOrder::kLists, "lists", "a sorted list for each pixel (Yang, Hensley, Gruen, Thibieroz 2010)"},
     {EntryOrder::kPeeling, "peeling", "depth peeling of the boundary (Everitt 2001; Espinha and Celes 2005)"}}};

constexpr std::array<Name<OpacityWeight>, 3> kOpacityWeights{
    {{OpacityWeight::kNone, "none", "extinction as the function says"},
     {OpacityWeight::kScalarDifference, "scalar-difference",
      "by the change of the scalar along the ray (Engel and Ertl 2002, figure 40)"},
     {OpacityWeight::kGradient, "gradient", "by the magnitude of the gradient (Levoy 1988)"}}};

constexpr std::array<Name<GradientMethod>, 5> kGradientMethods{
    {{GradientMethod::kDefault, "default", "vertex for meshes; filter for grids, central with linear or nearest"},
     {GradientMethod::kFilter, "filter", "grids: the derivative of the filter"},
     {GradientMethod::kCentral, "central", "grids: central differences of the values"},
     {GradientMethod::kVertex, "vertex", "meshes: volume-weighted averages at the vertices"},
     {GradientMethod::kCell, "cell", "meshes: the constant gradient of each tetrahedron"}}};

constexpr std::array<Name<LightKind>, 3> kLightKinds{{{LightKind::kHeadlight, "headlight", "shines from the eye"},
                                                      {LightKind::kDirectional, "directional", "parallel rays"},
                                                      {LightKind::kPoint, "point", "shines from a place"}}};

constexpr std::array<Name<ShadowKind>, 4> kShadowKinds{
    {{ShadowKind::kNone, "none", "light reaches everything"},
     {ShadowKind::kVolume, "volume",
      "optical depth towards each light, on a lattice that it sees (after Behrens and Ratering 1998)"},
     {ShadowKind::kExact, "exact",
      "a ray from each light to each place that is lit: sharp, slow, for stills (Kajiya and Von Herzen 1984)"},
     {ShadowKind::kHalfAngle, "half-angle",
      "source slices: slices half way between view and light (Kniss, Premoze, Hansen, Ebert 2002)"}}};

constexpr std::array<Name<VariableKind>, 3> kVariableKinds{
    {{VariableKind::kValue, "value", "the value drawn"},
     {VariableKind::kGradient, "gradient", "its gradient magnitude (Kindlmann and Durkin 1998)"},
     {VariableKind::kArray, "array", "the value of another array"}}};

constexpr std::array<Name<WidgetShape>, 3> kWidgetShapes{
    {{WidgetShape::kRectangle, "rectangle", "the same all over"},
     {WidgetShape::kTriangle, "triangle", "widens upwards from its apex (Levoy 1988; Kniss, Kindlmann, Hansen 2002)"},
     {WidgetShape::kGaussian, "gaussian", "falls in all directions (Kniss et al. 2003)"}}};

template <class Names>
auto enumerator_from_name(const Names& names, std::string_view name, std::string_view what) {
  std::string known;
  for (const auto& entry : names) {
    if (entry.name == name) return entry.value;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  throw Error(ErrorCode::kInvalidArgument,
              "there is no " + std::string(what) + " '" + std::string(name) + "'; there is: " + known);
}

template <class Names, class Enumerator>
std::string name_of_enumerator(const Names& names, Enumerator value) {
  for (const auto& entry : names)
    if (entry.value == value) return std::string(entry.name);
  throw Error(ErrorCode::kInvalidArgument, "an enumerator without a name: " + std::to_string(static_cast<int>(value)));
}

template <class Names>
std::vector<std::pair<std::string, std::string>> list_names(const Names& names) {
  std::vector<std::pair<std::string, std::string>> list;
  for (const auto& entry : names) list.emplace_back(entry.name, entry.description);
  return list;
}

}  // namespace

std::string name_of(Source source) { return name_of_enumerator(kSources, source); }
std::string name_of(Integrator integrator) { return name_of_enumerator(kIntegrators, integrator); }
Source source_from_name(const std::string& name) { return enumerator_from_name(kSources, name, "source"); }
Integrator integrator_from_name(const std::string& name) {
  return enumerator_from_name(kIntegrators, name, "integrator");
}
std::string name_of(EntryOrder order) { return name_of_enumerator(kEntryOrders, order); }

std::string format_integrator(const RenderSettings& settings) {
  std::string text = name_of(settings.integrator);
  if (settings.integrator == Integrator::kPolynomial)
    text.append(1, '=').append(std::to_string(settings.preintegration.degree));
  return text;
}

void parse_integrator(const std::string& text, RenderSettings& settings) {
  const std::size_t sign = text.find('=');
  const Integrator integrator = integrator_from_name(text.substr(0, sign));
  if (sign != std::string::npos) {
    const std::string number = text.substr(sign + 1);
    if (integrator != Integrator::kPolynomial)
      throw Error(ErrorCode::kInvalidArgument,
                  "the integrator " + name_of(integrator) + " has no number: leave out '=" + number + "'");
    if (number.size() != 1 || number[0] < '0' || number[0] - '0' > kLargestDegree)
      throw Error(ErrorCode::kInvalidArgument,
                  "the integrator 'polynomial=" + number + "': the degree is a whole number from 0 to 4");
    settings.preintegration.degree = number[0] - '0';
  }
  settings.integrator = integrator;
}

std::string name_of(LengthSpacing spacing) { return name_of_enumerator(kLengthSpacings, spacing); }
std::string name_of(TableDevice device) { return name_of_enumerator(kTableDevices, device); }
TableDevice table_device_from_name(const std::string& name) {
  return enumerator_from_name(kTableDevices, name, "maker of tables");
}
std::string name_of(OpacityModel opacity) { return name_of_enumerator(kOpacityModels, opacity); }
LengthSpacing length_spacing_from_name(const std::string& name) {
  return enumerator_from_name(kLengthSpacings, name, "spacing of lengths");
}
OpacityModel opacity_model_from_name(const std::string& name) {
  return enumerator_from_name(kOpacityModels, name, "opacity model");
}
std::string name_of(CellSort sort) { return name_of_enumerator(kCellSorts, sort); }
std::string name_of(Decomposition decomposition) { return name_of_enumerator(kDecompositions, decomposition); }
std::string name_of(MeshTransfer transfer) { return name_of_enumerator(kMeshTransfers, transfer); }
CellSort cell_sort_from_name(const std::string& name) { return enumerator_from_name(kCellSorts, name, "sort"); }
Decomposition decomposition_from_name(const std::string& name) {
  return enumerator_from_name(kDecompositions, name, "decomposition");
}
MeshTransfer mesh_transfer_from_name(const std::string& name) {
  return enumerator_from_name(kMeshTransfers, name, "mesh transfer");
}
std::vector<std::pair<std::string, std::string>> cell_sort_names() { return list_names(kCellSorts); }
std::vector<std::pair<std::string, std::string>> decomposition_names() { return list_names(kDecompositions); }
std::vector<std::pair<std::string, std::string>> mesh_transfer_names() { return list_names(kMeshTransfers); }
std::string name_of(OpacityWeight weight) { return name_of_enumerator(kOpacityWeights, weight); }
std::string name_of(GradientMethod method) { return name_of_enumerator(kGradientMethods, method); }
std::string name_of(LightKind kind) { return name_of_enumerator(kLightKinds, kind); }
std::string name_of(ShadowKind kind) { return name_of_enumerator(kShadowKinds, kind); }
EntryOrder entry_order_from_name(const std::string& name) {
  return enumerator_from_name(kEntryOrders, name, "order of entries");
}
OpacityWeight opacity_weight_from_name(const std::string& name) {
  return enumerator_from_name(kOpacityWeights, name, "opacity weight");
}
GradientMethod gradient_method_from_name(const std::string& name) {
  return enumerator_from_name(kGradientMethods, name, "gradient method");
}
LightKind light_kind_from_name(const std::string& name) {
  return enumerator_from_name(kLightKinds, name, "kind of light");
}
ShadowKind shadow_kind_from_name(const std::string& name) {
  return enumerator_from_name(kShadowKinds, name, "kind of shadow");
}
std::vector<std::pair<std::string, std::string>> source_names() { return list_names(kSources); }
std::vector<std::pair<std::string, std::string>> integrator_names() { return list_names(kIntegrators); }
std::vector<std::pair<std::string, std::string>> entry_order_names() { return list_names(kEntryOrders); }
std::vector<std::pair<std::string, std::string>> opacity_weight_names() { return list_names(kOpacityWeights); }
std::vector<std::pair<std::string, std::string>> gradient_method_names() { return list_names(kGradientMethods); }
std::vector<std::pair<std::string, std::string>> shadow_kind_names() { return list_names(kShadowKinds); }

std::string name_of(SlicingKind kind) { return name_of_enumerator(kSlicingKinds, kind); }
SlicingKind slicing_kind_from_name(const std::string& name) {
  return enumerator_from_name(kSlicingKinds, name, "kind of slices");
}
std::vector<std::pair<std::string, std::string>> slicing_kind_names() { return list_names(kSlicingKinds); }

std::string name_of(SlabShape shape) { return name_of_enumerator(kSlabShapes, shape); }
SlabShape slab_shape_from_name(const std::string& name) {
  return enumerator_from_name(kSlabShapes, name, "shape of slabs");
}
std::vector<std::pair<std::string, std::string>> slab_shape_names() { return list_names(kSlabShapes); }

std::string name_of(const SourceChoice& choice) {
  std::string name = name_of(choice.source);
  if (choice.source == Source::kSlices) name.append("=").append(name_of(choice.slicing));
  return name;
}

SourceChoice source_choice_from_name(const std::string& name) {
  constexpr std::string_view kWithKind = "slices=";
  if (!name.starts_with(kWithKind)) return {.source = source_from_name(name)};
  return {Source::kSlices, slicing_kind_from_name(name.substr(kWithKind.size()))};
}

void validate_slicing(const SlicingSettings& settings) {
  if (settings.slices < 0 || settings.slices > kMostSlices)
    throw Error(ErrorCode::kInvalidArgument,
                "slices must be between 0 (as the rate says) and " + std::to_string(kMostSlices));
  if (!(settings.slices_per_voxel > 0.0 && settings.slices_per_voxel <= 64.0))
    throw Error(ErrorCode::kInvalidArgument, "slices per voxel must be above 0 and at most 64");
}

std::string name_of(VariableKind kind) { return name_of_enumerator(kVariableKinds, kind); }
std::string name_of(WidgetShape shape) { return name_of_enumerator(kWidgetShapes, shape); }
VariableKind variable_kind_from_name(const std::string& name) {
  return enumerator_from_name(kVariableKinds, name, "kind of variable");
}
WidgetShape widget_shape_from_name(const std::string& name) {
  return enumerator_from_name(kWidgetShapes, name, "shape of widget");
}
std::vector<std::pair<std::string, std::string>> variable_kind_names() { return list_names(kVariableKinds); }
std::vector<std::pair<std::string, std::string>> widget_shape_names() { return list_names(kWidgetShapes); }

}  // namespace tetravox
