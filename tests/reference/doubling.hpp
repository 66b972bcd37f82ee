// Plane-parallel fluxes by doubling: an independent check of whatever scatters light among directions. It knows nothing
// of rays, voxels or sweeps; a thin slab's response is doubled until the slab is as thick as wanted (van de Hulst 1963;
// Hansen & Travis 1974).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace cloudbow::reference {

/// Fractions of the power that enters through the top: what leaves upwards, and downwards with the direct beam.
struct SlabFluxes {
  double reflectance;
  double transmittance;
};

/// A homogeneous slab of unit extinction over a black surface, lit from above by parallel beams, each solved by itself.
struct Slab {
  Eigen::VectorXd mu;           ///< D: z component of the direction of travel, not 0
  Eigen::VectorXd weight;       ///< D: quadrature weights [sr]
  Eigen::MatrixXd scatter;      ///< D x D: source at the ordinates from radiance at the ordinates, ssa included
  Eigen::VectorXd beam_mu;      ///< B: cosines of the solar zenith angle, positive
  Eigen::MatrixXd beam_source;  ///< D x B: source from beams of unit normal irradiance, ssa included
  double beam_extinction = 1;   ///< relative to the diffuse light's
  double optical_depth = 1;
};
std::vector<SlabFluxes> solve_by_doubling(const Slab& slab);

/// Fluxes of a slab with Legendre moments chi(l), solved to about 1e-6: azimuth-averaged, 48 double-Gauss angles a
/// hemisphere, delta-M at order 96.
std::vector<SlabFluxes> plane_parallel_fluxes(const std::function<double(int)>& chi, std::span<const double> beam_mu,
                                              double optical_depth, double single_scattering_albedo);

}  // namespace cloudbow::reference
