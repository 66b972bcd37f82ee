#include "cloudbow/transport/seen_source.hpp"

#include <numbers>

namespace cloudbow {

template <class Real>
SourceAlong<Real> SeenSource<Real>::along(std::size_t i) const {
  SourceAlong<Real> source;
  const Real* const row = higher_orders.row(static_cast<int>(i));
  source.points = {{{Real(1), row}, {Real(0), row}, {Real(0), row}}};
  for (const auto& beam : first_order)
    source.first_order.push_back({static_cast<Real>(beam.phase(travel[i].dot(sun_travel))), beam.intensity.data()});
  return source;
}

template <class Real>
SeenSource<Real> seen_source(const Problem& problem, const Discretisation& discretisation,
                             const TransportSystem<Real>& system, const AngularField<Real>& radiance,
                             std::span<const Direction> travel) {
  SeenSource<Real> seen;
  seen.travel.assign(travel.begin(), travel.end());
  const OrdinateSet& ordinates = discretisation.ordinates;
  std::vector<DenseMatrix<Real>> towards;
  for (const DeltaM& diffuse : discretisation.diffuse) {
    DenseMatrix<Real>& matrix = towards.emplace_back(seen.travel.size(), ordinates.size());
    for (std::size_t i = 0; i < seen.travel.size(); ++i) {
      for (int d = 0; d < ordinates.size(); ++d) {
        matrix(static_cast<Eigen::Index>(i), d) =
            static_cast<Real>(diffuse.truncated(seen.travel[i].dot(ordinates.direction[d])) * ordinates.weight[d] /
                              (4 * std::numbers::pi));
      }
    }
  }
  seen.higher_orders = scatter_towards<Real>(radiance, towards, *system.cells);
  if (!problem.sun) return seen;
  seen.sun_travel = problem.sun->travel;
  // The whole phase function under the iteration's own beam (Nakajima & Tanaka 1988, "TMS").
  for (std::size_t p = 0; p < problem.phase.size(); ++p) {
    add_single_scattering<Real>(seen.first_order, problem.phase[p], problem.grid.scattering[p], 1.,
                                system.cells->extinction, system.beam_irradiance);
  }
  return seen;
}

template struct SeenSource<float>;
template struct SeenSource<double>;
#define CLOUDBOW_INSTANTIATE(Real)                                                                                 \
  template SeenSource<Real> seen_source<Real>(const Problem&, const Discretisation&, const TransportSystem<Real>&, \
                                              const AngularField<Real>&, std::span<const Direction>)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
