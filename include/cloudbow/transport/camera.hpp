// Cameras: the line of sight of each point of an image, from a position in or above the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// Image points are in pixel units, (0, 0) at the top left corner and (width, height) at the bottom right; pixels are
/// square but for panoramas. `right`, `up` and `-forward` are a right-handed orthonormal frame.
struct Camera {
  enum class Projection {
    perspective,  ///< straight lines stay straight; field_of_view is horizontal
    fisheye,      ///< equidistant: distance from the image's centre is proportional to the angle from `forward`;
                  ///< field_of_view is the full cone, whose circle just fits into the image
    panorama      ///< equirectangular: all azimuths about `up`, `forward` in the middle; field_of_view is vertical
  };

  std::string name;
  Projection projection = Projection::perspective;
  Eigen::Vector3d position_m{0, 0, 0};  ///< in the coordinates of the domain
  Direction forward{0, 1, 0};
  Direction right{1, 0, 0};
  Direction up{0, 0, 1};
  double field_of_view = 0;  ///< radians: perspective below pi, fisheye up to 2 pi, panorama up to pi
  int width = 1;
  int height = 1;
  int rays = 2;  ///< lines of sight along each axis of a pixel, over which it is the mean
};

struct CameraImage {
  Camera camera;
  std::vector<float> radiance;  ///< [height][width], row 0 on top, W m-2 sr-1, diffuse; NaN without a line of sight
};

/// Position of a camera and the point at which it looks.
struct CameraPlacement {
  Eigen::Vector3d position_m;
  Eigen::Vector3d look_at_m;
  Eigen::Vector3d up{0, 0, 1};  ///< of any length
};

/// Fills in the frame. A panorama keeps `up` as its axis and looks at the horizon below or above `look_at_m`; the
/// others keep the direction to `look_at_m`, and `up` becomes the nearest possible one.
/// @throws InputError "PROBLEM (found X, allowed Y)" if look_at_m is the position; also if up has no length or is
/// parallel to the line of sight.
Camera make_camera(const std::string& name, Camera::Projection projection, const CameraPlacement& placement,
                   double field_of_view, int width, int height, int rays = 2);

/// Unit vector from the camera through a point of its image; light that is seen travels the other way. Nothing outside
/// a fisheye's circle.
std::optional<Direction> line_of_sight(const Camera& camera, double column, double row);

/// Calls `use(line)` for the lines of sight through a pixel: through the middles of its `rays` x `rays` parts.
template <class Use>
void for_lines_of_sight(const Camera& camera, int row, int column, const Use& use) {
  for (int v = 0; v < camera.rays; ++v) {
    for (int u = 0; u < camera.rays; ++u) {
      if (const auto sight = line_of_sight(camera, column + (u + .5) / camera.rays, row + (v + .5) / camera.rays))
        use(*sight);
    }
  }
}

/// "perspective", "fisheye" or "panorama".
std::string projection_name(Camera::Projection projection);

}  // namespace cloudbow
