#include "src/optics/cylindrical_atlas.h"

#include "src/optics/record_mix.h"
#include "src/support/memory.h"
#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tetravox::optics {
namespace {

/// Difference of scalars and share of the length on a plane, for a radius of 1.
struct PlaneDirection {
  double difference = 0.0, share = 0.0;
};

PlaneDirection direction_of(double turn) {
  if (turn > 1.0) return {1.0, 2.0 - turn};
  if (turn < -1.0) return {-1.0, 2.0 + turn};
  return {turn, 1.0};
}

/// Quotients along a row of a tile: of segments with the same difference of scalars and the same length.
class AtlasRow {
 public:
  AtlasRow(const SegmentIntegral& function, double longest, const PreintegrationSettings& settings,
           const PlaneDirection& direction, int row)
      : function_(function),
        settings_(settings),
        texel_(1.0 / (settings.tile - 1)),
        difference_(direction.difference * row * texel_),
        length_(direction.share * row * texel_ * longest) {
    const double largest = function.largest_extinction();
    bound_ = length_ > 0.0 ? -std::expm1(-largest * length_) : largest;
  }

  void store(int column, float* texel) const {
    const double least = column * texel_ * (1.0 - std::abs(difference_));
    const double front = least + std::max(-difference_, 0.0), back = std::clamp(front + difference_, 0.0, 1.0);
    Slab quotient;
    if (length_ > 0.0) {
      quotient = function_.integrate_in_steps(front, back, length_, settings_.steps);
    } else {
      const OpticalDensity limit = function_.mean(front, back);
      quotient = {{limit[1], limit[2], limit[3]}, limit[0]};
    }
    store_quotient(quotient, bound_, settings_.bits, texel);
  }

 private:
  const SegmentIntegral& function_;
  const PreintegrationSettings& settings_;
  double texel_, difference_, length_, bound_ = 0.0;
};

}  // namespace

int count_atlas_columns(int planes) { return static_cast<int>(std::ceil(std::sqrt(static_cast<double>(planes)))); }

std::uint64_t cylindrical_atlas_bytes(int planes, int tile) {
  const auto columns = static_cast<std::uint64_t>(count_atlas_columns(planes));
  const std::uint64_t rows = (static_cast<std::uint64_t>(planes) + columns - 1) / columns;
  return columns * rows * static_cast<std::uint64_t>(tile) * static_cast<std::uint64_t>(tile) * 4 * sizeof(float);
}

void build_cylindrical_atlas(const PreintegrationSource& source, const PreintegrationSettings& settings,
                             CylindricalAtlas& atlas) {
  const int planes = settings.planes, tile = settings.tile;
  const std::uint64_t bytes = cylindrical_atlas_bytes(planes, tile);
  if (bytes > atlas.bytes())
    support::require_memory(bytes - atlas.bytes(), "an atlas of " + std::to_string(planes) + " tiles of " +
                                                       std::to_string(tile) + " x " + std::to_string(tile));
  const SegmentIntegral function(source.function, find_table_range(source));
  atlas.domain = make_segment_domain(source);
  atlas.planes = planes;
  atlas.tile = tile;
  atlas.columns = count_atlas_columns(planes);
  atlas.rows = (planes + atlas.columns - 1) / atlas.columns;
  atlas.texels.assign(bytes / sizeof(float), 0.0f);

  const auto fill_row = [&](int plane, int row) {
    const int x = plane % atlas.columns * tile, y = plane / atlas.columns * tile + row;
    float* texel = atlas.texels.data() + 4 * (static_cast<std::size_t>(y) * atlas.columns * tile + x);
    const AtlasRow quotients(function, source.longest, settings, direction_of(-2.0 + 4.0 * plane / (planes - 1)), row);
    for (int column = 0; column < tile; ++column, texel += 4) quotients.store(column, texel);
  };
  const std::size_t rows = static_cast<std::size_t>(planes) * static_cast<std::size_t>(tile);
  TableProgress progress(&source.progress, rows);
  support::parallel_chunks(rows, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      progress.next();
      fill_row(static_cast<int>(i / static_cast<std::size_t>(tile)),
               static_cast<int>(i % static_cast<std::size_t>(tile)));
    }
  });
}

SegmentColor eval_cylindrical_atlas(const CylindricalAtlas& atlas, float scalar_front, float scalar_back,
                                    float length) {
  const SegmentDomain& domain = atlas.domain;
  const float front = eval_scalar_place(domain, scalar_front);
  const float back = eval_scalar_place(domain, scalar_back), difference = back - front;
  const float share = std::min(length, domain.longest) / domain.longest;
  const float slant = std::abs(difference), radius = std::max(slant, share);
  const float divisor = std::max(radius, 1e-30f);
  const float steep = 2.0f - share / divisor, flat = slant / divisor;
  const float turn = std::copysign(slant > share ? steep : flat, difference);

  const Node plane = find_node((turn + 2.0f) * 0.25f, atlas.planes);
  const float along = std::min(std::min(front, back) / std::max(1.0f - slant, 1e-6f), 1.0f);
  const Node x = find_node(along, atlas.tile), y = find_node(radius, atlas.tile);
  const std::size_t row = static_cast<std::size_t>(atlas.columns) * static_cast<std::size_t>(atlas.tile);
  const auto look_up = [&](std::size_t index) {
    const auto columns = static_cast<std::size_t>(atlas.columns), tile = static_cast<std::size_t>(atlas.tile);
    const std::size_t corner = index / columns * tile * row + index % columns * tile;
    return mix_square(atlas.texels.data(), corner + y.index * row + x.index, row, x.part, y.part);
  };
  return unfold(mix(plane.part, look_up(plane.index), look_up(plane.index + 1)), eval_opacity_bound(domain, length));
}

}  // namespace tetravox::optics
