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
};

}  // namespace cloudbow
