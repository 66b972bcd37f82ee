// Reflectance of surfaces that their tests share.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cloudbow/optics/surface_brdf.hpp"

namespace cloudbow {

inline Direction travel(double mu, double azimuth_deg) {
  const double sine = std::sqrt(1 - mu * mu);
  const double azimuth = azimuth_deg * std::numbers::pi / 180;
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
}

struct Model {
  const char* name;
  SurfaceBrdf brdf;
};

inline std::vector<Model> models() {
  return {{"lambertian", SurfaceBrdf::lambertian(.3)},
          {"rpv", SurfaceBrdf::rpv(.1, .7, -.24, .1)},
          {"ross-li", SurfaceBrdf::ross_li(.2, .1, .03)},
          {"cox-munk", SurfaceBrdf::cox_munk(7, 1.34)}};
}

}  // namespace cloudbow
