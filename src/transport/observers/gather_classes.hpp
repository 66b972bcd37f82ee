// The directions of a final gather in classes of like spread, and the places where their rays start.
#pragma once

#include <cmath>
#include <vector>

#include "transport/observers/gather.hpp"

namespace cloudbow {

/// What a direction's radiance counts in a flux.
inline double power(const GatherDirection& direction) { return direction.weight * std::abs(direction.travel.z()); }

/// Directions that are blurred alike: [first, last) of those in order of their beams' spread.
struct SpreadClass {
  std::size_t first;
  std::size_t last;
  double spread;  ///< distance over which a beam spreads, per unit height (docs/theory.md (26)), flux-weighted
};

/// Sorts the directions.
std::vector<SpreadClass> spread_classes(std::vector<GatherDirection>& directions);

/// Where in their columns the rays of a direction start, as fractions.
struct LaunchPlace {
  double x;
  double y;
};

/// The centre, from where each direction is right to second order; or, to fill the columns, another place for each
/// direction (additive recurrence of the plastic number, Roberts 2018), for light that changes within the columns.
LaunchPlace launch_place(std::size_t direction, bool filling);

}  // namespace cloudbow
