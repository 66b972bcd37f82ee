#include "cloudbow/transport/camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/scaled_vector.hpp"

namespace cloudbow {
namespace {

// Least sine of the angle between up and line of sight. Below, the frame is undefined to the digits of a scene file.
constexpr double parallel = 1e-6;

std::string text(const Eigen::Vector3d& v) { return fmt::format("[{:g}, {:g}, {:g}]", v.x(), v.y(), v.z()); }

Direction perspective_line(const Camera& camera, double column, double row) {
  const double scale = std::tan(camera.field_of_view / 2) / (0.5 * camera.width);
  const double u = (column - 0.5 * camera.width) * scale;
  const double v = (0.5 * camera.height - row) * scale;
  return (camera.forward + u * camera.right + v * camera.up).normalized();
}

std::optional<Direction> fisheye_line(const Camera& camera, double column, double row) {
  const double radius = 0.5 * std::min(camera.width, camera.height);
  const double u = (column - 0.5 * camera.width) / radius;
  const double v = (0.5 * camera.height - row) / radius;
  const double from_centre = std::hypot(u, v);
  if (from_centre > 1) return std::nullopt;
  if (from_centre == 0) return camera.forward;
  const double angle = from_centre * camera.field_of_view / 2;
  return (std::cos(angle) * camera.forward + std::sin(angle) / from_centre * (u * camera.right + v * camera.up))
      .normalized();
}

Direction panorama_line(const Camera& camera, double column, double row) {
  const double azimuth = (2 * column / camera.width - 1) * std::numbers::pi;  // to the right of forward
  const double elevation = (0.5 - row / camera.height) * camera.field_of_view;
  const Direction level = std::cos(azimuth) * camera.forward + std::sin(azimuth) * camera.right;
  return (std::cos(elevation) * level + std::sin(elevation) * camera.up).normalized();
}

}  // namespace

Camera make_camera(const std::string& name, Camera::Projection projection, const CameraPlacement& placement,
                   double field_of_view, int width, int height, int rays) {
  const Eigen::Vector3d sight = scaled_to_order_one(placement.look_at_m - placement.position_m);
  const Eigen::Vector3d up = scaled_to_order_one(placement.up);
  if (!(sight.norm() > 0)) {
    throw InputError(
        fmt::format("looks at its own position (found {}, allowed any other point)", text(placement.look_at_m)));
  }
  if (!(up.norm() > 0)) {
    throw InputError(fmt::format("up without length (found {}, allowed any other vector)", text(placement.up)));
  }
  Camera camera{name,   projection, placement.position_m, sight.normalized(), {}, up.normalized(), field_of_view, width,
                height, rays};
  const Eigen::Vector3d right = camera.forward.cross(camera.up);
  if (right.norm() < parallel) {
    throw InputError(
        fmt::format("up parallel to the line of sight (found {}, allowed any other direction)", text(placement.up)));
  }
  camera.right = right.normalized();
  if (projection == Camera::Projection::panorama) {
    camera.forward = camera.up.cross(camera.right).normalized();
  } else {
    camera.up = camera.right.cross(camera.forward).normalized();
  }
  return camera;
}

std::optional<Direction> line_of_sight(const Camera& camera, double column, double row) {
  switch (camera.projection) {
    case Camera::Projection::fisheye:
      return fisheye_line(camera, column, row);
    case Camera::Projection::panorama:
      return panorama_line(camera, column, row);
    case Camera::Projection::perspective:
      break;
  }
  return perspective_line(camera, column, row);
}

std::string projection_name(Camera::Projection projection) {
  switch (projection) {
    case Camera::Projection::fisheye:
      return "fisheye";
    case Camera::Projection::panorama:
      return "panorama";
    case Camera::Projection::perspective:
      break;
  }
  return "perspective";
}

}  // namespace cloudbow
