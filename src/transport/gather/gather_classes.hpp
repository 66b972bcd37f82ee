// The directions of a final gather in classes of similar spread, and the starting points of their rays.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "transport/gather/gather.hpp"
#include "transport/grid/octants.hpp"

namespace cloudbow {

/// Weight of a direction's radiance in a flux: solid angle [sr] times |cosine|.
inline double power(const GatherDirection& direction) { return direction.weight * std::abs(direction.travel.z()); }

/// Directions with the same blur: [first, last) of those in order of their beams' spread.
struct SpreadClass {
  std::size_t first;
  std::size_t last;
  double spread;  ///< distance over which a beam spreads, per unit height (docs/theory.md (26)), flux-weighted
};

/// Sorts the directions.
std::vector<SpreadClass> spread_classes(std::vector<GatherDirection>& directions);

/// Directions [first, last) by quadrant of their horizontal travel, each in their order. Sums over the directions are
/// added quadrant by quadrant, so that ranks which share these have the same bits.
inline constexpr int quadrants = octants / 2;
std::array<std::vector<std::size_t>, quadrants> by_quadrant(std::span<const GatherDirection> directions,
                                                            std::size_t first, std::size_t last);

/// Starting point of the rays of a direction in their columns, as fractions.
struct LaunchPlace {
  double x;
  double y;
};

/// The centre, from which each direction is accurate to second order. With `filling`, a different point per direction,
/// for light that changes within columns (additive recurrence of the plastic number, Roberts 2018).
LaunchPlace launch_place(std::size_t direction, bool filling);

}  // namespace cloudbow
