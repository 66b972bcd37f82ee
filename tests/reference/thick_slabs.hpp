// Plane-parallel fluxes of slabs of any thickness by doubling, in 80 bits where needed: an independent check of
// whatever scatters light among directions. It knows nothing of rays, voxels or sweeps; a thin slab's response, exact
// but for rounding, is doubled until the slab is as thick as wanted (van de Hulst 1963; Hansen & Travis 1974).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace cloudbow::reference::thick_slabs {

/// Fractions of the power that enters through the top: what leaves upwards, and what arrives at the bottom with the
/// direct beam (over a bright surface, light that it has reflected before counts again).
struct SlabFluxes {
  double reflectance;
  double transmittance;
};

/// A homogeneous slab of unit extinction over a Lambertian surface, lit from above by parallel beams, each solved by
/// itself.
template <class Real>
struct SlabOf {
  Eigen::Vector<Real, Eigen::Dynamic> mu;      ///< D: z component of the direction of travel, not 0
  Eigen::Vector<Real, Eigen::Dynamic> weight;  ///< D: quadrature weights [sr]
  /// D x D: source at the ordinates from radiance at the ordinates, ssa included
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> scatter;
  Eigen::Vector<Real, Eigen::Dynamic> beam_mu;  ///< B: cosines of the solar zenith angle, positive
  /// D x B: source from beams of unit normal irradiance, ssa included
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> beam_source;
  Real beam_extinction = 1;  ///< relative to the diffuse light's
  Real optical_depth = 1;
  Real surface_albedo = 0;
};
using Slab = SlabOf<double>;
std::vector<SlabFluxes> solve_by_doubling(const Slab& slab);

/// Fluxes of a slab with Legendre moments chi(l), solved to about 1e-6: azimuth-averaged, `angles` double-Gauss angles
/// a hemisphere, delta-M at twice that order. Thick ones that hardly absorb in 80 bits, so that a conservative slab of
/// optical depth 1e5 still loses nothing.
std::vector<SlabFluxes> plane_parallel_fluxes(const std::function<double(int)>& chi, std::span<const double> beam_mu,
                                              double optical_depth, double single_scattering_albedo,
                                              double surface_albedo = 0, int angles = 48);

}  // namespace cloudbow::reference::thick_slabs
