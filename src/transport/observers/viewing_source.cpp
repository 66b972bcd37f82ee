#include "transport/observers/viewing_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cloudbow/core/not_negative.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/radiance_march.hpp"

namespace cloudbow {

template <class Real>
std::vector<ViewingBeam<Real>> viewing_beams(const ConvergedField<Real>& field) {
  const Problem& problem = field.problem;
  const Discretisation& discretisation = field.discretisation;
  const SolverOptions& options = field.options;
  const TransportSystem<Real>& system = field.system;
  std::vector<ViewingBeam<Real>> beams;
  if (!problem.sun) return beams;
  // The light of the iteration's beam beyond unscattered light has scattered into the peak.
  const DirectBeam<Real> unscattered =
      beam_with<Real>(problem, system.cells->rows, std::vector<double>(problem.phase.size(), 0.), options, of_cells);
  std::vector<float> place(system.beam.irradiance.size());
  for (std::size_t c = 0; c < place.size(); ++c) {
    const double carried = static_cast<double>(system.beam.irradiance[c]);
    const double never = static_cast<double>(unscattered.irradiance[c]);
    place[c] =
        static_cast<float>(BeamPhase::place(carried > 0 ? std::log(carried / std::max(never, 1e-30 * carried)) : 0));
  }
  for (std::size_t p = 0; p < problem.phase.size(); ++p) {
    std::vector<SingleScattering<Real>> first;
    add_single_scattering<Real>(first, problem.phase[p], problem.grid.scattering[p], 1., system.cells->extinction,
                                system.beam.irradiance);
    if (!first.empty())
      beams.push_back({BeamPhase(problem.phase[p], discretisation.beam[p]), std::move(first.front().intensity), place});
  }
  return beams;
}

namespace {

// Source towards directions from radiance at the ordinates, by one phase function each, whose mean over the sphere
// is 1.
template <class Real>
AngularField<Real> scattered_by(const std::vector<PhaseFunction>& phase, const std::vector<double>& share,
                                const OrdinateSet& ordinates, const Cells<Real>& cells,
                                const AngularField<Real>& radiance, std::span<const Direction> travel) {
  std::vector<DenseMatrix<Real>> towards;
  for (std::size_t p = 0; p < phase.size(); ++p) {
    DenseMatrix<Real>& matrix = towards.emplace_back(travel.size(), ordinates.size());
    for (std::size_t i = 0; i < travel.size(); ++i) {
      for (int d = 0; d < ordinates.size(); ++d) {
        matrix(static_cast<Eigen::Index>(i), d) = static_cast<Real>(
            share[p] * phase[p](travel[i].dot(ordinates.direction[d])) * ordinates.weight[d] / (4 * std::numbers::pi));
      }
    }
  }
  return scatter_towards<Real>(radiance, towards, cells);
}

// How much of the radiance scatters by the phase functions into a direction; the rest is in the peak.
struct SeenScattering {
  std::vector<PhaseFunction> phase;  // resolved by the gather
  std::vector<double> share;         // of the scattering that transport counts

  explicit SeenScattering(const Discretisation& discretisation) {
    for (std::size_t p = 0; p < discretisation.gather.size(); ++p) {
      phase.push_back(discretisation.gather[p].truncated);
      share.push_back((1 - discretisation.gather[p].forward_fraction) /
                      (1 - discretisation.diffuse[p].forward_fraction));
    }
  }
  // Of the radiance at ordinate d into a direction.
  double at(std::size_t p, const OrdinateSet& ordinates, int d, const Direction& travel) const {
    return share[p] * phase[p](travel.dot(ordinates.direction[d])) * ordinates.weight[d] / (4 * std::numbers::pi);
  }
  // Of the radiance along the direction itself: what the sum over ordinates lacks.
  double forward(std::size_t p, const OrdinateSet& ordinates, const Direction& travel) const {
    double sum = 0;
    for (int d = 0; d < ordinates.size(); ++d)
      sum += ordinates.weight[d] * phase[p](travel.dot(ordinates.direction[d])) / (4 * std::numbers::pi);
    return 1 - share[p] * sum;
  }
};

}  // namespace

Direction off_the_horizon(const Direction& travel) {
  constexpr double least = .02;
  if (std::abs(travel.z()) >= least) return travel;
  const double stretch = std::sqrt((1 - least * least) / (1 - travel.z() * travel.z()));
  return {stretch * travel.x(), stretch * travel.y(), travel.z() < 0 ? -least : least};
}

template <class Real>
AngularField<Real> higher_orders_seen(const ConvergedField<Real>& field, std::span<const Direction> travel) {
  const Problem& problem = field.problem;
  const Discretisation& discretisation = field.discretisation;
  const TransportSystem<Real>& system = field.system;
  const IterationResult<Real>& solved = field.result;
  const LateralBoundary* const lateral_boundary = field.lateral_boundary;
  const OrdinateSet& ordinates = discretisation.ordinates;
  const Cells<Real>& cells = *system.cells;
  const std::size_t phases = problem.phase.size();
  std::vector<PhaseFunction> truncated;
  std::vector<double> whole(phases, 1.);
  for (std::size_t p = 0; p < phases; ++p) truncated.push_back(discretisation.diffuse[p].truncated);
  const SeenScattering seen(discretisation);
  const auto scattered_by_all = [&](const std::vector<PhaseFunction>& phase, const std::vector<double>& share) {
    AngularField<Real> towards = scattered_by(phase, share, ordinates, cells, solved.radiance, travel);
    if (field.share != nullptr) field.share->to_first(towards);
    return towards;
  };
  // The radiance along the directions in the approximation of the iteration: from the source of transport.
  AngularField<Real> radiance = scattered_by_all(truncated, whole);
  AngularField<Real> source = scattered_by_all(seen.phase, seen.share);
  if (!field.is_first()) return {};
  std::vector<SingleScattering<Real>> first_order;
  for (std::size_t p = 0; p < phases && problem.sun; ++p) {
    const DeltaM& beam = discretisation.beam[p];
    add_single_scattering<Real>(first_order, beam.truncated, problem.grid.scattering[p], 1 - beam.forward_fraction,
                                cells.extinction, system.beam.irradiance);
  }
  const GroundRadiance<Real> ground = ground_of_iteration(system, solved.fluxes);
  const CellEmission<Real> emission = system.thermal_emission();
  ParallelErrors errors;
#pragma omp parallel
  {
    RadianceMarch<Real> march;
    std::vector<Real> sent;
#pragma omp for schedule(dynamic, 1)
    for (std::size_t i = 0; i < travel.size(); ++i) {
      errors.run([&] {
        Real* const row = radiance.row(static_cast<int>(i));
        sent.assign(row, row + cells.size());
        for (const SingleScattering<Real>& beam : first_order) {
          const Real phase = static_cast<Real>(beam.phase(travel[i].dot(problem.sun->travel)));
          for (std::size_t c = 0; c < sent.size(); ++c) sent[c] += phase * beam.intensity[c];
        }
        if (emission.source != nullptr) {
          for (std::size_t c = 0; c < sent.size(); ++c) sent[c] += emission.source[c];
        }
        const auto along =
            march.mean_radiance(problem, system, ground, lateral_boundary, off_the_horizon(travel[i]), sent);
        std::copy(along.begin(), along.end(), row);
      });
    }
  }
  errors.rethrow();

  for (std::size_t i = 0; i < travel.size(); ++i) {
    for (std::size_t p = 0; p < phases; ++p) {
      const Real forward = static_cast<Real>(seen.forward(p, ordinates, travel[i]));
      const Real* __restrict const scattered = cells.scattered[p].data();
      const Real* __restrict const along = radiance.row(static_cast<int>(i));
      Real* __restrict const to = source.row(static_cast<int>(i));
      for (std::size_t c = 0; c < cells.size(); ++c) to[c] += forward * scattered[c] * along[c];
    }
    Real* const row = source.row(static_cast<int>(i));
    std::transform(row, row + cells.size(), row, [](Real s) { return not_negative(s); });
    if (emission.source != nullptr) {
      for (std::size_t c = 0; c < cells.size(); ++c) row[c] += emission.source[c];
    }
  }
  return source;
}

template <class Real>
Slope<Real> slopes_seen(const ConvergedField<Real>& field, std::span<const Direction> travel,
                        std::span<const Real> source, std::span<const Real> from_beam) {
  const OrdinateSet& ordinates = field.system.ordinates;
  const Cells<Real>& cells = *field.system.cells;
  const SeenScattering seen(field.discretisation);
  Slope<Real> slope;
  for (auto& axis : slope) axis.assign(cells.size() + lane_padding, Real(0));
  for (std::size_t p = 0; p < seen.phase.size(); ++p) {
    std::array<double, octants> from{};
    for (const Direction& towards : travel) {
      const double share = 1. / static_cast<double>(travel.size());
      for (int d = 0; d < ordinates.size(); ++d)
        from[octant_of(ordinates.direction[d])] += share * seen.at(p, ordinates, d, towards);
      from[octant_of(towards)] += share * seen.forward(p, ordinates, towards);
    }
    const Real* __restrict const scattered = cells.scattered[p].data();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Real* __restrict const to = slope[axis].data();
      for (int q = 0; q < octants; ++q) {
        const Real weight = static_cast<Real>(from[q]);
        const Real* __restrict const g = field.result.slopes->of_radiance[q][axis].data();
        for (std::size_t c = 0; c < cells.size(); ++c) to[c] += weight * scattered[c] * g[c];
      }
    }
  }
  make_relative<Real>(field.system.slopes->beam(), field.system.thermal_emission(), source, from_beam, slope);
  return slope;
}

template <class Real>
void add_first_order(const ViewingBeam<Real>& beam, double cos_angle, std::span<Real> source) {
  const std::vector<double> value = beam.phase.at(cos_angle);
  for (std::size_t c = 0; c < source.size(); ++c) {
    const int node = std::min(static_cast<int>(beam.place[c]), BeamPhase::nodes - 2);
    const double share = static_cast<double>(beam.place[c]) - node;
    source[c] += static_cast<Real>((1 - share) * value[node] + share * value[node + 1]) * beam.intensity[c];
  }
}

template std::vector<ViewingBeam<float>> viewing_beams<float>(const ConvergedField<float>&);
template AngularField<float> higher_orders_seen<float>(const ConvergedField<float>&, std::span<const Direction>);
template Slope<float> slopes_seen<float>(const ConvergedField<float>&, std::span<const Direction>,
                                         std::span<const float>, std::span<const float>);
template void add_first_order<float>(const ViewingBeam<float>&, double, std::span<float>);
template std::vector<ViewingBeam<double>> viewing_beams<double>(const ConvergedField<double>&);
template AngularField<double> higher_orders_seen<double>(const ConvergedField<double>&, std::span<const Direction>);
template Slope<double> slopes_seen<double>(const ConvergedField<double>&, std::span<const Direction>,
                                           std::span<const double>, std::span<const double>);
template void add_first_order<double>(const ViewingBeam<double>&, double, std::span<double>);

}  // namespace cloudbow
