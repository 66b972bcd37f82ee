// The icosphere, a subdivided icosahedron, and its symmetry.
#pragma once

#include <vector>

#include "cloudbow/sphere/sphere_mesh.hpp"

namespace cloudbow {

using Icosphere = SphereMesh;

/// 10 * 4^subdivisions + 2 vertices, in the textbook orientation (make_sphere_mesh).
Icosphere make_icosphere(int subdivisions);

/// The 120 rotations and reflections that map the textbook icosphere onto itself; the identity comes first.
std::vector<Eigen::Matrix3d> icosahedral_group();

}  // namespace cloudbow
