// Emission in a scene's problem, from temperatures.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/assembly/open_clouds.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/transport/problem.hpp"

namespace cloudbow {

/// Heights at which levels of layers must end, so that Planck radiance is linear in each. None between the faces of the
/// cloud's voxels, which are levels already.
/// @param clouds their voxels; null: none. @param z_m bottom and top of the domain
std::vector<double> emission_levels(const Scene& scene, const CloudField* clouds, const std::array<double, 2>& z_m);

/// Sets the emission of the grid and the ground. The grid is complete.
/// @param extent_m of the domain along x and y
/// @throws InputError if nothing emits at the scene's wavelength; for a map of temperature that does not fit.
void add_emission(const Scene& scene, const OpenedClouds& clouds, const std::array<double, 2>& extent_m,
                  Problem& problem);

/// A sentence about a domain that ends above or below the atmosphere's profile; none otherwise.
std::optional<std::string> doubt_atmosphere(const Scene& scene, const std::array<double, 2>& z_m);

}  // namespace cloudbow
