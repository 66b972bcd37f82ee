// Light in plane-parallel layers by adding and doubling (van de Hulst 1963; Hansen & Travis 1974), one azimuth mode
// after the other: an independent check of scenes of layers, and the maker of new references for them. It shares
// nothing with transport: no rays, no cells, no iteration; directions are Gauss angles, scattering is a Legendre
// series.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "reference/doubling.hpp"

namespace cloudbow::reference {

/// Legendre moments chi(l) of a phase function, chi(0) = 1.
using Moments = std::function<double(int)>;

struct PlaneParallelLayer {
  double optical_depth = 1;
  double single_scattering_albedo = 1;
  Moments moments;
  /// Planck radiances at the upper and lower face: the layer emits (1 - ssa) B per unit of optical depth, with B linear
  /// in optical depth between the faces.
  double planck_top = 0, planck_bottom = 0;
};

/// Layers from the top to a Lambertian surface, lit by sun and uniform sky. Layers and surface can emit.
struct PlaneParallelScene {
  std::vector<PlaneParallelLayer> layers;
  double surface_albedo = 0;
  double sun_mu = 1;      ///< cosine of the solar zenith angle, positive
  double irradiance = 1;  ///< through a surface that faces the sun
  double sky_radiance = 0;
  double surface_planck = 0;  ///< the surface emits (1 - albedo) times this radiance
};

struct PlaneParallelEffort {
  int angles = 48;  ///< Gauss angles per hemisphere; delta-M at twice as many moments
  int slices = 1;   ///< of each layer, equally thick: at the planes between them there are fluxes too
  /// Directions of radiances: cosines (0 to 1] and azimuths of travel against that of the sunlight. Each azimuth mode
  /// costs as much as all fluxes.
  std::vector<double> view_mu, view_azimuth_deg;
};

struct PlaneParallelLevel {
  double optical_depth, up, down_diffuse, down_direct;  ///< from the top; the direct flux by the true extinction
};

struct PlaneParallelSolution {
  std::vector<PlaneParallelLevel> levels;                 ///< top first
  Eigen::MatrixXd radiance_up_top, radiance_down_bottom;  ///< view_mu x view_azimuth, diffuse; delta-scaled peaks
};

PlaneParallelSolution solve_plane_parallel(const PlaneParallelScene& scene, const PlaneParallelEffort& effort);

/// Fluxes of one layer over a Lambertian surface for several suns, solved to about 1e-6 with 48 angles. Thick layers
/// that hardly absorb are solved in 80 bits: a conservative one of optical depth 1e5 then still loses nothing.
std::vector<SlabFluxes> plane_parallel_fluxes(const Moments& moments, std::span<const double> beam_mu,
                                              double optical_depth, double single_scattering_albedo,
                                              double surface_albedo = 0, int angles = 48);

}  // namespace cloudbow::reference
