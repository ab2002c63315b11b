#include "src/gl/preintegration_textures.h"

#include "src/gl/blocks.h"

#include <algorithm>

namespace tetravox::gl {
namespace {

constexpr GLuint kTableUnit = 4, kRatioUnit = 5, kBlockBinding = 7;

}  // namespace

void PreintegrationTextures::upload(const optics::PreintegrationTable& table) {
  table_.table = make_table_texture(GL_TEXTURE_3D);
  glTextureStorage3D(table_.table.get(), 1, GL_RGBA32F, table.scalars, table.scalars, table.lengths);
  glTextureSubImage3D(table_.table.get(), 0, 0, 0, 0, table.scalars, table.scalars, table.lengths, GL_RGBA, GL_FLOAT,
                      table.entries.data());
  PreintegrationBlock& block = table_.block = describe_domain(table.domain);
  block.scalars = table.scalars;
  block.lengths = table.lengths;
  block.is_logarithmic = table.spacing == LengthSpacing::kLogarithmic;
  table_.bytes = table.bytes();
}

void PreintegrationTextures::upload(const optics::PolynomialTable& table) {
  table_.table = make_table_texture(GL_TEXTURE_2D_ARRAY);
  glTextureStorage3D(table_.table.get(), 1, GL_RGBA32F, table.scalars, table.scalars, table.degree + 1);
  glTextureSubImage3D(table_.table.get(), 0, 0, 0, 0, table.scalars, table.scalars, table.degree + 1, GL_RGBA, GL_FLOAT,
                      table.maps.data());
  table_.ratios = make_table_texture(GL_TEXTURE_2D);
  const auto count = static_cast<GLsizei>(table.absorbed_ratios.size());
  glTextureStorage2D(table_.ratios.get(), 1, GL_R32F, count, 1);
  glTextureSubImage2D(table_.ratios.get(), 0, 0, 0, count, 1, GL_RED, GL_FLOAT, table.absorbed_ratios.data());
  PreintegrationBlock& block = table_.block = describe_domain(table.domain);
  block.scalars = table.scalars;
  table_.bytes = table.bytes();
}

void PreintegrationTextures::upload(const optics::CylindricalAtlas& atlas) {
  const int width = atlas.columns * atlas.tile, height = atlas.rows * atlas.tile;
  table_.table = make_table_texture(GL_TEXTURE_2D);
  glTextureStorage2D(table_.table.get(), 1, GL_RGBA32F, width, height);
  glTextureSubImage2D(table_.table.get(), 0, 0, 0, width, height, GL_RGBA, GL_FLOAT, atlas.texels.data());
  PreintegrationBlock& block = table_.block = describe_domain(atlas.domain);
  block.planes = atlas.planes;
  block.tile = atlas.tile;
  block.columns = atlas.columns;
  block.rows = atlas.rows;
  table_.bytes = atlas.bytes();
}

void PreintegrationTextures::bind(const scene::PreintegrationCache& cache) {
  if (number_ != cache.number()) {
    if (cache.table()) upload(*cache.table());
    if (cache.polynomial()) upload(*cache.polynomial());
    if (cache.atlas()) upload(*cache.atlas());
    number_ = cache.number();
    made_for_.reset();
  }
  bind();
}

void PreintegrationTextures::make(const optics::PreintegrationSource& source, const RenderSettings& settings) {
  const Made wanted{settings.integrator, settings.preintegration, source.longest};
  if (made_for_ != wanted) {
    table_ = maker_.make(source, settings);
    made_for_ = wanted;
    number_ = 0;
  }
  bind();
}

void PreintegrationTextures::bind() {
  glBindTextureUnit(kTableUnit, table_.table.get());
  if (table_.ratios) glBindTextureUnit(kRatioUnit, table_.ratios.get());
  block_.upload(&table_.block, sizeof(table_.block));
  block_.bind_uniform(kBlockBinding);
}

}  // namespace tetravox::gl
