// Droplets for tests.
#pragma once

#include "cloudbow/optics/mie_table.hpp"
#include "cloudbow/optics/refractive_index.hpp"

namespace cloudbow {

/// Of water, with its refractive index.
inline DropletRecipe water(double wavelength_um) {
  DropletRecipe recipe;
  recipe.wavelength_um = wavelength_um;
  recipe.refractive_index = refractive_index(Substance::water, wavelength_um);
  return recipe;
}

}  // namespace cloudbow
