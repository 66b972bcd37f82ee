// Directions in space.
#pragma once

#include <Eigen/Geometry>

namespace cloudbow {

/// Unit vector. In transport it is the direction of travel of light, z up.
using Direction = Eigen::Vector3d;

}  // namespace cloudbow
