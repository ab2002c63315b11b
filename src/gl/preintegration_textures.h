#pragma once

/// Tables of ray integrals on the device: of `table3d`, `polynomial` and `cylindrical`.

#include "src/gl/context.h"
#include "src/gl/resources.h"
#include "src/scene/preintegration_cache.h"

#include <cstdint>

namespace tetravox::gl {

/// One table at a time. With the context current.
class PreintegrationTextures {
 public:
  /// Puts the cache's table there where it is not yet, and binds it. @throws Error (kUnsupported) where the device
  /// cannot hold it.
  void bind(const scene::PreintegrationCache& cache, const Limits& limits);
  std::uint64_t bytes() const { return bytes_ + block_.bytes(); }

 private:
  void upload(const optics::PreintegrationTable& table, const Limits& limits);
  void upload(const optics::PolynomialTable& table, const Limits& limits);
  void upload(const optics::CylindricalAtlas& atlas, const Limits& limits);

  std::uint64_t number_ = 0;  // of the table that is there
  std::uint64_t bytes_ = 0;
  TextureName table_, ratios_;
  Buffer block_;
};

}  // namespace tetravox::gl
