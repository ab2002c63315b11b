#include "src/gl/slice_light.h"

#include "src/gl/slice_block.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tetravox::gl {
namespace {

constexpr GLuint kBeforeUnit = 9, kBehindUnit = 10;

/// The cone of scattered light is as wide as its angle says after this part of the diagonal; from there it widens like
/// what is scattered again and again, so that it does not depend on the number of slices.
constexpr double kScatterOfDiagonal = 0.01;

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Any unit vector across another.
Point across(const Point& v) {
  const Point axis = std::abs(v[0]) < 0.6 ? Point{1, 0, 0} : Point{0, 1, 0};
  Point u = cross(v, axis);
  const double length = std::sqrt(dot(u, u));
  for (double& component : u) component /= length;
  return u;
}

}  // namespace

void SliceLight::begin(const scene::GridView& view, const SlicingRequest& request, const SlabFamily& family,
                       const Lighting& lighting, SliceBlock& block) {
  const Point way = way_of_light(view, lighting), u = across(way), v = cross(way, u);
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
  for (const ConvexBody::Face& face : make_box(view, request.lower, request.upper).faces)
    for (const Point& p : face.corners)
      for (int i = 0; i < 2; ++i) {
        low[i] = std::min(low[i], dot(p, i ? v : u));
        high[i] = std::max(high[i], dot(p, i ? v : u));
      }
  const double side = std::max(high[0] - low[0], high[1] - low[1]);
  const auto row = [&](const Point& axis, double middle) {
    return vec4{static_cast<float>(axis[0] / side), static_cast<float>(axis[1] / side),
                static_cast<float>(axis[2] / side), static_cast<float>(0.5 - middle / side)};
  };
  block.light_x = row(u, 0.5 * (low[0] + high[0]));
  block.light_y = row(v, 0.5 * (low[1] + high[1]));
  block.light_z = {static_cast<float>(way[0]), static_cast<float>(way[1]), static_cast<float>(way[2]), 0.0f};
  block.translucency = static_cast<float>(lighting.translucency);
  const double distance = family.step / std::abs(dot(way, family.plane.normal));
  const double spread = std::tan(lighting.translucency_angle * std::numbers::pi / 180.0);
  block.blur_radius = static_cast<float>(spread * std::sqrt(distance * kScatterOfDiagonal * request.diagonal) / side);

  resolution_ = lighting.shadow_resolution;
  constexpr GLfloat kAll[4] = {1.0f, 1.0f, 1.0f, 1.0f};
  for (std::size_t i = 0; i < 2; ++i) {
    pictures_[i].resize(GL_RGBA32F, resolution_, resolution_);
    const GLuint name = pictures_[i].get();
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTextureParameteri(name, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTextureParameteri(name, wrap, GL_CLAMP_TO_EDGE);
    if (!targets_[i]) {
      GLuint target = 0;
      glCreateFramebuffers(1, &target);
      targets_[i] = FramebufferName(target);
    }
    glNamedFramebufferTexture(targets_[i].get(), GL_COLOR_ATTACHMENT0, name, 0);
    glClearNamedFramebufferfv(targets_[i].get(), GL_COLOR, 0, kAll);
  }
  before_ = 0;
}

void SliceLight::pass(GLuint program, int slab) {
  const auto before = static_cast<std::size_t>(before_);
  pictures_[before].bind_texture(kBeforeUnit);
  glBindTextureUnit(kBehindUnit, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, targets_[1 - before].get());
  glViewport(0, 0, resolution_, resolution_);
  glBlendFunc(GL_ONE, GL_ZERO);
  glUseProgram(program);
  glUniform1i(0, slab);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  pictures_[1 - before].bind_texture(kBehindUnit);
}

}  // namespace tetravox::gl
