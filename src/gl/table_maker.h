#pragma once

/// Tables of ray integrals made on the device, as the papers do: all entries of a slice at once, steps of integration
/// blended into what the steps before have left, from one picture into another and back.
///
/// Roettger and Ertl 2002 (table3d, cylindrical); Guthe, Roettger, Schieber, Strasser, Ertl 2002 (polynomial). How we
/// differ: numbers are floats (or rounded after each step to what 8, 12 or 16 bits hold), and what is kept is divided
/// by the opacity bound, as src/optics does it. The function is looked up at 4096 nodes.

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"
#include "src/optics/segment_domain.h"
#include "tetravox/progress.h"
#include "tetravox/render.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetravox::gl {

/// A table on the device, with what look-ups need beside it.
struct DeviceTable {
  TextureName table;   ///< 3D, array of maps or atlas: see the headers of src/optics
  TextureName ratios;  ///< of `polynomial`: opacities by optical depth
  PreintegrationBlock block{};
  std::uint64_t bytes = 0;
};

/// @throws Error (kUnsupported) where the table of `settings.integrator` has more entries a side than the device
/// allows.
void require_table_size(const RenderSettings& settings, const Limits& limits);

/// What look-ups need of a domain.
PreintegrationBlock describe_domain(const optics::SegmentDomain& domain);

/// An empty texture for a table, interpolated. With the context current.
TextureName make_table_texture(GLenum target);

/// The programs of making.
std::vector<std::pair<std::string, std::vector<ShaderRecipe>>> recipes_of_tables();

/// Keeps programs and pictures between tables. With the context current.
class TableMaker {
 public:
  /// The table of `settings.integrator`: table3d, polynomial or cylindrical; see `require_table_size`.
  /// @throws Error (kCancelled).
  DeviceTable make(const optics::PreintegrationSource& source, const RenderSettings& settings);
  std::uint64_t bytes() const { return sums_[0].bytes() + sums_[1].bytes() + densities_.bytes() + colors_.bytes(); }

 private:
  void begin(const optics::PreintegrationSource& source, const PreintegrationSettings& settings, int width, int height);
  const Picture& integrate(float share, int mode, Picture* result = nullptr);
  void fill(const std::string& program);
  void attach(GLuint texture, int layer, GLenum attachment);
  void make_slices(const optics::PreintegrationSource& source, const PreintegrationSettings& settings,
                   DeviceTable& table);
  void make_maps(const optics::PreintegrationSource& source, const PreintegrationSettings& settings,
                 DeviceTable& table);
  void store_maps(const PreintegrationSettings& settings, const DeviceTable& table) const;
  void make_atlas(DeviceTable& table);

  std::map<std::string, ProgramName> programs_;
  VertexArrayName no_attributes_;
  FramebufferName target_;
  Buffer block_;
  BufferTexture nodes_, weights_;
  MakerBlock maker_{};
  int width_ = 0, height_ = 0;
  Picture sums_[2], densities_, colors_;
  std::string variant_;  // of the programs: "" or "atlas"
};

}  // namespace tetravox::gl
