// Photon-by-photon Monte Carlo on cells of constant extinction: an independent check of everything that solves for
// light in three dimensions. It shares no code with the program: no rays on a fixed pattern, no directions, no fits.
// Free flights are analytic (the optical depth drawn is used up cell by cell). Absorption is subtracted from the
// photon's weight; Russian roulette ends photons of small weight. Radiances are by local estimation (Marchuk et al.
// 1980; Marshak & Davis 2005, ch. 12.2), roulette of small contributions after Barker et al. (2003, doi
// 10.1029/2003JD003580).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cloudbow::reference {

/// A phase function with mean 1 over the sphere, and draws from it.
class Scatterer {
 public:
  static Scatterer isotropic();
  static Scatterer rayleigh();                   ///< 3/4 (1 + mu^2)
  static Scatterer henyey_greenstein(double g);  ///< -1 < g < 1
  /// @param angle_deg scattering angles, ascending from 0 to 180
  /// @param value >= 0 at them, any factor; linear in the cosine between
  static Scatterer table(std::span<const double> angle_deg, std::span<const double> value);

  double operator()(double cos_angle) const;
  /// The cosine of the scattering angle below which a share `uniform` (0 to 1) of the light goes: the inverse of the
  /// cumulative distribution, exact for every kind.
  double cosine_at(double uniform) const;

 private:
  enum class Kind { isotropic, rayleigh, henyey_greenstein, table };
  Kind kind_ = Kind::isotropic;
  double g_ = 0;
  std::vector<double> cosine_, value_, cumulative_;  // of a table, cosines ascending
};

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

/// A box of cells over a Lambertian surface, lit by the sun alone. Angles as in docs/conventions.md: azimuth
/// counter-clockwise from +x, of the position of the sun or sensor.
struct MonteCarloScene {
  std::array<int, 2> columns = {1, 1};           ///< nx, ny
  std::array<double, 2> column_size_m = {1, 1};  ///< dx, dy
  std::vector<double> z_edge_m = {0, 1};         ///< nz + 1, ascending; the surface lies at the first
  /// Periodic otherwise. Through open sides the sun comes in unattenuated, and light that leaves is lost.
  bool open_sides = false;
  std::vector<Medium> media;
  double surface_albedo = 0;
  double sun_zenith_deg = 0, sun_azimuth_deg = 0;
  std::vector<int> levels;  ///< indices into z_edge_m: levels of the fluxes
  bool absorption = false;  ///< whether absorbed power is counted
  std::vector<View> views;
};

struct MonteCarloEffort {
  std::int64_t photons = 1000000;  ///< in all; each batch takes the same number
  int batches = 50;                ///< at least 2; their scatter gives the standard errors
  std::uint64_t seed = 1;
  int threads = 1;  ///< the result does not depend on it
};

/// A quantity over the columns [j][i], with standard errors.
struct Plane {
  std::vector<double> value, standard_error;
  double mean = 0, mean_standard_error = 0;
};

/// For unit irradiance of a horizontal surface by the sun.
struct MonteCarloResult {
  std::vector<Plane> up, down;  ///< for each of `levels`: flux through the level, down with the direct beam
  std::vector<Plane>
      absorbed;  ///< for each layer of cells, the lowest first, if requested: power by area of the column
  std::vector<Plane> radiance;  ///< for each of `views` [1/sr]: mean over a column of the top (or bottom) plane
};

MonteCarloResult solve_by_monte_carlo(const MonteCarloScene& scene, const MonteCarloEffort& effort);

}  // namespace cloudbow::reference
