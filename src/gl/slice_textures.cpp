#include "src/gl/slice_textures.h"

#include "src/gl/program.h"
#include "src/gl/slice_programs.h"
#include "src/grid/values.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

namespace tetravox::gl {
namespace {

constexpr GLuint kValueUnit = 6, kTargetUnit = 1;

/// Places in a cell that kernels are tabulated at; linear in between.
constexpr int kPhases = 512;

/// Places around the coefficients of a spline, as on the CPU.
constexpr std::int64_t kMargin = 2;

GLenum format_of(const GridTexture& values) {
  GLint format = 0;
  glGetTextureLevelParameteriv(values.volume().get(), 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
  return static_cast<GLenum>(format);
}

void dispatch_over(const std::array<int, 3>& size) {
  glDispatchCompute(static_cast<GLuint>(size[0] + 7) / 8, static_cast<GLuint>(size[1] + 7) / 8,
                    static_cast<GLuint>(size[2]));
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

/// Coefficients of the spline through the values, with a margin of mirrored places: [k][j][i].
std::vector<float> make_coefficients(const PreparedGrid& grid, const std::array<int, 3>& size) {
  grid::Block whole;
  for (int axis = 0; axis < 3; ++axis) whole.count[axis] = size[axis] - 2 * kMargin;
  std::vector<float> inside(static_cast<std::size_t>(whole.size()));
  grid::BlockReader(grid.data, {grid.scalar_offset, grid.scalar_scale}).read(whole, inside.data());
  grid::prefilter_bspline(grid.data.value_dimensions(), inside);
  const auto mirrored = [&](std::int64_t i, int axis) {
    const std::int64_t last = whole.count[axis] - 1;
    i = std::abs(i - kMargin);
    return std::clamp(i > last ? 2 * last - i : i, std::int64_t{0}, last);
  };
  std::vector<float> coefficients;
  coefficients.reserve(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                       static_cast<std::size_t>(size[2]));
  for (std::int64_t k = 0; k < size[2]; ++k)
    for (std::int64_t j = 0; j < size[1]; ++j)
      for (std::int64_t i = 0; i < size[0]; ++i)
        coefficients.push_back(inside[static_cast<std::size_t>(
            (mirrored(k, 2) * whole.count[1] + mirrored(j, 1)) * whole.count[0] + mirrored(i, 0))]);
  return coefficients;
}

void upload_coefficients(const PreparedGrid& grid, const Context& context, Volume& volume) {
  const auto values = grid.data.value_dimensions();
  std::array<int, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    size[axis] = static_cast<int>(values[axis]) + 2 * static_cast<int>(kMargin);
  volume.make(GL_R32F, size, context);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTextureSubImage3D(volume.get(), 0, 0, 0, 0, size[0], size[1], size[2], GL_RED, GL_FLOAT,
                      make_coefficients(grid, size).data());
}

}  // namespace

GLuint SliceTextures::stack(int axis, const GridTexture& values, const Context& context) {
  TextureName& stack = stacks_[static_cast<std::size_t>(axis)];
  if (stack) return stack.get();
  const std::array<int, 3>& size = values.volume().size();
  const std::array<std::array<int, 3>, 3> order{{{1, 2, 0}, {0, 2, 1}, {0, 1, 2}}};
  const auto& [u, v, w] = order[static_cast<std::size_t>(axis)];
  const std::array<int, 3> stacked{size[static_cast<std::size_t>(u)], size[static_cast<std::size_t>(v)],
                                   size[static_cast<std::size_t>(w)]};
  GLint most_layers = 0;
  glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &most_layers);
  if (stacked[2] > most_layers || stacked[0] > context.limits().texture_size ||
      stacked[1] > context.limits().texture_size)
    throw Error(ErrorCode::kUnsupported, "OpenGL: a stack of " + std::to_string(stacked[2]) + " textures of " +
                                             std::to_string(stacked[0]) + " x " + std::to_string(stacked[1]) +
                                             " is more than this device holds: use --source slices=view-3d");
  context.require_no_error("before the stack of slices");
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
  TextureName made(name);
  glTextureStorage3D(name, 1, format_of(values), stacked[0], stacked[1], stacked[2]);
  if (glGetError() != GL_NO_ERROR) {
    context.forget_complaint();
    throw Error(ErrorCode::kOutOfMemory, "OpenGL: the device (" + context.device().name +
                                             ") has no room for a stack of slices beside the grid: use --source "
                                             "slices=view-3d, or draw with --backend cpu");
  }
  for (const GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTextureParameteri(name, side, GL_CLAMP_TO_EDGE);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  if (!stack_program_) stack_program_ = make_program(std::vector{recipe_of_stack()});
  values.volume().bind(kValueUnit);
  glBindImageTexture(kTargetUnit, name, 0, GL_TRUE, 0, GL_WRITE_ONLY, format_of(values));
  glUseProgram(stack_program_.get());
  glUniform1i(0, axis);
  dispatch_over(stacked);
  stack_bytes_ += values.bytes();
  stack = std::move(made);
  return stack.get();
}

const Volume& SliceTextures::gradients(const GridTexture& values, const Context& context) {
  if (gradients_) return *gradients_;
  Volume made;
  made.make(GL_RGBA32F, values.volume().size(), context);
  if (!gradient_program_) gradient_program_ = make_program(std::vector{recipe_of_gradients()});
  values.volume().bind(kValueUnit);
  glBindImageTexture(kTargetUnit, made.get(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA32F);
  glUseProgram(gradient_program_.get());
  glUniform1f(0, values.map().scale);
  dispatch_over(made.size());
  glTextureParameteri(made.get(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(made.get(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gradients_ = std::move(made);
  return *gradients_;
}

void SliceTextures::set_filter(const PreparedGrid& grid, const Filter& filter, const Context& context) {
  if (kernel_ && filter == filter_) return;
  auto kernel = grid::make_kernel(filter);
  std::optional<Volume> coefficients;
  if (kernel->wants_prefilter()) upload_coefficients(grid, context, coefficients.emplace());
  const int radius = kernel->radius();
  std::vector<std::array<float, 2>> tiles;
  for (int phase = 0; phase <= kPhases; ++phase) {
    const double share = phase / double{kPhases};
    const std::vector<double> weights = grid::weights_at(*kernel, share);
    for (int tile = 0; tile < 2 * radius; ++tile)
      tiles.push_back({static_cast<float>(weights[static_cast<std::size_t>(tile)]),
                       static_cast<float>(kernel->eval_derivative(share - (tile - radius + 1)))});
  }
  kernel_tiles_.upload(GL_RG32F, tiles.data(), tiles.size() * sizeof(tiles[0]));
  coefficients_ = std::move(coefficients);
  kernel_ = std::move(kernel);
  filter_ = filter;
}

std::uint64_t SliceTextures::bytes() const {
  return stack_bytes_ + (gradients_ ? gradients_->bytes() : 0) + (coefficients_ ? coefficients_->bytes() : 0) +
         kernel_tiles_.bytes();
}

}  // namespace tetravox::gl
