// The input of a solve, in plain arrays. Conventions: z up, k and z_edge ascend; light is given by its direction of
// travel.
#pragma once

#include <optional>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/medium/surface.hpp"
#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

/// Range of irradiances, sky radiances and Planck radiances, if they are not 0. Float then holds every flux and
/// radiance that is 1e-12 of them or more. It also holds everything that a cloud or surface focuses.
inline constexpr double least_light = 1e-25, most_light = 1e25;

struct Sun {
  Direction travel;       ///< direction in which sunlight travels, z < 0
  double irradiance = 1;  ///< W m-2, 0 or least_light to most_light, through a surface that faces the sun
};

struct Problem {
  OpticalGrid grid;
  std::vector<PhaseFunction> phase;  ///< one for each of grid.scattering
  std::optional<Sun> sun;
  double sky_radiance = 0;  ///< W m-2 sr-1, 0 or least_light to most_light, uniform diffuse light from above
  Surface surface;

  /// Whether matter or ground emits: thermal scenes, in which absorbed power is net of what is emitted.
  bool emits() const { return grid.emits() || surface.emits(); }
};

}  // namespace cloudbow
