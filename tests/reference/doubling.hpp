// Light in a homogeneous slab by doubling: an independent check of whatever scatters light among directions. It knows
// nothing of rays, voxels or sweeps; a thin slab's response is doubled until the slab is as thick as wanted (van de
// Hulst 1963; Hansen & Travis 1974).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cloudbow::reference {

/// Fractions of the power that enters through the top: what leaves upwards, and downwards with the direct beam.
struct SlabFluxes {
  double reflectance;
  double transmittance;
};

/// A homogeneous slab of unit extinction, lit from above by parallel beams, each solved by itself.
struct Slab {
  Eigen::VectorXd mu;           ///< D: z component of the direction of travel, not 0; those downward first
  Eigen::VectorXd weight;       ///< D: quadrature weights [sr]
  Eigen::MatrixXd scatter;      ///< D x D: source at the ordinates from radiance at the ordinates, ssa included
  Eigen::VectorXd beam_mu;      ///< B: cosines of the solar zenith angle, positive
  Eigen::MatrixXd beam_source;  ///< D x B: source from beams of unit normal irradiance, ssa included
  double beam_extinction = 1;   ///< relative to the diffuse light's
  double optical_depth = 1;
};

/// What leaves a slab below and above for what enters above (down) and below (up). States of the downward light are
/// radiances at the downward ordinates, then normal irradiances of the beams; of the upward light, radiances.
struct Response {
  Eigen::MatrixXd transmit_down, reflect_up;  ///< leaves below: of light that enters above, of light that enters below
  Eigen::MatrixXd reflect_down, transmit_up;  ///< leaves above: of light that enters above, of light that enters below
};

Response response_by_doubling(const Slab& slab);

/// Of the slab over a black surface, for each beam.
std::vector<SlabFluxes> solve_by_doubling(const Slab& slab);

}  // namespace cloudbow::reference
