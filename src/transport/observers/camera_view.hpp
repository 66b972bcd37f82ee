// Images of cameras: lines of sight from one place, each through the cells and their source towards it (docs/theory.md,
// "Radiance").
#pragma once

#include <span>
#include <vector>

#include "cloudbow/transport/solution.hpp"
#include "transport/gather/gather.hpp"
#include "transport/observers/viewing_source.hpp"

namespace cloudbow {

/// Control points about the directions in which the light travels that cameras see.
struct SightPoints {
  ControlPoints points;
  std::vector<int> row;           ///< [points] index into travel; -1: not needed
  std::vector<Direction> travel;  ///< of those that are
};

/// The finest set (2562, 642 or 162 points) whose needed points, times the cells, keep to the memory that a solve takes
/// anyway.
SightPoints sight_points(std::span<const Camera> cameras, std::size_t cells);

/// Images of options.cameras, in their order.
/// @param source at sight.travel: orders of scattering >= 2, in its rows from `first_row` on.
/// @param ground for cameras. @param side radiance at open sides; may be empty.
template <class Real>
std::vector<CameraImage> camera_images(const ConvergedField<Real>& field, const SightPoints& sight,
                                       const AngularField<Real>& source, int first_row,
                                       std::span<const ViewingBeam<Real>> beams, const GroundRadiance<Real>& ground,
                                       const SideRadiance& side);

}  // namespace cloudbow
