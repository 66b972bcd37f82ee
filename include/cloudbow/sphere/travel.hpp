// Directions of travel by angles of the sky.
#pragma once

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// Direction in which light travels from a place in the sky, 0 degrees of zenith angle overhead. The azimuth counts
/// counter-clockwise from +x, seen from above (docs/conventions.md).
Direction travel_from(double zenith_deg, double azimuth_deg);

}  // namespace cloudbow
