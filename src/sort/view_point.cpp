#include "src/sort/view_point.h"

#include <numbers>

namespace tetravox::sort {
namespace {

Vector3 normalize(const Vector3& a) { return a * (1.0 / std::hypot(a[0], a[1], a[2])); }

Vector3 local_eye(const PreparedMesh& mesh, const Camera& camera) {
  Vector3 eye;
  for (int i = 0; i < 3; ++i) eye[i] = (camera.position[i] - mesh.origin[i]) / mesh.world_per_local;
  return eye;
}

}  // namespace

ViewPoint make_view_point(const PreparedMesh& mesh, const Camera& camera) {
  validate_camera(camera);
  ViewPoint view;
  view.is_orthographic = camera.parallel_scale.has_value();
  if (view.is_orthographic)
    view.forward = normalize(camera.focal_point - camera.position);
  else
    view.eye = local_eye(mesh, camera);
  return view;
}

PixelRays make_pixel_rays(const PreparedMesh& mesh, const Camera& camera, int width, int height) {
  validate_camera(camera);
  PixelRays rays;
  rays.eye = local_eye(mesh, camera);
  rays.forward = normalize(camera.focal_point - camera.position);
  rays.right = normalize(cross(rays.forward, normalize(camera.view_up)));
  rays.up = cross(rays.right, rays.forward);
  rays.is_orthographic = camera.parallel_scale.has_value();
  rays.width = width;
  rays.height = height;
  const double half_height = rays.is_orthographic ? *camera.parallel_scale / mesh.world_per_local
                                                  : std::tan(camera.view_angle * std::numbers::pi / 360.0);
  rays.step = 2.0 * half_height / height;
  return rays;
}

}  // namespace tetravox::sort
