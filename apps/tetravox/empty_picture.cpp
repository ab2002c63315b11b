#include "apps/tetravox/empty_picture.h"

#include "apps/tetravox/text.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetravox::tool {
namespace {

constexpr float kVisible = 0.5f / 255.0f;  // half an 8-bit step

/// Largest opacity of a pixel, and largest difference from the background once composited over it.
struct Visibility {
  float alpha = 0.0f;
  float contrast = 0.0f;
};

Visibility measure_visibility(const Image& image, const Color& background) {
  Visibility result;
  for (std::size_t i = 0; i + 3 < image.pixels.size(); i += 4) {
    const float* pixel = image.pixels.data() + i;
    result.alpha = std::max(result.alpha, pixel[3]);
    for (std::size_t c = 0; c < 3; ++c)
      result.contrast = std::max(result.contrast, std::abs(pixel[c] - pixel[3] * static_cast<float>(background[c])));
  }
  return result;
}

/// Largest extinction that the function has anywhere in the range.
double largest_extinction(const OpticalFunction& function, const ValueRange& range) {
  double largest = std::max(eval_optical_function(function, range.min).extinction,
                            eval_optical_function(function, range.max).extinction);
  for (const OpticalPoint& point : function.points)
    if (point.value >= range.min && point.value <= range.max) largest = std::max(largest, point.extinction);
  return largest;
}

std::string explain_transparent(const PictureContext& context) {
  if (!context.scene.settings.clipping.shapes.empty())
    return "the picture is empty: the clipping keeps nothing that can be seen; the data lie in " +
           format_bounds(bounds_of(context.body)) + "; --clip-box none shows them whole";
  // Where no brick has anything opaque, no ray is followed: that the camera sees the data cannot be told.
  if (context.scene.multidimensional)
    return "the picture is empty: nothing that is opaque by the widgets or the table lies where the data are, or the "
           "camera does not see them (" +
           format_bounds(bounds_of(context.body)) +
           "); choose other widgets, another table or wider ranges, or leave them out for a function from the data";
  const ValueRange range = scalar_range_of(context.body);
  const bool is_volume_seen = largest_extinction(context.completed.optical_function, range) > 0.0;
  if (!is_volume_seen && !context.scene.settings.surfaces.empty())
    return "the picture is empty: of its iso-surfaces none is seen, and the volume is off or transparent; give an "
           "--isosurface within " +
           format_range(range) + ", or --volume on";
  if (!is_volume_seen)
    return "the picture is empty: the transfer function is transparent over the data's range " + format_range(range) +
           "; give --range " + format_number(range.min) + "," + format_number(range.max) +
           " or another --transfer-function";
  if (context.statistics.rays == 0)
    return "the picture is empty: the camera does not see the data (" + format_bounds(bounds_of(context.body)) +
           "); leave the camera out for a view of everything";
  return "the picture is empty: the transfer function is too thin to be seen; give a smaller --unit-distance or "
         "larger extinctions";
}

/// Values of iso-surfaces beyond the data; empty where there are none.
std::string list_surfaces_outside(const Scene& scene, const ValueRange& range) {
  std::string list;
  for (const Isosurface& surface : scene.settings.surfaces)
    if (!(surface.value >= range.min && surface.value <= range.max))
      list += (list.empty() ? "" : ", ") + format_number(surface.value);
  return list;
}

/// Names of other arrays, to try instead of a constant one.
std::string other_arrays(const DatasetInfo& info, const std::string& name) {
  std::string list;
  for (const ArrayInfo& array : info.arrays)
    if (array.name != name && array.magnitude_range.min < array.magnitude_range.max && list.size() < 200)
      list += (list.empty() ? "" : ", ") + array.name;
  return list;
}

}  // namespace

std::vector<std::string> explain_picture(const Image& image, const PictureContext& context) {
  std::vector<std::string> lines;
  const ValueRange range = scalar_range_of(context.body);
  if (!(range.min < range.max)) {
    const std::string& name = context.scene.data.array.name;
    const std::string others = other_arrays(context.info, name);
    lines.push_back("the array '" + name + "' is " + format_number(range.min) + " everywhere" +
                    (others.empty() ? "" : "; others to draw with --array: " + others));
  }
  const Visibility visibility = measure_visibility(image, context.scene.background);
  const std::string outside = list_surfaces_outside(context.scene, range);
  if (!outside.empty())
    lines.push_back("iso-surfaces outside the data's range " + format_range(range) + ": " + outside);
  if (visibility.alpha < kVisible)
    lines.push_back(explain_transparent(context));
  else if (visibility.contrast < kVisible)
    lines.push_back("the picture shows only its background's colour; give another --background or --transfer-function");
  return lines;
}

}  // namespace tetravox::tool
