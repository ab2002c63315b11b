#include "src/scene/preintegration_cache.h"

#include "tetravox/error.h"

namespace tetravox::scene {
namespace {

/// What the integrator asks for, everything else as by default.
PreintegrationSettings relevant(const PreintegrationSettings& settings, Integrator integrator) {
  PreintegrationSettings asked;
  asked.steps = settings.steps;
  asked.bits = settings.bits;
  if (integrator == Integrator::kCylindrical) {
    asked.planes = settings.planes;
    asked.tile = settings.tile;
    return asked;
  }
  asked.use_incremental = settings.use_incremental;
  asked.scalars = settings.scalars;
  if (integrator == Integrator::kTable3d) {
    asked.lengths = settings.lengths;
    asked.length_spacing = settings.length_spacing;
  } else {
    asked.degree = settings.degree;
    asked.opacity = settings.opacity;
  }
  return asked;
}

}  // namespace

bool is_of_tables(Integrator integrator) {
  return integrator == Integrator::kTable3d || integrator == Integrator::kPolynomial ||
         integrator == Integrator::kCylindrical;
}

std::uint64_t preintegration_bytes(const RenderSettings& settings) {
  const PreintegrationSettings& table = settings.preintegration;
  if (settings.integrator == Integrator::kTable3d)
    return optics::preintegration_table_bytes(table.scalars, table.lengths);
  if (settings.integrator == Integrator::kPolynomial)
    return optics::polynomial_table_bytes(table.scalars, table.degree);
  if (settings.integrator == Integrator::kCylindrical) return optics::cylindrical_atlas_bytes(table.planes, table.tile);
  return 0;
}

void PreintegrationCache::prepare(const optics::PreintegrationSource& source, const RenderSettings& settings) {
  const PreintegrationSettings asked = relevant(settings.preintegration, settings.integrator);
  if (settings.preintegration.device == TableDevice::kGpu)
    throw Error(ErrorCode::kUnsupported,
                "tables are made on the GPU by the OpenGL backend only: draw with --backend gl, or with "
                "--preintegration-device cpu");
  if (integrator_ == settings.integrator && settings_ == asked && longest_ == source.longest) return;
  invalidate();
  if (settings.integrator != Integrator::kTable3d) table_ = {};
  if (settings.integrator != Integrator::kPolynomial) polynomial_ = {};
  if (settings.integrator != Integrator::kCylindrical) atlas_ = {};
  if (settings.integrator == Integrator::kTable3d) optics::build_preintegration_table(source, asked, table_);
  if (settings.integrator == Integrator::kPolynomial) optics::build_polynomial_table(source, asked, polynomial_);
  if (settings.integrator == Integrator::kCylindrical) optics::build_cylindrical_atlas(source, asked, atlas_);
  settings_ = asked;
  longest_ = source.longest;
  integrator_ = settings.integrator;
  ++number_;
}

}  // namespace tetravox::scene
