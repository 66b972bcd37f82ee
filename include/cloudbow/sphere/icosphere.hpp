// The icosphere: an icosahedron whose triangles are split in four, again and again, with the new vertices pushed out to
// the unit sphere.
#pragma once

#include <array>
#include <vector>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

struct Icosphere {
  std::vector<Direction> vertex;  ///< 10 * 4^subdivisions + 2 unit vectors; those of a coarser sphere come first
  std::vector<std::array<int, 3>> triangle;  ///< vertex indices, counter-clockwise seen from outside
};

/// The textbook orientation: vertices (0, +-1, +-golden ratio) and cyclic, so that the three coordinate planes are
/// mirrors, exactly in floating point too.
Icosphere make_icosphere(int subdivisions);

/// The 120 rotations and reflections that map the textbook icosphere onto itself; the identity comes first.
std::vector<Eigen::Matrix3d> icosahedral_group();

}  // namespace cloudbow
