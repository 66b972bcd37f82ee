// Triangle meshes of the unit sphere: a regular polyhedron with triangular faces. Each face is split in four
// repeatedly, and the new vertices are projected to the sphere.
#pragma once

#include <array>
#include <vector>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// The polyhedron that is subdivided. Triangles of the icosahedron stay the most even in size, 1.3 to 1 at most. Those
/// of the others reach ratios of up to 2.1 to 1 (octahedron) and 6.5 to 1 (tetrahedron).
enum class Polyhedron { icosahedron, octahedron, tetrahedron };

struct SphereMesh {
  std::vector<Direction> vertex;             ///< unit vectors; those of a coarser mesh come first
  std::vector<std::array<int, 3>> triangle;  ///< vertex indices, counter-clockwise seen from outside
};

/// @param subdivisions >= 0, n: 10 * 4^n + 2 (icosahedron), 4 * 4^n + 2 (octahedron) or 2 * 4^n + 2 (tetrahedron)
/// vertices. Orientations: icosahedron with vertices (0, +-1, +-golden ratio) and cyclic; octahedron with vertices on
/// the axes; tetrahedron with vertices (1, 1, 1) and those with two signs changed. The first two have the coordinate
/// planes as mirrors, exactly in floating point too.
SphereMesh make_sphere_mesh(Polyhedron polyhedron, int subdivisions);

}  // namespace cloudbow
