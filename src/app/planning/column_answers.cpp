#include "app/planning/column_answers.hpp"

#include <algorithm>

#include "cloudbow/sphere/gauss_legendre.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "cloudbow/transport/probe_columns.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

SolverOptions options_of_columns(const SolverOptions& options) {
  SolverOptions columns = options;
  ask_for_fluxes_alone(columns);
  columns.absorption = true;  // a difference of fluxes would lose digits
  columns.flux_levels = FluxLevels::boundaries;
  columns.listed_levels.clear();
  columns.independent_columns = true;
  columns.beam_crosses_columns = false;
  columns.collapse_uniform_axes = false;
  columns.max_column_optical_depth = 0;
  return columns;
}

// Of light that arrives equally from everywhere; of several directions a cloudy sky is nearest to that.
double mean_albedo(const SurfaceBrdf& brdf) {
  const GaussLegendre rule = make_gauss_legendre(8);
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double mu = .5 * (1 + rule.node[i]);
    sum += rule.weight[i] * mu * brdf.directional_albedo(mu);
  }
  return std::clamp(sum, 0., 1.);
}

}  // namespace

ColumnAnswers column_answers(const Problem& problem, const SolverOptions& options,
                             std::span<const std::size_t> columns) {
  Problem row = side_by_side(problem, columns);
  if (problem.surface.brdf) {
    row.surface.albedo_map.clear();
    row.surface.albedo = mean_albedo(*problem.surface.brdf);
  }
  const Solution solution = solve(row, options_of_columns(options));
  ColumnAnswers answers;
  answers.power = solution.ledger.power;
  if (answers.power == 0) return answers;
  const std::size_t n = columns.size();
  const auto per_power = [&](float value) { return static_cast<double>(value) / answers.power; };
  answers.absorbed.assign(n, 0.);
  for (std::size_t c = 0; c < n; ++c) {
    answers.up.push_back(per_power(solution.upwelling_flux[n + c]));
    answers.down.push_back(per_power(solution.downwelling_diffuse_flux[c]) + per_power(solution.direct_flux[c]));
  }
  const BoxGrid& box = row.grid.box;
  const double cloud_top =
      box.cloud.count > 0 ? box.cloud.bottom_m + box.cloud.count * box.cloud.height_m : box.z_edge_m.back();
  LevelMeans& means = answers.means;
  means.light = {1, solution.ledger.incident, solution.ledger.surface_emission};
  for (int k = 0; k < box.nz(); ++k) {
    const bool below_top = .5 * (box.z_edge_m[k] + box.z_edge_m[k + 1]) < cloud_top;
    double mean = 0;
    for (std::size_t c = 0; c < n; ++c) {
      const double absorbed = per_power(solution.absorbed_power[static_cast<std::size_t>(k) * n + c]);
      if (below_top) answers.absorbed[c] += absorbed * box.thickness_m(k);
      mean += absorbed / static_cast<double>(n);
    }
    if (below_top) answers.heating.push_back(mean);
    means.absorbed.push_back(mean);
  }
  for (int k = 0; k <= box.nz(); ++k) {
    means.up.push_back(solution.profile_upwelling_flux[k] / answers.power);
    means.down_diffuse.push_back(solution.profile_downwelling_diffuse_flux[k] / answers.power);
    means.direct.push_back(solution.profile_direct_flux[k] / answers.power);
  }
  return answers;
}

}  // namespace cloudbow
