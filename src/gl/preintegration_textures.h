#pragma once

/// Tables of ray integrals on the device: of `table3d`, `polynomial` and `cylindrical`.

#include "src/gl/context.h"
#include "src/gl/resources.h"
#include "src/gl/table_maker.h"
#include "src/scene/preintegration_cache.h"

#include <cstdint>
#include <optional>

namespace tetravox::gl {

/// One table at a time. With the context current.
class PreintegrationTextures {
 public:
  /// Puts the cache's table there where it is not yet, and binds it. Sizes: see `require_table_size`.
  void bind(const scene::PreintegrationCache& cache);
  /// Makes the table on the device, where it is not at hand, and binds it.
  void make(const optics::PreintegrationSource& source, const RenderSettings& settings);
  /// The function has changed.
  void invalidate() { made_for_.reset(); }
  std::uint64_t bytes() const { return table_.bytes + block_.bytes() + maker_.bytes(); }

 private:
  void upload(const optics::PreintegrationTable& table);
  void upload(const optics::PolynomialTable& table);
  void upload(const optics::CylindricalAtlas& atlas);
  void bind();

  /// What a table of the device was made for.
  struct Made {
    Integrator integrator;
    PreintegrationSettings settings;
    double longest = 0.0;
    bool operator==(const Made&) const = default;
  };
  std::uint64_t number_ = 0;      // of the cache's table that is there; 0: another
  std::optional<Made> made_for_;  // where the device has made it
  DeviceTable table_;
  TableMaker maker_;
  Buffer block_;
};

}  // namespace tetravox::gl
