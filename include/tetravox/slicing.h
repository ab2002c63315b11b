#pragma once

/// Drawing grids by slices: what graphics hardware did before it could cast rays (docs/methods/slicing.md).
///
/// A grid is cut into slabs, each between two slices; what a ray passes of a slab is one segment, and slabs are blended
/// in visibility order (Engel and Ertl 2002).

#include "tetravox/render.h"

#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// Number of slices that settings may ask for.
inline constexpr int kMostSlices = 16384;

/// A source as command lines and scene files name it: "slices=object-2d" has its kind with it.
struct SourceChoice {
  Source source = Source::kMarch;
  SlicingKind slicing = SlicingKind::kView3d;

  bool operator==(const SourceChoice&) const = default;
};
std::string name_of(const SourceChoice& choice);
/// "walk", "march", "slices" (by view-3d), "slices=KIND". @throws Error (kInvalidArgument) that lists the names there
/// are.
SourceChoice source_choice_from_name(const std::string& name);

std::string name_of(SlicingKind kind);  ///< "object-2d", ...
SlicingKind slicing_kind_from_name(const std::string& name);
std::vector<std::pair<std::string, std::string>> slicing_kind_names();

std::string name_of(SlabShape shape);  ///< "linear", "curved"
SlabShape slab_shape_from_name(const std::string& name);
std::vector<std::pair<std::string, std::string>> slab_shape_names();

/// @throws Error (kInvalidArgument) that names the member.
void validate_slicing(const SlicingSettings& settings);

}  // namespace tetravox
