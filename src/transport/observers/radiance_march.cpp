#include "transport/observers/radiance_march.hpp"

#include <algorithm>

#include "transport/rays/march.hpp"

namespace cloudbow {

template <class Real>
GroundRadiance<Real> ground_of_iteration(const TransportSystem<Real>& system, const SweepFluxes<Real>& fluxes) {
  std::vector<double> diffuse_flux = fluxes.surface_flux;
  for (std::size_t c = 0; c < system.beam.surface_flux.size(); ++c) diffuse_flux[c] -= system.beam.surface_flux[c];
  return system.ground.radiance(fluxes.surface_arriving, diffuse_flux, system.beam.surface_flux, system.ordinates);
}

template <class Real>
std::span<const Real> RadianceMarch<Real>::mean_radiance(const Problem& problem, const TransportSystem<Real>& system,
                                                         const GroundRadiance<Real>& ground,
                                                         const LateralBoundary* lateral_boundary,
                                                         const Direction& travel, std::span<const Real> source) {
  const BoxGrid& box = system.box;
  const LevelRange levels{0, box.nz()};
  const StartFraction start = start_for_centred_exit(box, travel, system.independent_columns, levels);
  const PathPattern pattern = make_path_pattern(box, travel, start.x, start.y, system.independent_columns, levels);
  rays_.assign(box.columns() + lane_padding, static_cast<Real>(problem.sky_radiance));
  if (pattern.upward) std::copy_n(ground.along(travel, from_ground_), box.columns(), rays_.begin());
  side_.clear();
  if (lateral_boundary != nullptr) {
    const auto by_height = lateral_boundary->radiance(travel);
    side_.assign(by_height.begin(), by_height.end());
    if (!pattern.upward) std::reverse(side_.begin(), side_.end());
  }
  linear_.resize(source.size());
  std::copy(source.begin(), source.end(), linear_.value.begin());
  if (system.linear_source) linear_.make_gradient(*system.cells, system.thermal_emission());
  radiance_.assign(source.size() + lane_padding, Real(0));
  march<Real, true>(pattern, system.cells->rows, linear_.view(*system.cells), box.periodic, side_, linear_.value.data(),
                    rays_.data(), true, {radiance_.data()}, [](int, const Real*, auto&) {});
  return std::span<const Real>(radiance_).first(source.size());
}

template GroundRadiance<float> ground_of_iteration<float>(const TransportSystem<float>&, const SweepFluxes<float>&);
template GroundRadiance<double> ground_of_iteration<double>(const TransportSystem<double>&, const SweepFluxes<double>&);
template class RadianceMarch<float>;
template class RadianceMarch<double>;

}  // namespace cloudbow
