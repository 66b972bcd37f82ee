// Octants of directions.
#pragma once

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

inline constexpr int octants = 8;

/// Index of the octant that a direction of travel lies in. The first four travel down.
inline int octant_of(const Direction& travel) {
  return (travel.x() > 0 ? 1 : 0) + (travel.y() > 0 ? 2 : 0) + (travel.z() > 0 ? 4 : 0);
}

}  // namespace cloudbow
