#include "src/gl/preintegration_textures.h"

#include "src/gl/blocks.h"
#include "tetravox/error.h"

#include <algorithm>
#include <string>

namespace tetravox::gl {
namespace {

constexpr GLuint kTableUnit = 4, kRatioUnit = 5, kBlockBinding = 3;

TextureName make_texture(GLenum target) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(name, side, GL_CLAMP_TO_EDGE);
  return TextureName(name);
}

void require_size(int side, int limit) {
  if (side > limit)
    throw Error(ErrorCode::kUnsupported, "OpenGL: this device holds tables of at most " + std::to_string(limit) +
                                             " entries a side, and this one has " + std::to_string(side) +
                                             ": ask for fewer (--preintegration-size, --preintegration-planes)");
}

PreintegrationBlock describe(const optics::SegmentDomain& domain) {
  PreintegrationBlock block{};
  block.first_scalar = domain.first;
  block.places_per_scalar = domain.per_scalar;
  block.longest = domain.longest;
  block.largest_extinction = domain.largest_extinction;
  return block;
}

}  // namespace

void PreintegrationTextures::upload(const optics::PreintegrationTable& table, const Limits& limits) {
  require_size(std::max(table.scalars, table.lengths), limits.volume_size);
  table_ = make_texture(GL_TEXTURE_3D);
  glTextureStorage3D(table_.get(), 1, GL_RGBA32F, table.scalars, table.scalars, table.lengths);
  glTextureSubImage3D(table_.get(), 0, 0, 0, 0, table.scalars, table.scalars, table.lengths, GL_RGBA, GL_FLOAT,
                      table.entries.data());
  PreintegrationBlock block = describe(table.domain);
  block.scalars = table.scalars;
  block.lengths = table.lengths;
  block.is_logarithmic = table.spacing == LengthSpacing::kLogarithmic;
  block_.upload(&block, sizeof(block));
  bytes_ = table.bytes();
}

void PreintegrationTextures::upload(const optics::PolynomialTable& table, const Limits& limits) {
  require_size(table.scalars, limits.texture_size);
  table_ = make_texture(GL_TEXTURE_2D_ARRAY);
  glTextureStorage3D(table_.get(), 1, GL_RGBA32F, table.scalars, table.scalars, table.degree + 1);
  glTextureSubImage3D(table_.get(), 0, 0, 0, 0, table.scalars, table.scalars, table.degree + 1, GL_RGBA, GL_FLOAT,
                      table.maps.data());
  ratios_ = make_texture(GL_TEXTURE_2D);
  const auto count = static_cast<GLsizei>(table.absorbed_ratios.size());
  glTextureStorage2D(ratios_.get(), 1, GL_R32F, count, 1);
  glTextureSubImage2D(ratios_.get(), 0, 0, 0, count, 1, GL_RED, GL_FLOAT, table.absorbed_ratios.data());
  PreintegrationBlock block = describe(table.domain);
  block.scalars = table.scalars;
  block_.upload(&block, sizeof(block));
  bytes_ = table.bytes();
}

void PreintegrationTextures::upload(const optics::CylindricalAtlas& atlas, const Limits& limits) {
  const int width = atlas.columns * atlas.tile, height = atlas.rows * atlas.tile;
  require_size(std::max(width, height), limits.texture_size);
  table_ = make_texture(GL_TEXTURE_2D);
  glTextureStorage2D(table_.get(), 1, GL_RGBA32F, width, height);
  glTextureSubImage2D(table_.get(), 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, atlas.texels.data());
  PreintegrationBlock block = describe(atlas.domain);
  block.planes = atlas.planes;
  block.tile = atlas.tile;
  block.columns = atlas.columns;
  block.rows = atlas.rows;
  block_.upload(&block, sizeof(block));
  bytes_ = atlas.bytes();
}

void PreintegrationTextures::bind(const scene::PreintegrationCache& cache, const Limits& limits) {
  if (number_ != cache.number()) {
    if (cache.table()) upload(*cache.table(), limits);
    if (cache.polynomial()) upload(*cache.polynomial(), limits);
    if (cache.atlas()) upload(*cache.atlas(), limits);
    number_ = cache.number();
  }
  glBindTextureUnit(kTableUnit, table_.get());
  if (cache.polynomial()) glBindTextureUnit(kRatioUnit, ratios_.get());
  block_.bind_uniform(kBlockBinding);
}

}  // namespace tetravox::gl
