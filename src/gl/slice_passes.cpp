#include "src/gl/slice_passes.h"

#include "src/gl/slice_block.h"
#include "src/support/threads.h"

#include <algorithm>
#include <utility>

namespace tetravox::gl {
namespace {

constexpr GLuint kSliceBinding = 2;  // uniform block
constexpr GLuint kValueUnit = 6, kGradientUnit = 7, kSurfaceUnit = 8, kLowerUnit = 9, kUpperUnit = 10, kTileUnit = 9;

/// Slabs that are drawn before the device is waited for: cancelling takes no longer.
constexpr std::size_t kSlabsAtOnce = 16;

FramebufferName make_framebuffer() {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return FramebufferName(name);
}

/// What is drawn goes behind what is there; alpha is opacity.
void blend_behind() { glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE); }

/// What is drawn goes before what is there.
void blend_before() { glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA); }

void draw_range(const SlabRange& range, std::size_t first, int instances = 1) {
  if (range.count == 0) return;
  glDrawArraysInstanced(GL_TRIANGLES, static_cast<GLint>(first + range.first), static_cast<GLsizei>(range.count),
                        instances);
}

/// Which ways rays go through the planes of half-angle slices: along the light's, against it.
std::pair<bool, bool> ways_of_rays(const scene::CameraFrame& camera, const Point& normal) {
  if (camera.is_orthographic) return {normal[2] > 0.0, normal[2] < 0.0};
  bool along = false, against = false;
  for (const int x : {-1, 1})
    for (const int y : {-1, 1}) {
      const double t =
          0.5 * camera.pixel_step * (x * camera.width * normal[0] + y * camera.height * normal[1]) + normal[2];
      along = along || t > 0.0;
      against = against || t < 0.0;
    }
  return {along, against};
}

}  // namespace

void free_query(GLuint name) { glDeleteQueries(1, &name); }

GLuint SlicePasses::find_program(const std::string& key, const std::vector<ShaderRecipe>& stages) {
  const auto found = programs_.find(key);
  if (found != programs_.end()) return found->second.get();
  return programs_.emplace(key, make_program(stages)).first->second.get();
}

/// Counts what is drawn until glEndQuery.
void SlicePasses::begin_query(std::size_t number) {
  if (number == queries_.size()) {
    GLuint name = 0;
    glCreateQueries(GL_SAMPLES_PASSED, 1, &name);
    queries_.emplace_back(name);
  }
  glBeginQuery(GL_SAMPLES_PASSED, queries_[number].get());
}

std::uint64_t SlicePasses::add_up_queries(std::size_t count) const {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    GLuint64 passed = 0;
    glGetQueryObjectui64v(queries_[i].get(), GL_QUERY_RESULT, &passed);
    sum += passed;
  }
  return sum;
}

SlicePasses::Plan SlicePasses::make_plan(const SliceFrame& frame) const {
  Plan plan;
  plan.request = request_of(frame.grid, frame.grid_frame, frame.view, frame.settings);
  plan.variant = variant_of(frame.grid, frame.settings);
  if (plan.variant.is_half_angle)
    plan.family =
        make_slabs_across(frame.view, plan.request, half_way(way_of_light(frame.view, frame.settings.lighting)));
  else
    plan.family = make_slabs(frame.view, plan.request);
  const double longest = frame.view.world_per_local * longest_slab(frame.view, plan.request, plan.family);
  frame.tables.bind(frame.settings, {.longest = longest, .may_overshoot = filters_slices(frame.settings)},
                    frame.context.limits(), frame.progress);
  if (plan.variant.classification == SliceClassification::kSegment)
    plan.integrator = frame.tables.shader(frame.settings);
  plan.slabs = make_triangles(frame.view, plan.request, plan.family, plan.variant.is_half_angle);
  if (plan.variant.field == SliceField::kPictures)
    plan.slices = make_slice_triangles(frame.view, plan.request, plan.family);
  plan.block = describe(frame.grid, frame.view, frame.settings, plan.request, frame.values.map());
  describe(plan.family, plan.block);
  return plan;
}

void SlicePasses::upload_vertices(const Plan& plan, const SliceTriangles& box) {
  std::vector<SliceVertex> vertices = plan.slabs.vertices;
  for (const SliceTriangles* triangles : {&plan.slices, &box})
    vertices.insert(vertices.end(), triangles->vertices.begin(), triangles->vertices.end());
  vertices.emplace_back();  // never nothing
  vertices_.upload(vertices.data(), vertices.size() * sizeof(SliceVertex));
  if (!attributes_) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    attributes_ = VertexArrayName(name);
    glVertexArrayAttribFormat(name, 0, 2, GL_FLOAT, GL_FALSE, offsetof(SliceVertex, position));
    glVertexArrayAttribIFormat(name, 1, 2, GL_INT, offsetof(SliceVertex, piece));
    for (GLuint attribute = 0; attribute < 2; ++attribute) {
      glEnableVertexArrayAttrib(name, attribute);
      glVertexArrayAttribBinding(name, attribute, 0);
    }
  }
  glVertexArrayVertexBuffer(attributes_.get(), 0, vertices_.get(), 0, sizeof(SliceVertex));
  glBindVertexArray(attributes_.get());
}

/// The textures that the frame's slabs read.
void SlicePasses::bind_values(const SliceFrame& frame, const Plan& plan) {
  if (plan.variant.is_lit && !plan.variant.has_kernel_gradients)
    textures_.gradients(frame.values, frame.context).bind(kGradientUnit);
  if (plan.variant.has_surfaces) {
    const auto colors = make_surface_colors(frame.settings.surfaces);
    const int side = plan.block.surface_count + 1;
    surface_colors_.resize(GL_RGBA32F, side, side);
    glTextureSubImage2D(surface_colors_.get(), 0, 0, 0, side, side, GL_RGBA, GL_FLOAT, colors.data());
    surface_colors_.bind_texture(kSurfaceUnit);
  }
  frame.values.volume().bind(kValueUnit);
  if (plan.variant.field == SliceField::kStack || plan.variant.field == SliceField::kStripes)
    glBindTextureUnit(kValueUnit, textures_.stack(plan.block.stack_axis, frame.values, frame.context));
}

void SlicePasses::prepare(const SliceFrame& frame, Plan& plan) {
  if (!target_) target_ = make_framebuffer();
  glNamedFramebufferTexture(target_.get(), GL_COLOR_ATTACHMENT0, frame.parts.picture().get(), 0);
  constexpr GLfloat kNothing[4] = {};
  glClearNamedFramebufferfv(target_.get(), GL_COLOR, 0, kNothing);
  bind_values(frame, plan);
  if (plan.variant.field == SliceField::kPictures) {
    textures_.set_filter(frame.grid, frame.settings.filter, frame.context);
    plan.block.kernel_radius = textures_.kernel_radius();
    if (textures_.coefficients()) {
      textures_.coefficients()->bind(kValueUnit);
      plan.block.texel_offset = 0.0f;
      plan.block.texel_scale = 1.0f;
    }
    for (std::size_t i = 0; i < 2; ++i) {
      if (!slice_targets_[i]) slice_targets_[i] = make_framebuffer();
      filtered_[i].resize(GL_RGBA32F, frame.settings.width, frame.settings.height);
      glNamedFramebufferTexture(slice_targets_[i].get(), GL_COLOR_ATTACHMENT0, filtered_[i].get(), 0);
      held_[i] = -1;
    }
  }
  if (plan.variant.is_half_angle)
    light_.begin(frame.view, plan.request, plan.family, frame.settings.lighting, plan.block);
  const SliceTriangles box = make_box_triangles(frame.view, plan.request);
  plan.first_slice_vertex = plan.slabs.vertices.size();
  plan.first_box_vertex = plan.first_slice_vertex + plan.slices.vertices.size();
  plan.box_count = box.vertices.size();
  upload_vertices(plan, box);
  block_.upload(&plan.block, sizeof(plan.block));
  block_.bind_uniform(kSliceBinding);
}

std::uint64_t SlicePasses::count_rays(const Plan& plan) {
  glBindFramebuffer(GL_FRAMEBUFFER, target_.get());
  blend_behind();
  glUseProgram(find_program("box", recipe_of_box()));
  begin_query(0);
  draw_range({0, 0, plan.box_count}, plan.first_box_vertex);
  glEndQuery(GL_SAMPLES_PASSED);
  return add_up_queries(1);
}

/// Adds up a slice's filtered values, a tile of the kernel an instance.
void SlicePasses::filter_slice(const SliceFrame& frame, const Plan& plan, int slice) {
  const auto into = static_cast<std::size_t>(slice % 2);
  if (held_[into] == slice) return;
  held_[into] = slice;
  constexpr GLfloat kNothing[4] = {};
  glClearNamedFramebufferfv(slice_targets_[into].get(), GL_COLOR, 0, kNothing);
  glBindFramebuffer(GL_FRAMEBUFFER, slice_targets_[into].get());
  glBlendFunc(GL_ONE, GL_ONE);
  textures_.kernel_tiles().bind(kTileUnit);
  glUseProgram(find_program("filter", recipe_of_filter()));
  const int width = 2 * plan.block.kernel_radius;
  draw_range(plan.slices.slabs[static_cast<std::size_t>(slice)], plan.first_slice_vertex, width * width * width);
  support::throw_if_cancelled(frame.progress);
}

/// The two slices of a slab.
void SlicePasses::find_filtered(const SliceFrame& frame, const Plan& plan, int slab) {
  filter_slice(frame, plan, slab);
  filter_slice(frame, plan, slab + 1);
  filtered_[static_cast<std::size_t>(slab % 2)].bind_texture(kLowerUnit);
  filtered_[static_cast<std::size_t>((slab + 1) % 2)].bind_texture(kUpperUnit);
}

void SlicePasses::draw_slabs(const SliceFrame& frame, const Plan& plan) {
  const GLuint program =
      find_program(key_of(plan.integrator, plan.variant), recipe_of_slab(plan.integrator, plan.variant));
  for (std::size_t i = 0; i < plan.slabs.slabs.size(); ++i) {
    const SlabRange& slab = plan.slabs.slabs[i];
    if (plan.variant.field == SliceField::kPictures) find_filtered(frame, plan, slab.slab);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.get());
    blend_behind();
    glUseProgram(program);
    begin_query(i);
    draw_range(slab, 0);
    glEndQuery(GL_SAMPLES_PASSED);
    if (i % kSlabsAtOnce != kSlabsAtOnce - 1) continue;
    glFinish();
    support::throw_if_cancelled(frame.progress);
  }
}

void SlicePasses::draw_half_angle(const SliceFrame& frame, const Plan& plan) {
  const std::string key = key_of(plan.integrator, plan.variant);
  const GLuint program = find_program(key, recipe_of_slab(plan.integrator, plan.variant));
  const GLuint light_program = find_program("light " + key, recipe_of_light(plan.integrator, plan.variant));
  const auto [along, against] = ways_of_rays(frame.view.camera, plan.family.plane.normal);
  for (std::size_t i = 0; i < plan.slabs.slabs.size(); ++i) {
    const SlabRange& slab = plan.slabs.slabs[i];
    light_.pass(light_program, slab.slab);
    glBindFramebuffer(GL_FRAMEBUFFER, target_.get());
    glViewport(0, 0, frame.settings.width, frame.settings.height);
    glUseProgram(program);
    begin_query(i);
    if (along) {
      blend_behind();
      glUniform1f(0, 1.0f);
      draw_range(slab, 0);
    }
    if (against) {
      blend_before();
      glUniform1f(0, -1.0f);
      draw_range(slab, 0);
    }
    glEndQuery(GL_SAMPLES_PASSED);
    light_.advance();
    if (i % kSlabsAtOnce != kSlabsAtOnce - 1) continue;
    glFinish();
    support::throw_if_cancelled(frame.progress);
  }
}

void SlicePasses::draw(const SliceFrame& frame, RenderStatistics& statistics) {
  require_sliceable(frame.grid, frame.settings);
  Plan plan = make_plan(frame);
  prepare(frame, plan);
  const Enabled blending(GL_BLEND);
  statistics.rays = count_rays(plan);
  if (plan.variant.is_half_angle)
    draw_half_angle(frame, plan);
  else
    draw_slabs(frame, plan);
  statistics.segments = add_up_queries(plan.slabs.slabs.size());
  statistics.slices = plan.family.count;
}

std::uint64_t SlicePasses::bytes() const {
  const std::size_t filtered = filtered_[0].get() ? filtered_[0].bytes() + filtered_[1].bytes() : 0;
  const std::size_t surfaces = surface_colors_.get() ? surface_colors_.bytes() : 0;
  return block_.bytes() + vertices_.bytes() + textures_.bytes() + light_.bytes() + filtered + surfaces;
}

}  // namespace tetravox::gl
