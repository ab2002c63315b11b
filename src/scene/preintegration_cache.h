#pragma once

/// The table of ray integrals that a renderer draws with, from frame to frame as long as nothing changes.

#include "src/optics/cylindrical_atlas.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"
#include "tetravox/render.h"

#include <cstdint>

namespace tetravox::scene {

/// Whether the integrator looks whole ray integrals up.
bool is_of_tables(Integrator integrator);

/// Bytes of the table that a frame needs; 0 for other integrators.
std::uint64_t preintegration_bytes(const RenderSettings& settings);

/// One table at a time.
class PreintegrationCache {
 public:
  /// The function has changed. Its memory is kept for the next table.
  void invalidate() { integrator_ = Integrator::kAntiderivative; }

  /// Makes the table where it is not at hand.
  /// @throws Error: kOutOfMemory.
  void prepare(const optics::PreintegrationSource& source, const RenderSettings& settings);

  // The table at hand, null where it is another.
  const optics::PreintegrationTable* table() const { return of(Integrator::kTable3d, table_); }
  const optics::PolynomialTable* polynomial() const { return of(Integrator::kPolynomial, polynomial_); }
  const optics::CylindricalAtlas* atlas() const { return of(Integrator::kCylindrical, atlas_); }
  /// Changes with the table at hand.
  std::uint64_t number() const { return number_; }

  std::uint64_t bytes() const { return table_.bytes() + polynomial_.bytes() + atlas_.bytes(); }

 private:
  template <class Table>
  const Table* of(Integrator integrator, const Table& table) const {
    return integrator_ == integrator ? &table : nullptr;
  }

  std::uint64_t number_ = 0;
  Integrator integrator_ = Integrator::kAntiderivative;  // that the table at hand is for; this one: none
  PreintegrationSettings settings_;
  double longest_ = 0.0;
  optics::PreintegrationTable table_;
  optics::PolynomialTable polynomial_;
  optics::CylindricalAtlas atlas_;
};

}  // namespace tetravox::scene
