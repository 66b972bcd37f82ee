// The ground under a scene: a horizontal plane at the bottom of the domain.
#pragma once

#include <optional>
#include <vector>

#include "cloudbow/optics/reflection_table.hpp"

namespace cloudbow {

struct Surface {
  double albedo = 0;                ///< Lambertian, 0 to 1
  std::vector<float> albedo_map;    ///< [ny][nx] Lambertian, in place of it; empty: the same everywhere
  std::optional<SurfaceBrdf> brdf;  ///< instead of both, for surfaces that are not Lambertian or are tilted
  SurfaceTilt tilt;

  // Thermal emission. The emissivity is 1 - albedo, by direction, from the reflection that the solve uses.
  double planck = 0;              ///< Planck radiance at the ground's temperature, W m-2 sr-1
  std::vector<float> planck_map;  ///< [ny][nx], in place of it; empty: the same everywhere

  bool emits() const { return planck > 0 || !planck_map.empty(); }
};

}  // namespace cloudbow
