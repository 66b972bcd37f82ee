// Weights that interpolate inside a spherical triangle. The triangle a, b, c is given by unit vectors that run
// counter-clockwise seen from outside. p is a unit vector inside it or on its sides. The weights belong to a, b, c in
// this order. They are >= 0 up to rounding, sum to 1, and are 1, 0, 0 at a.
#pragma once

#include <array>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

enum class Interpolation { spherical_area, planar };

/// Area of the spherical triangle a, b, c (unit vectors), positive if they run counter-clockwise seen from outside: one
/// arc tangent, accurate for slivers too (Van Oosterom & Strackee 1983, Eq. 8).
double spherical_triangle_area(const Direction& a, const Direction& b, const Direction& c);

/// Areas of the spherical triangles opposite each corner over their sum (theory.md, Eq. 9). Not quite continuous: on a
/// side the two triangles that share it give weights that differ by the order of the side squared.
std::array<double, 3> spherical_area_weights(const Direction& p, const Direction& a, const Direction& b,
                                             const Direction& c);

/// Barycentric coordinates of the intersection of the ray along p with the plane through a, b, c. Continuous across
/// sides; three triple products instead of three arc tangents.
std::array<double, 3> planar_weights(const Direction& p, const Direction& a, const Direction& b, const Direction& c);

}  // namespace cloudbow
