// The scene in the iteration: cells with truncated peaks, the scattering matrices, the direct beams; and, from the
// converged radiance, the source in any direction.
#pragma once

#include <functional>
#include <vector>

#include "transport/rays/direct_beam.hpp"
#include "transport/scattering/directional_source.hpp"
#include "transport/scattering/discretisation.hpp"
#include "transport/system/sweep.hpp"

namespace cloudbow {

/// The direct beam if the fraction f_p of the scattering by phase function p counts as unscattered.
template <class Real>
DirectBeam<Real> beam_with(const Problem& problem, const ActiveRows& rows, const std::vector<double>& forward_fraction,
                           const SolverOptions& options, const BeamParts& parts = {});

/// @param side_radiance as TransportSystem::side_radiance
template <class Real>
TransportSystem<Real> make_system(const Problem& problem, const Discretisation& discretisation,
                                  const SolverOptions& options, std::vector<std::vector<Real>> side_radiance = {});

/// Source in any direction of the converged diffuse radiance, whose memory it takes: orders of scattering >= 2.
template <class Real>
DirectionalSource<Real> scattered_source(const Discretisation& discretisation, const TransportSystem<Real>& system,
                                         AngularField<Real> radiance);

/// Extinction of the active cells, 1/m, if the fraction f_p of the scattering by phase function p counts as
/// unscattered.
template <class Real>
std::vector<Real> scaled_extinction(const OpticalGrid& grid, const std::vector<double>& forward_fraction);

/// Adds the first scattering of a beam by one phase function: source = P share scattering/extinction irradiance / (4
/// pi).
template <class Real>
void add_single_scattering(std::vector<SingleScattering<Real>>& first_order, const std::function<double(double)>& phase,
                           std::span<const float> scattering, double share, std::span<const Real> extinction,
                           std::span<const Real> irradiance);

/// The first order of scattering for fluxes beside light that is scattered within the forward peak (docs/theory.md, Eq.
/// 25). It replaces that of the source.
template <class Real>
void set_first_order_beside_peak(const Problem& problem, const Discretisation& discretisation,
                                 const TransportSystem<Real>& system, DirectionalSource<Real>& source);

/// The first order of scattering for radiance, which replaces that of the source. Its incident beam is the one
/// truncated at the gather's order. The iteration's beam (order N_b) counts more light as unscattered. The difference
/// is added with the phase function of order N_b. @param gather_beam needed if the problem has a sun.
template <class Real>
void set_first_order(const Problem& problem, const Discretisation& discretisation, const TransportSystem<Real>& system,
                     const DirectBeam<Real>* gather_beam, DirectionalSource<Real>& source);

}  // namespace cloudbow
