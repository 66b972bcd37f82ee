#include "transport/observers/lateral_boundary.hpp"

#include <numeric>

#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/radiance_march.hpp"
#include "transport/rays/march.hpp"

namespace cloudbow {
namespace {

SolverOptions as_one_column(SolverOptions options) {
  options.independent_columns = false;
  return options;
}

IterationOptions in_full_precision(const IterationOptions& options) {
  IterationOptions full = options;
  full.half_precision_radiance = false;
  return full;
}

double mean_of(const std::vector<float>& map, double otherwise) {
  if (map.empty()) return otherwise;
  return std::accumulate(map.begin(), map.end(), 0.) / static_cast<double>(map.size());
}

Surface surface_beyond_sides(const Problem& problem) {
  if (!problem.emits()) return {};
  const Surface& surface = problem.surface;
  Surface beyond;
  beyond.albedo = surface.brdf ? 0 : mean_of(surface.albedo_map, surface.albedo);
  beyond.planck = mean_of(surface.planck_map, surface.planck);
  return beyond;
}

}  // namespace

LateralBoundary::LateralBoundary(const Problem& problem, const Discretisation& discretisation,
                                 const SolverOptions& options)
    : problem_{layers_only(problem.grid), problem.phase, problem.sun, problem.sky_radiance,
               surface_beyond_sides(problem)},
      system_(make_system<double>(problem_, discretisation, as_one_column(options))) {
  IterationResult<double> solved = iterate_source(system_, in_full_precision(options), {});
  if (problem.emits()) from_ground_ = ground_of_iteration(system_, solved.fluxes).at_points.row(0)[0];
  std::optional<DirectBeam<double>> beam;
  if (problem_.sun)
    beam = beam_with<double>(problem_, system_.cells->rows, discretisation.gather_fraction(), as_one_column(options),
                             of_cells);
  source_.emplace(scattered_source(discretisation, system_, std::move(solved.radiance)));
  beside_peak_ = source_;
  set_first_order(problem_, discretisation, system_, beam ? &*beam : nullptr, *source_);
  set_first_order_beside_peak(problem_, discretisation, system_, *beside_peak_);
}

std::vector<double> LateralBoundary::radiance(const Direction& travel) const { return march_in(*source_, travel); }

std::vector<double> LateralBoundary::radiance_beside_peak(const Direction& travel) const {
  return march_in(*beside_peak_, travel);
}

std::vector<double> LateralBoundary::march_in(const DirectionalSource<double>& from, const Direction& travel) const {
  const PathPattern pattern = make_path_pattern(system_.box, travel, .5, .5, true, {0, system_.box.nz()});
  std::vector<double> at_edge(system_.box.nz() + 1, 0.);
  LinearSource<double> source;
  source.resize(system_.cells->size());
  from.query(travel, source.value.data());
  if (system_.linear_source) source.make_gradient(*system_.cells, system_.thermal_emission());
  std::vector<double> ray(1, travel.z() < 0 ? problem_.sky_radiance : from_ground_);
  march<double, false>(
      pattern, system_.cells->rows, source.view(*system_.cells), true, {}, source.value.data(), ray.data(), false, {},
      [&](int step, const double* p, auto&) { at_edge[pattern.upward ? step : system_.box.nz() - step] = *p; });
  return at_edge;
}

}  // namespace cloudbow
