#include "transport/iteration/source_iteration.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "transport/acceleration/anderson.hpp"
#include "transport/acceleration/low_order_correction.hpp"
#include "transport/iteration/iteration_state.hpp"
#include "transport/iteration/step_watch.hpp"

namespace cloudbow {
namespace {

// Three earlier iterates of the moments l <= 1 are as good as more. They are better than two iterates of all moments,
// which take more memory.
constexpr int anderson_depth = 3;
constexpr std::size_t mixed_moments = 4;
// A correction has few directions, so that it need not converge. A coarse solve takes few sweeps, and as many with a
// higher tolerance of its corrections.
constexpr double correction_tolerance = .1;
constexpr double coarse_correction_tolerance = .3;
constexpr double coarse_solve = 1e-2;  // least tolerance of such a solve
// Error of column fluxes over the last accelerated change: up to 2.3 in clouds (RICO), 3.3 in slabs (optical depth 10).
constexpr double least_safety = 3;
// The light is brought near its end with slopes from differences, to this estimated error. Then its own slopes are
// found in a few sweeps, and stay: slopes that change in each sweep upset the mixing of iterates. Found earlier they
// would be those of light that is not yet there. In cells that scatter much they would go on to change slowly.
constexpr double error_before_own_slopes = .01;
constexpr int sweeps_with_new_slopes = 3;
// If the light changes by more than this meanwhile, its slopes are found again later.
constexpr double largest_step_of_slopes = .5;
constexpr int last_sweep_to_find_slopes_again = 40;
// Float16 does not resolve changes smaller than its steps: the last of the slow modes of thick clouds stay (Landsat:
// 3e-5). Different rounding in each sweep removes them, but its noise prevents convergence (7e-4).
constexpr double float16_energy_tolerance = 1e-4;

// Opaque matter emits and absorbs far more than leaves it. The net power is a small difference, and rounding of the two
// remains in the ledger. Measured in gas of optical depths to 1e5, in float: up to 1.1 units in the last place.
template <class Real>
double rounding_of_emission(const TransportSystem<Real>& system) {
  if (!system.thermal || system.power <= 0) return 0;
  double emitted = 0;
  for (int k = 0; k < system.box.nz(); ++k) {
    for (std::uint32_t c = system.cells->rows.level_cell[k]; c < system.cells->rows.level_cell[k + 1]; ++c)
      emitted += static_cast<double>(system.absorption[c]) * static_cast<double>(system.planck[c]) *
                 system.box.thickness_m(k) * system.cells->rows.places_of(c);
  }
  const double per_power = 4 * std::numbers::pi * emitted / static_cast<double>(system.box.columns()) / system.power;
  constexpr double units = 4;
  return units * static_cast<double>(std::numeric_limits<Real>::epsilon()) * per_power;
}

// Steps of the scalar flux below these may be due to rounding alone. Measured in thick clouds: up to 3e-6 in float.
template <class Real>
double rounding_of(const AngularField<Real>& radiance) {
  if (radiance.packed()) return 1e-3;
  return sizeof(Real) == sizeof(float) ? 3e-5 : 1e-11;
}
// In fractions of the incident light: fluxes of an iteration that was stopped have no meaning beyond it.
constexpr double largest_imbalance_of_a_result = 1;

class Stopwatch {
 public:
  explicit Stopwatch(double& total) : total_(total), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_;
  std::chrono::steady_clock::time_point start_;
};

template <class Real>
EnergyLedger ledger_of(const TransportSystem<Real>& system, const SweepFluxes<Real>& fluxes,
                       std::span<const Real> scalar_flux) {
  const double columns = static_cast<double>(system.box.columns());
  const double top_area = columns * system.box.dx_m * system.box.dy_m;
  double absorbed = 0;  // less what matter emits
  for (int k = 0; k < system.box.nz(); ++k) {
    const double volume = system.box.dx_m * system.box.dy_m * system.box.thickness_m(k);
    for (std::uint32_t c = system.cells->rows.level_cell[k]; c < system.cells->rows.level_cell[k + 1]; ++c) {
      const double actinic = static_cast<double>(scalar_flux[c]) +
                             (system.beam.irradiance.empty() ? 0. : static_cast<double>(system.beam.irradiance[c]));
      const double emitted = system.planck.empty() ? 0. : 4 * std::numbers::pi * static_cast<double>(system.planck[c]);
      absorbed +=
          static_cast<double>(system.absorption[c]) * (actinic - emitted) * volume * system.cells->rows.places_of(c);
    }
  }
  double surface = 0;
  for (const double f : fluxes.surface_flux) surface += f;
  surface /= columns;
  EnergyLedger ledger;
  if (system.power == 0) return ledger;  // a dark scene closes trivially
  ledger.power = system.power;
  ledger.incident = system.incident / system.power;
  ledger.surface_emission = system.ground.mean_emission() / system.power;
  ledger.reflectance = fluxes.up_top / system.power;
  ledger.transmittance = surface / system.power;
  ledger.absorptance = absorbed / top_area / system.power;
  ledger.surface_absorptance = fluxes.surface_absorbed / system.power;
  ledger.side_gain = (fluxes.side_gain + system.beam.side_gain) / system.power;
  ledger.side_loss = (fluxes.side_loss + system.beam.side_loss) / system.power;
  ledger.residual = ledger.incident + ledger.surface_emission + ledger.side_gain -
                    (ledger.reflectance + ledger.absorptance + ledger.surface_absorptance + ledger.side_loss);
  return ledger;
}

// In this unit, float16 holds radiances from 1e-6 to 1e3 of the mean incident light with its eleven bits. Down to 1e-9
// it holds them with fewer.
template <class Real>
std::optional<Real> float16_unit(const TransportSystem<Real>& system, const IterationOptions& options) {
  if (!options.half_precision_radiance || sizeof(Real) > sizeof(float) || system.power <= 0) return std::nullopt;
  return static_cast<Real>(std::exp2(std::round(std::log2(system.power / std::numbers::pi)) - 6));
}

template <class Real>
double relative_size(std::span<const Real> change, std::span<const Real> of, const OrdinateShare* share) {
  const double size = std::sqrt(ordered_dot<Real>(of, of, 1, share));
  return size == 0 ? 0 : std::sqrt(ordered_dot<Real>(change, change, 1, share)) / size;
}

// The accelerated change is close to the error itself; the rest shrinks by rho per sweep and sums to rho/(1 - rho).
double estimated_error(const std::vector<double>& steps) {
  double rho = .5;
  if (steps.size() >= 3 && steps[steps.size() - 3] > 0)
    rho = std::clamp(std::sqrt(steps.back() / steps[steps.size() - 3]), .2, .95);
  return steps.back() * std::max(least_safety, rho / (1 - rho));
}

// Slopes of light that is far from the solution are not those of the solution.
template <class Real>
void drop_slopes(IterationState<Real>& state) {
  state.finds_slopes = false;
  state.slope_sweeps = 0;
  if (state.result.slopes) state.result.slopes->fitted = false;
}

// Observers then take differences between neighbours, as the sweeps did.
template <class Real>
void drop_unfitted_slopes(IterationResult<Real>& result) {
  if (result.slopes && !result.slopes->fitted) result.slopes.reset();
}

void check_finite(const IterationReport& report, const EnergyLedger& ledger) {
  if (std::isfinite(report.estimated_error) && std::isfinite(ledger.residual)) return;
  throw std::runtime_error(fmt::format(
      "the iteration leaves the range of numbers in sweep {} (found an estimated error of {} and an energy residual of "
      "{}, allowed finite numbers); nothing is written",
      report.sweeps, report.estimated_error, ledger.residual));
}

void check_meaningful(const IterationReport& report, const EnergyLedger& ledger, double step) {
  if (step <= StepWatch::large && std::abs(ledger.residual) <= largest_imbalance_of_a_result) return;
  throw std::runtime_error(
      fmt::format("the iteration diverges in sweep {} (found step {:.1e} and energy residual {:.1e}, allowed {} and "
                  "{}). Nothing is written. Another solver.max_level_optical_depth or solver.accuracy may converge",
                  report.sweeps, step, ledger.residual, StepWatch::large, largest_imbalance_of_a_result));
}

}  // namespace

template <class Real>
IterationResult<Real> iterate_source(const TransportSystem<Real>& system, const IterationOptions& options,
                                     const IterationCallback& progress, Checkpoints* checkpoints,
                                     const OrdinateShare* share, FirstGuess<Real> guess) {
  const std::size_t all = system.cells->size();
  const std::size_t n = share != nullptr ? share->range().size() : all;
  IterationState<Real> state(AndersonMixer<Real>(anderson_depth, mixed_moments, share));
  IterationResult<Real>& result = state.result;
  result.radiance = share != nullptr ? share->own_cells<Real>(float16_unit(system, options))
                                     : AngularField<Real>(system.ordinates.size(), n, float16_unit(system, options));
  result.moments.assign(low_moments * n, Real(0));
  if (system.slopes && guess.slopes) {
    result.slopes = std::move(guess.slopes);
    state.slope_sweeps = sweeps_with_new_slopes;
  } else if (system.slopes) {
    result.slopes = share != nullptr ? LightSlopes<Real>{} : system.slopes->none(n);
  }
  IterationReport& report = result.report;
  const bool restored = checkpoints != nullptr && restore_state(system, options, state, *checkpoints);
  if (state.done) {
    drop_unfitted_slopes(result);
    return std::move(result);
  }

  std::optional<LowOrderCorrection<Real>> low_order;
  double step_per_change = 0;  // of the sweep before; 0: unknown
  std::vector<Real>&x = state.x, &change = state.change;
  std::vector<Real> g(low_moments * n);
  const double energy_tolerance = result.radiance.packed()
                                      ? std::max(options.energy_tolerance, float16_energy_tolerance)
                                      : std::max(options.energy_tolerance, rounding_of_emission(system));
  const std::size_t mixed = mixed_moments * n;
  const double rounding = rounding_of(result.radiance);
  {
    const Stopwatch watch(report.seconds_acceleration);
    low_order.emplace(system, options.tolerance < coarse_solve ? correction_tolerance : coarse_correction_tolerance,
                      share);
    if (StepWatch::of(state.steps, rounding, state.slopes_from, sweeps_with_new_slopes).diverges)
      low_order->drop_diffusion();
    if (guess.is_given) {
      x = std::move(guess.moments);
      change = x;
      state.nearly_done = true;
    } else if (!restored) {
      x.assign(low_moments * n, Real(0));
      if (!system.beam.source.empty() || system.thermal) {
        low_order->guess(x);
        change = x;
      }
    }
  }

  for (;;) {
    ++report.sweeps;
    const bool record = state.nearly_done || report.sweeps == options.max_sweeps;
    {
      const Stopwatch watch(report.seconds_scattering);
      system.scatter(result.radiance, change, state.dark);
      state.dark = false;
    }
    {
      const Stopwatch watch(report.seconds_sweeps);
      if (result.slopes) result.slopes->frozen = !state.finds_slopes;
      LightSlopes<Real>* const slopes = result.slopes ? &*result.slopes : nullptr;
      if (share != nullptr) share->to_rows(result.radiance);
      {
        SweepWorkspace<Real> work;  // not kept: the low-order problem needs memory in its turn
        result.fluxes = sweep(system, result.radiance, record, work, slopes, share);
      }
      if (share != nullptr) share->to_cells(result.radiance);
      system.moments(result.radiance, result.moments);
      if (share != nullptr && state.finds_slopes && slopes != nullptr)
        finish_slopes(system, *share, result.radiance, *slopes);
      // A checkpoint has them for views of a later run.
      if (slopes != nullptr && !system.keeps_radiance_slopes && checkpoints == nullptr) slopes->of_radiance = {};
    }
    const std::span<const Real> scalar_flux = std::span<const Real>(result.moments).first(n);
    if (share != nullptr) {
      std::vector<Real> of_all(all);
      share->gather_cells(scalar_flux, std::span(of_all));
      result.ledger = ledger_of<Real>(system, result.fluxes, of_all);
    } else {
      result.ledger = ledger_of<Real>(system, result.fluxes, scalar_flux);
    }

    const double imbalance = std::abs(result.ledger.residual);
    {
      const Stopwatch watch(report.seconds_acceleration);
      change.resize(low_moments * n);
#pragma omp parallel for simd schedule(static)
      for (std::size_t c = 0; c < change.size(); ++c) change[c] = result.moments[c] - x[c];
      const auto size_of_change = [&](const std::vector<Real>& moments) {
        return relative_size<Real>(std::span<const Real>(change).first(n), std::span<const Real>(moments).first(n),
                                   share);
      };
      // A coarse solve does without the correction of its last sweep. Its step is predicted: from one sweep to the next
      // it is taken as proportional to the change before the correction.
      const bool is_coarse = options.tolerance >= coarse_solve && checkpoints == nullptr;
      const double uncorrected = is_coarse ? size_of_change(result.moments) : 0;
      state.steps.push_back(step_per_change * uncorrected);
      const bool is_last = is_coarse && record && step_per_change > 0 && imbalance <= energy_tolerance &&
                           (!result.slopes || state.slope_sweeps >= sweeps_with_new_slopes) &&
                           estimated_error(state.steps) <= options.tolerance;
      if (!is_last) {
        low_order->correct(change, g);
#pragma omp parallel for simd schedule(static)
        for (std::size_t c = 0; c < change.size(); ++c) {
          g[c] += result.moments[c];
          change[c] = g[c] - x[c];
        }
        state.steps.back() = size_of_change(g);
        step_per_change = uncorrected > 0 ? state.steps.back() / uncorrected : 0;
      }
    }
    report.estimated_error = estimated_error(state.steps);
    check_finite(report, result.ledger);
    const StepWatch steps = StepWatch::of(state.steps, rounding, state.slopes_from, sweeps_with_new_slopes);
    if (state.finds_slopes) ++state.slope_sweeps;
    if (state.slope_sweeps > 0 && state.steps.back() > largest_step_of_slopes &&
        report.sweeps <= last_sweep_to_find_slopes_again)
      drop_slopes(state);
    state.finds_slopes = result.slopes && state.slope_sweeps < sweeps_with_new_slopes &&
                         (state.slope_sweeps > 0 || report.estimated_error < error_before_own_slopes);
    if (state.finds_slopes && state.slope_sweeps == 0) state.slopes_from = static_cast<int>(state.steps.size());
    const bool has_slopes = !result.slopes || state.slope_sweeps >= sweeps_with_new_slopes;
    if (progress) progress(report.sweeps, report.estimated_error, result.ledger.residual);

    const bool within_tolerance =
        has_slopes && report.estimated_error <= options.tolerance && imbalance <= energy_tolerance;
    if (!within_tolerance && (steps.stuck || report.sweeps >= options.max_sweeps))
      check_meaningful(report, result.ledger, steps.stuck ? state.steps.back() : 0);
    if (record && (within_tolerance || steps.stuck || report.sweeps >= options.max_sweeps)) {
      report.converged = within_tolerance;
      report.stalled = steps.stuck && !within_tolerance;
      state.done = true;
      break;
    }
    // Recording costs a little of a sweep; a sweep within tolerance that was not recorded costs another.
    state.nearly_done = steps.stuck || (has_slopes && report.estimated_error <= 100 * options.tolerance &&
                                        imbalance <= 100 * energy_tolerance);
    {
      const Stopwatch watch(report.seconds_acceleration);
      if (state.finds_slopes) state.mixer.history() = {};
      if (steps.restart_now) {
        state.mixer.history() = {};
        drop_slopes(state);
        if (steps.diverges) low_order->drop_diffusion();
      }
      state.mixer.advance(std::span(x).first(mixed), std::span<const Real>(g).first(mixed));
      std::copy(g.begin() + static_cast<std::ptrdiff_t>(mixed), g.end(),
                x.begin() + static_cast<std::ptrdiff_t>(mixed));
#pragma omp parallel for simd schedule(static)
      for (std::size_t c = 0; c < change.size(); ++c) change[c] = x[c] - result.moments[c];
    }
    if (checkpoints != nullptr && checkpoints->due()) save_state(system, state, *checkpoints);
  }
  drop_unfitted_slopes(result);
  if (checkpoints != nullptr) save_state(system, state, *checkpoints);
  return std::move(result);
}

template IterationResult<float> iterate_source<float>(const TransportSystem<float>&, const IterationOptions&,
                                                      const IterationCallback&, Checkpoints*, const OrdinateShare*,
                                                      FirstGuess<float>);
template IterationResult<double> iterate_source<double>(const TransportSystem<double>&, const IterationOptions&,
                                                        const IterationCallback&, Checkpoints*, const OrdinateShare*,
                                                        FirstGuess<double>);

}  // namespace cloudbow
