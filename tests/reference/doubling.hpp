// Light in a homogeneous slab by doubling: an independent check of whatever scatters light among directions. It has no
// rays, voxels or sweeps. A thin slab's response, exact but for rounding, is doubled until the slab has the wanted
// thickness (van de Hulst 1963; Hansen & Travis 1974).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace cloudbow::reference {

template <class Real>
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
template <class Real>
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// Fractions of the power that enters through the top: reflected upwards, and arriving at the bottom with the direct
/// beam. Over a bright surface, light that it has reflected before counts again.
struct SlabFluxes {
  double reflectance;
  double transmittance;
};

/// A homogeneous slab of unit extinction over a Lambertian surface, lit from above by parallel beams, each solved
/// independently.
template <class Real>
struct SlabOf {
  Vector<Real> mu;           ///< D: z component of the direction of travel, not 0; those downward first
  Vector<Real> weight;       ///< D: quadrature weights [sr]
  Matrix<Real> scatter;      ///< D x D: source at the ordinates from radiance at the ordinates, ssa included
  Vector<Real> beam_mu;      ///< B: cosines of the solar zenith angle, positive
  Matrix<Real> beam_source;  ///< D x B: source from beams of unit normal irradiance, ssa included
  Real beam_extinction = 1;  ///< relative to the diffuse light's
  /// D: source at the ordinates per unit of the Planck radiance; empty: nothing emits
  Vector<Real> emission;
  Real optical_depth = 1;
  Real surface_albedo = 0;
};
using Slab = SlabOf<double>;

/// Light leaving a slab below and above, for light entering above (down) and below (up), without its surface. States of
/// the downward light are radiances at the downward ordinates, then normal irradiances of the beams; of the upward
/// light, radiances. If the slab emits, the downward states end with two more: the Planck radiance at the slab's upper
/// face and its increase per unit of optical depth downward. Their columns are the emitted light.
template <class Real>
struct ResponseOf {
  Matrix<Real> transmit_down, reflect_up;  ///< leaves below: of light that enters above, of light that enters below
  Matrix<Real> reflect_down, transmit_up;  ///< leaves above: of light that enters above, of light that enters below
};
using Response = ResponseOf<double>;

// Real: double, or long double for slabs whose light survives so many scatterings that rounding would show.

template <class Real>
ResponseOf<Real> response_by_doubling(const SlabOf<Real>& slab);

/// Fluxes of the slab over its surface, for each beam.
template <class Real>
std::vector<SlabFluxes> solve_by_doubling(const SlabOf<Real>& slab);

}  // namespace cloudbow::reference
