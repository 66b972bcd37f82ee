#include "app/planning/broadband.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include "app/planning/coarse_solves.hpp"
#include "app/planning/column_answers.hpp"
#include "app/planning/error_calibration.hpp"
#include "app/planning/solve_share.hpp"
#include "app/planning/spectral_choice.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/process/progress.hpp"
#include "cloudbow/core/thread_scope.hpp"
#include "cloudbow/results/weighted_sum.hpp"
#include "cloudbow/transport/probe_columns.hpp"
#include "cloudbow/transport/solve_seconds.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

using Method = SceneBroadband::Method;

/// G-points to solve; the sum of weights times their solutions is the answer.
struct Points {
  std::vector<int> point;
  std::vector<double> weight;
  double residual = 0;
  LevelMeans missing{};                                    ///< of all, less those of the points
  double largest_air_error = cloudbow::largest_air_error;  ///< of the blocks of each
};

Points all_points(const std::vector<Scene>& scenes) {
  Points all;
  for (std::size_t g = 0; g < scenes.size(); ++g) {
    all.point.push_back(static_cast<int>(g));
    all.weight.push_back(1);
  }
  return all;
}

/// G-points of short waves have narrow blocks of air, and a share of the light only. Each may err by more than a single
/// wavelength, by one over their share: the sum then does not. @param narrow_share of such g-points.
double air_error_of_points(double narrow_share) {
  constexpr double most = .02;  // beyond, the error of blocks was not measured
  return std::clamp(largest_air_error / std::max(narrow_share, 1e-9), largest_air_error, most);
}

bool has_narrow_blocks(const OpticalGrid& grid) {
  return std::any_of(grid.air.begin(), grid.air.end(), [](const AirBlocks& air) { return air.count() > 1; });
}

Points few_points(const std::vector<Scene>& scenes, const CostEstimate& cost, const RunOptions& options,
                  std::uint64_t available, CloudFiles& files) {
  const SceneBroadband& broadband = *scenes.front().broadband;
  std::vector<ColumnAnswers> answers;
  std::vector<bool> is_narrow;
  std::vector<std::size_t> columns;
  for (const Scene& scene : scenes) {
    const AssembledScene assembled = assemble(scene, available, files, cost.levels_m);
    if (columns.empty()) columns = representative_columns(assembled.problem.grid, columns_of_choice);
    const ThreadScope threads(options.threads);
    answers.push_back(column_answers(assembled.problem, assembled.options, columns));
    is_narrow.push_back(has_narrow_blocks(assembled.problem.grid));
    InterruptGuard::check();
  }
  const SpectralChoice choice = choose_points(answers, broadband.few_tolerance, broadband.few_points);
  Points few{choice.point, {}, choice.residual, choice.missing};
  double power = 0, narrow = 0;
  for (std::size_t n = 0; n < choice.point.size(); ++n) {
    const auto g = static_cast<std::size_t>(choice.point[n]);
    few.weight.push_back(choice.weight[n] / answers[g].power);
    power += choice.weight[n];
    if (is_narrow[g]) narrow += choice.weight[n];
  }
  few.largest_air_error = air_error_of_points(power > 0 ? narrow / power : 1);
  return few;
}

// Measured on five fields: columns err by at most 2.2 times the residual of the choice, absorption by 4 times.
constexpr double error_per_residual = 3;

/// Places in `points` of those that carry the most light. Coarse solves of more g-points would hardly change the
/// estimate: errors of strong ones are alike.
std::vector<std::size_t> strongest(const Points& points, const GasModel& model) {
  const auto power = [&](std::size_t n) {
    constexpr double ground_k = 288;
    const int g = points.point[n];
    return points.weight[n] *
           (model.light() == GasModel::Light::solar ? model.solar_share(g) : model.planck(g, ground_k));
  };
  std::vector<std::size_t> order(points.point.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return power(a) > power(b); });
  order.resize(std::min(order.size(), estimated_points));
  return order;
}

/// Adds the mean light of the g-points that were left out, the same everywhere in a level. Direct light in deep shadow
/// stays as it is: it would fall below 0.
void add_missing(const LevelMeans& missing, Solution& sum) {
  if (missing.up.empty()) return;
  const std::size_t columns = sum.box.columns();
  const auto add = [columns](float more, std::size_t plane, std::vector<float>& field) {
    for (std::size_t c = plane * columns; c < (plane + 1) * columns; ++c) field[c] = std::max(0.F, field[c] + more);
  };
  for (std::size_t plane = 0; plane < sum.flux_level.size(); ++plane) {
    const auto level = static_cast<std::size_t>(sum.flux_level[plane]);
    add(static_cast<float>(missing.up[level]), plane, sum.upwelling_flux);
    add(static_cast<float>(missing.down_diffuse[level]), plane, sum.downwelling_diffuse_flux);
    add(static_cast<float>(missing.direct[level]), plane, sum.direct_flux);
  }
  for (std::size_t level = 0; level < missing.up.size(); ++level) {
    sum.profile_upwelling_flux[level] += missing.up[level];
    sum.profile_downwelling_diffuse_flux[level] += missing.down_diffuse[level];
    sum.profile_direct_flux[level] += missing.direct[level];
  }
  double absorbed = 0;
  for (std::size_t k = 0; k < missing.absorbed.size(); ++k) {
    absorbed += missing.absorbed[k] * sum.box.thickness_m(static_cast<int>(k));
    if (sum.absorbed_power.empty()) continue;
    const auto more = static_cast<float>(missing.absorbed[k]);
    for (std::size_t c = k * columns; c < (k + 1) * columns; ++c) sum.absorbed_power[c] += more;
  }
  EnergyLedger& ledger = sum.ledger;
  const double down = missing.down_diffuse.front() + missing.direct.front(), emitted = missing.light[2];
  const double before = ledger.power;
  ledger.power += missing.light[0];
  const auto add_power = [&](double more, double& term) { term = (before * term + more) / ledger.power; };
  add_power(missing.light[1], ledger.incident);
  add_power(emitted, ledger.surface_emission);
  add_power(missing.up.back(), ledger.reflectance);
  add_power(down, ledger.transmittance);
  add_power(missing.direct.front(), ledger.transmittance_direct);
  add_power(absorbed, ledger.absorptance);
  add_power(down - missing.up.front() + emitted, ledger.surface_absorptance);
  for (double* const term : {&ledger.side_gain, &ledger.side_loss, &ledger.residual}) add_power(0, *term);
}

/// Mean flux of the columns, of which the estimate's relative error is.
double mean_flux(const Solution& solution, bool up) {
  if (up) return solution.profile_upwelling_flux.back();
  return solution.profile_downwelling_diffuse_flux.front() + solution.profile_direct_flux.front();
}

/// Errors of g-points have the same origin, so they add up like the fluxes that they are of. Those of g-points without
/// an estimate are relatively the same.
class SummedErrors {
 public:
  void add(const ErrorEstimate& error, const Solution& solution, double weight) {
    if (!sum_) {
      sum_ = ErrorEstimate();
      sum_->calibrated_for = error.calibrated_for;
    }
    const auto add_parts = [](const ErrorParts& of, double share, ErrorParts& to) {
      to.angular += share * of.angular;
      to.spatial += share * of.spatial;
      to.iteration += share * of.iteration;
    };
    const double power = weight * solution.ledger.power;
    power_ += power;
    const double up = weight * mean_flux(solution, true), down = weight * mean_flux(solution, false);
    add_parts(error.domain, power, sum_->domain);
    up_ += up;
    down_ += down;
    add_parts(error.up, up, sum_->up);
    add_parts(error.down, down, sum_->down);
    sum_->between_ends += std::max(up, down) * error.between_ends;
    between_ += std::max(up, down);
    sum_->cpu_seconds += error.cpu_seconds;
    sum_->table_seconds += error.table_seconds;
  }

  /// @param spectral error of the choice of g-points. @param air error of blocks of air in the sum.
  std::optional<ErrorEstimate> with(double spectral, double air) const {
    if (!sum_) return std::nullopt;
    ErrorEstimate error = *sum_;
    const auto divide = [spectral](double by, double of_air, ErrorParts& parts) {
      const double share = by > 0 ? 1 / by : 0;
      parts.angular *= share;
      parts.spatial = std::hypot(parts.spatial * share, of_air);
      parts.iteration *= share;
      parts.spectral = spectral;
    };
    divide(power_, air_error_of_domain * air, error.domain);
    divide(up_, air, error.up);
    divide(down_, air, error.down);
    error.between_ends = between_ > 0 ? std::hypot(error.between_ends / between_, spectral, air) : 0;
    return error;
  }

 private:
  std::optional<ErrorEstimate> sum_;
  double power_ = 0, up_ = 0, down_ = 0, between_ = 0;  // of the estimated g-points
};

/// @param estimates whether its error is estimated too
SolveResult solve_point(const Scene& scene, const PlannedScene& planned, bool estimates, const RunOptions& options,
                        RunClock& clock) {
  clock.begin_solve(predict_phases(planned.plan));
  ProgressDisplay display(options.quiet, planned.plan.options().tolerance, &clock);
  const bool is_estimated = scene.output.error_estimate && estimates;
  CellLight light;
  SolveResult result{solve(planned.plan,
                           [&display](const SolverProgress& progress) {
                             InterruptGuard::check();
                             display.show(progress);
                           },
                           {.light = is_estimated ? &light : nullptr})};
  if (is_estimated) {
    // The error of blocks is added for the sum: it differs much between g-points.
    const double of_air = std::exchange(result.solution.report.air_error, 0.);
    result.error = estimate_of(scene, planned, result.solution, std::move(light));
    result.solution.report.air_error = of_air;
  }
  result.cloud_optical_depth = planned.scene->cloud_optical_depth;
  result.cloud_extinction = planned.scene->cloud_extinction;
  result.clouds = planned.scene->clouds;
  result.phase_classes = planned.scene->phase_classes;
  InterruptGuard::check();
  return result;
}

}  // namespace

BroadbandRun solve_broadband(const std::vector<Scene>& scenes, const CostEstimate& cost, const RunOptions& options,
                             std::uint64_t available, CloudFiles& files) {
  const SceneBroadband& broadband = *scenes.front().broadband;
  const bool few = broadband.method == Method::few;
  if (few && !options.quiet) tell("choice of g-points\n");
  const Points points = few ? few_points(scenes, cost, options, available, files) : all_points(scenes);
  BroadbandRun run;
  run.info.model = broadband.file;
  run.info.method = few ? "few" : broadband.method == Method::all ? "all" : "columns";
  run.info.light = broadband.model->light() == GasModel::Light::solar ? "solar" : "longwave";
  run.info.points = broadband.model->points();
  run.info.solved = points.point;
  run.info.weight = points.weight;
  run.info.residual = points.residual;
  const std::vector<std::size_t> estimated = strongest(points, *broadband.model);
  const GasModel::Bands bands = broadband.model->bands();
  if (scenes.front().output.bands) run.bands = band_profiles(*broadband.model);
  Solution sum;
  SummedErrors errors;
  std::vector<double> seconds_here;
  for (std::size_t n = 0; n < points.point.size(); ++n) {
    if (options.share == nullptr || options.share->has(n))
      seconds_here.push_back(cost.solve_seconds[static_cast<std::size_t>(points.point[n])]);
  }
  RunClock clock(std::move(seconds_here));
  for (std::size_t n = 0; n < points.point.size(); ++n) {
    const auto point = static_cast<std::size_t>(points.point[n]);
    const bool estimates = std::find(estimated.begin(), estimated.end(), n) != estimated.end();
    std::optional<SolveResult> result = shared_solve(options.share.get(), n, [&] {
      Scene scene = as_solved(scenes[point]);
      scene.broadband->largest_air_error = points.largest_air_error;
      if (!options.quiet) tell("g-point {}: {} of {} to solve\n", point, n + 1, points.point.size());
      return solve_point(scene, plan_scene(scene, available, files, cost.levels_m, options.threads), estimates, options,
                         clock);
    });
    if (!result) continue;
    if (result->error) errors.add(*result->error, result->solution, points.weight[n]);
    add_weighted(sum, result->solution, points.weight[n]);
    if (!run.bands.empty()) add_to_band(result->solution, run.bands[static_cast<std::size_t>(bands.of_point[point])]);
    if (n > 0) continue;
    if (scenes.front().output.optical_depth)
      run.solved.cloud_optical_depth.push_back(std::move(result->cloud_optical_depth));
    if (scenes.front().output.extinction) run.solved.cloud_extinction.push_back(std::move(result->cloud_extinction));
    run.solved.clouds.push_back(std::move(result->clouds));
    if (result->phase_classes) run.solved.phase_classes.push_back(*result->phase_classes);
  }
  if (!collects(options.share.get())) return run;
  add_missing(points.missing, sum);
  if (const auto error = errors.with(error_per_residual * points.residual, sum.report.air_error))
    run.solved.errors.push_back(*error);
  run.solved.solutions.push_back(std::move(sum));
  return run;
}

}  // namespace cloudbow
