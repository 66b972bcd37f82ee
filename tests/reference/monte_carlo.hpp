// Photon-by-photon Monte Carlo on cells of constant extinction: an independent check of everything that solves for
// light in three dimensions. It shares no code with the program: no rays on a fixed pattern, no directions, no fits.
// Free flights are analytic (the optical depth drawn is used up cell by cell). Absorption is subtracted from the
// photon's weight; Russian roulette ends photons of small weight. Radiances are by local estimation (Marchuk et al.
// 1980; Marshak & Davis 2005, ch. 12.2), roulette of small contributions after Barker et al. (2003, doi
// 10.1029/2003JD003580).
//
// Thermal emission: photons start in cells and at the surface, as many as these emit. Backward, photons start at the
// sensor: a plane, a cell or a view. They collect the Planck radiance of the matter that absorbs them. By reciprocity
// both give the same. Backward, the noise is that of the differences in Planck radiance alone.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reference/scatterer.hpp"

namespace cloudbow::reference {

/// One of the scatterers that fill the cells.
struct Medium {
  double single_scattering_albedo = 1;
  Scatterer scatterer = Scatterer::isotropic();
  std::vector<double> extinction;  ///< [1/m], [k][j][i] with i fastest
};

/// Position of a sensor, seen from the scene: zenith above 90 looks up from below.
struct View {
  double zenith_deg = 0, azimuth_deg = 0;
};

/// Planck radiances of matter, in the unit of the sun's flux per sr; empty: does not emit. A cell emits 4 pi B per
/// volume and absorption coefficient, the surface (1 - albedo) pi B per area.
struct Emission {
  std::vector<double> planck;   ///< mean over the cell, [k][j][i]
  std::vector<double> step;     ///< upper less lower face of the cell, linear between; empty: 0
  std::vector<double> surface;  ///< of each column, [j][i]
};

/// A box of cells over a Lambertian surface, lit by sun, sky and emission. Angles as in docs/conventions.md: azimuth
/// counter-clockwise from +x, of the position of the sun or sensor.
struct MonteCarloScene {
  std::array<int, 2> columns = {1, 1};           ///< nx, ny
  std::array<double, 2> column_size_m = {1, 1};  ///< dx, dy
  std::vector<double> z_edge_m = {0, 1};         ///< nz + 1, ascending; the surface lies at the first
  /// Periodic otherwise. Through open sides the sun comes in unattenuated, and light that leaves is lost.
  bool open_sides = false;
  std::vector<Medium> media;
  Emission emission;
  double surface_albedo = 0;
  double sun_flux = 1;      ///< through the horizontal; 0: no sun
  double sky_radiance = 0;  ///< uniform, through the top alone
  double sun_zenith_deg = 0, sun_azimuth_deg = 0;
  std::vector<int> levels;  ///< indices into z_edge_m: levels of the fluxes
  bool absorption = false;  ///< whether absorbed power is counted
  /// Half angle of a cone about the sun. At each of `levels` its diffuse light is counted; 0: it is not.
  double circumsolar_deg = 0;
  std::vector<View> views;
};

struct MonteCarloEffort {
  std::int64_t photons = 1000000;  ///< in all; each batch takes the same number
  int batches = 50;                ///< at least 2; their scatter gives the standard errors
  std::uint64_t seed = 1;
  int threads = 1;  ///< the result does not depend on it
  /// From the sensors: emission and sky without sun. Columns of planes, with two fluxes, columns of views and cells get
  /// as many photons each.
  bool backward = false;
};

/// A quantity over the columns [j][i], with standard errors.
struct Plane {
  std::vector<double> value, standard_error;
  double mean = 0, mean_standard_error = 0;
};

/// In the unit of the sun's flux, per area of the column.
struct MonteCarloResult {
  std::vector<Plane> up, down;  ///< for each of `levels`: flux through the level, down with the direct beam
  /// For each of `levels`, if requested: diffuse light from the cone about the sun, through a plane that faces the sun.
  std::vector<Plane> circumsolar;
  std::vector<Plane> absorbed;  ///< for each layer of cells, the lowest first, if requested: less what it emits
  std::vector<Plane> radiance;  ///< for each of `views` [1/sr]: mean over a column of the top (or bottom) plane
};

MonteCarloResult solve_by_monte_carlo(const MonteCarloScene& scene, const MonteCarloEffort& effort);

}  // namespace cloudbow::reference
