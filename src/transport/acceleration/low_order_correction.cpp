#include "transport/acceleration/low_order_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cloudbow/core/thread_scope.hpp"
#include "transport/acceleration/anderson.hpp"
#include "transport/acceleration/diffusion_correction.hpp"
#include "transport/grid/threads.hpp"

namespace cloudbow {
namespace {

// Enough for the moments l <= 2; fewer azimuths lose one of them, and the correction with it.
constexpr const char* low_directions = "double-gauss-4x8";
constexpr int low_mixing_depth = 5;
constexpr std::size_t low_mixed_moments = 4;  // l <= 1
constexpr int most_low_sweeps = 12;
// Below this transport optical depth diffusion does not pay: light leaves within the few sweeps that are needed anyway.
constexpr double thin_for_diffusion = 2.5;

// [p] low_moments x low_moments: moments of the source from moments of the radiance.
template <class Real>
std::vector<Eigen::MatrixXd> scattered_moments(const TransportSystem<Real>& full) {
  const LowMoments<double> low(full.ordinates);
  std::vector<Eigen::MatrixXd> moments;
  for (const DenseMatrix<Real>& matrix : full.scattering.matrix())
    moments.push_back(low.weights * matrix.template cast<double>() * low.shape);
  return moments;
}

template <class Real>
TransportSystem<Real> low_order_system(const TransportSystem<Real>& full,
                                       const std::optional<Coarsening<Real>>& coarse) {
  const BoxGrid& box = coarse ? coarse->grid.box : full.box;
  const OrdinateSet ordinates = make_ordinate_set(low_directions);
  const std::vector<double> truncated(full.scattering.matrix().size(), 0.);  // coarse coefficients are so already
  const auto cells =
      coarse
          ? std::make_shared<const Cells<Real>>(make_cells<Real>(coarse->grid, truncated, full.independent_columns, 0))
          : full.cells;
  const LowMoments<double> low(ordinates);
  std::vector<DenseMatrix<Real>> matrix;
  for (const Eigen::MatrixXd& moments : scattered_moments(full))
    matrix.push_back((low.shape * moments * low.weights).template cast<Real>());
  Surface mean_surface;
  mean_surface.albedo = full.ground.mean_albedo();
  const bool same_ground = full.ground.is_lambertian() && !coarse;
  return {
      .box = box,
      .independent_columns = full.independent_columns,
      .cells = cells,
      .ordinates = ordinates,
      .paths = make_ordinate_paths(box, *cells, ordinates.direction, full.independent_columns, ThickVoxels::cheapest),
      // A correction need not be finer if there are many cells.
      .linear_source = full.linear_source && !full.cells->heterogeneous,
      .scattering = OrdinateScattering<Real>(ordinates, std::move(matrix)),
      .truncated_asymmetry = full.truncated_asymmetry,
      .absorption = coarse ? coarse->grid.absorption : full.absorption,
      .beam = {},
      // Corrections are differences of light: they contain no emission.
      .ground = same_ground ? full.ground.without_emission() : Ground<Real>(mean_surface, ordinates, std::nullopt),
      .side_radiance = {},
      .emission = std::vector<Real>(low_moments * cells->size())};
}

}  // namespace

template <class Real>
LowOrderCorrection<Real>::LowOrderCorrection(const TransportSystem<Real>& system, double tolerance,
                                             const OrdinateShare* share)
    : coarse_(coarsen(system)),
      low_(low_order_system(system, coarse_)),
      full_(&system),
      share_(share),
      tolerance_(tolerance) {
  const LowMoments<double> full(system.ordinates);
  for (const Eigen::MatrixXd& moments : scattered_moments(system))
    scattered_moments_.push_back(moments.template cast<Real>());
  for (const BeamSource<Real>& beam : system.beam.source) {
    const Eigen::VectorXd moments = full.weights * beam.direction.template cast<double>();
    for (const double m : moments) beam_moments_.push_back(static_cast<Real>(m));
  }
  if (system.thermal) {
    Surface surface;
    surface.albedo = system.ground.mean_albedo();
    surface.planck = system.ground.mean_planck();
    guess_ground_ =
        system.ground.is_lambertian() && !coarse_ ? system.ground : Ground<Real>(surface, low_.ordinates, std::nullopt);
  }
  if (transport_depth(system) > thin_for_diffusion) diffusion_ = std::make_unique<DiffusionCorrection<Real>>(low_);
}

template <class Real>
LowOrderCorrection<Real>::~LowOrderCorrection() = default;
template <class Real>
LowOrderCorrection<Real>::LowOrderCorrection(LowOrderCorrection&&) noexcept = default;
template <class Real>
LowOrderCorrection<Real>& LowOrderCorrection<Real>::operator=(LowOrderCorrection&&) noexcept = default;

template <class Real>
bool LowOrderCorrection<Real>::uses_diffusion() const {
  return diffusion_ != nullptr;
}

template <class Real>
void LowOrderCorrection<Real>::drop_diffusion() {
  diffusion_.reset();
}

template <class Real>
CellRange LowOrderCorrection<Real>::own_cells() const {
  return share_ != nullptr ? share_->range() : CellRange{0, full_->cells->size()};
}

// Fills low_.emission. @param source [low_moments][own cells] of the problem
template <class Real>
void LowOrderCorrection<Real>::emit(std::span<const Real> source) {
  const std::size_t own = own_cells().size();
  if (share_ == nullptr) {
    // Nothing throws here.
#pragma omp parallel for schedule(static)
    for (int m = 0; m < low_moments; ++m) emit_moment(m, source.data() + m * own);
    return;
  }
  std::vector<Real> all(full_->cells->size());
  for (int m = 0; m < low_moments; ++m) {
    share_->gather_cells(source.subspan(m * own, own), std::span(all));
    emit_moment(m, all.data());
  }
}

// @param source [n] of the problem's cells
template <class Real>
void LowOrderCorrection<Real>::emit_moment(int moment, const Real* source) {
  const std::size_t n = low_.cells->size();
  Real* const emission = low_.emission.data() + moment * n;
  if (!coarse_) {
    std::copy_n(source, n, emission);
    return;
  }
  std::fill_n(emission, n, Real(0));
  const std::size_t cells = full_->cells->size();
  for (std::size_t c = 0; c < cells; ++c) emission[coarse_->coarse_cell[c]] += coarse_->share[c] * source[c];
}

template <class Real>
void LowOrderCorrection<Real>::guess(std::span<Real> moments) {
  const CellRange own = own_cells();
  // Nothing throws here.
#pragma omp parallel for schedule(static)
  for (int m = 0; m < low_moments; ++m) {
    Real* __restrict const source = moments.data() + m * own.size();
    std::fill_n(source, own.size(), Real(0));
    for (std::size_t b = 0; b < full_->beam.source.size(); ++b) {
      const Real share = beam_moments_[b * low_moments + m];
      const Real* __restrict const intensity = full_->beam.source[b].intensity.data() + own.first;
      for (std::size_t c = 0; c < own.size(); ++c) source[c] += share * intensity[c];
    }
    if (!full_->thermal || m > 0) continue;
    for (std::size_t c = 0; c < own.size(); ++c) {
      const double planck = static_cast<double>(full_->planck[own.first + c]);
      if (planck > 0) source[c] += full_->emission[own.first + c] * static_cast<Real>(1 - full_->mean_planck / planck);
    }
  }
  emit(moments);
  if (!full_->thermal) {
    solve(moments);
    return;
  }
  // Light is found as its difference from the mean Planck radiance. That is small if matter and ground are nearly of
  // one temperature.
  const Ground<Real> ground = low_.ground;
  low_.sky_radiance = full_->sky_radiance - full_->mean_planck;
  low_.ground = guess_ground_.with_planck_less(full_->mean_planck);
  solve(moments);
  low_.sky_radiance = 0;
  low_.ground = ground;
  const Real reference = static_cast<Real>(4 * std::numbers::pi * full_->mean_planck);
  for (std::size_t c = 0; c < own.size(); ++c) moments[c] += reference;
}

template <class Real>
void LowOrderCorrection<Real>::correct(std::span<const Real> change, std::span<Real> correction) {
  const CellRange own = own_cells();
  // Nothing throws here.
#pragma omp parallel for schedule(static)
  for (int m = 0; m < low_moments; ++m) {
    Real* __restrict const source = correction.data() + m * own.size();
    std::fill_n(source, own.size(), Real(0));
    for (std::size_t p = 0; p < scattered_moments_.size(); ++p) {
      const Real* __restrict const scattered = full_->cells->scattered[p].data() + own.first;
      for (int from = 0; from < low_moments; ++from) {
        const Real share = scattered_moments_[p](m, from);
        if (std::abs(share) < Real(1e-6)) continue;
        const Real* __restrict const of = change.data() + from * own.size();
        for (std::size_t c = 0; c < own.size(); ++c) source[c] += share * scattered[c] * of[c];
      }
    }
  }
  emit(correction);
  solve(correction);
}

// Moments [low_moments][cells of low_] of the light of low_.emission. Its arrays are not kept: between two calls the
// sweeps of the problem itself need memory.
template <class Real>
std::vector<Real> LowOrderCorrection<Real>::iterate() {
  const std::size_t n = low_.cells->size();
  const std::size_t mixed = low_mixed_moments * n;
  const ThreadScope threads(threads_for(n, 0));
  AngularField<Real> radiance(low_.ordinates.size(), n);
  std::vector<Real> moments(low_moments * n);
  SweepWorkspace<Real> work;
  typename DiffusionCorrection<Real>::Workspace diffusion_work;
  AndersonMixer<Real> mixer(low_mixing_depth, low_mixed_moments);
  std::vector<Real> x(mixed, Real(0)), g(mixed), correction, change(mixed);
  for (int sweeps = 1;; ++sweeps) {
    low_.scatter(radiance, correction, sweeps == 1);
    sweep(low_, radiance, false, work);
    ++sweeps_;
    low_.moments(radiance, moments);
    g.assign(moments.begin(), moments.begin() + static_cast<std::ptrdiff_t>(mixed));
    if (diffusion_) {
      for (std::size_t i = 0; i < mixed; ++i) change[i] = g[i] - x[i];
      diffusion_->correct(change, g, diffusion_work);
    }
    for (std::size_t i = 0; i < mixed; ++i) change[i] = g[i] - x[i];
    const auto flux = [n](const std::vector<Real>& of) { return std::span<const Real>(of).first(n); };
    const double size = ordered_dot<Real>(flux(g), flux(g));
    const double step = ordered_dot<Real>(flux(change), flux(change));
    if (step <= tolerance_ * tolerance_ * size || sweeps == most_low_sweeps) break;
    mixer.advance(x, g);
    correction.resize(mixed);
    for (std::size_t i = 0; i < mixed; ++i) correction[i] = x[i] - moments[i];
  }
  std::copy(g.begin(), g.end(), moments.begin());
  return moments;
}

// Light of low_.emission, at the problem's own cells.
template <class Real>
void LowOrderCorrection<Real>::solve(std::span<Real> moments) {
  const std::vector<Real> coarse_moments = iterate();
  const std::size_t n = low_.cells->size();
  const CellRange own = own_cells();
  if (!coarse_) {
    for (std::size_t m = 0; m < low_moments; ++m)
      std::copy_n(coarse_moments.data() + m * n + own.first, own.size(), moments.data() + m * own.size());
    return;
  }
  // Between the centres of coarse cells the moments change linearly.
  const Cells<Real>& of = *low_.cells;
  // Nothing throws here.
#pragma omp parallel for schedule(static)
  for (int m = 0; m < low_moments; ++m) {
    const Real* const from = coarse_moments.data() + m * n;
    Real* const to = moments.data() + m * own.size();
    for (std::size_t c = own.first; c < own.last; ++c) {
      const std::uint32_t at = coarse_->coarse_cell[c];
      Real value = from[at];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        value += Real(.25) * static_cast<Real>(coarse_->quarters[c][axis]) * of.scale[axis][at] *
                 (from[of.high[axis][at]] - from[of.low[axis][at]]);
      }
      to[c - own.first] = value;
    }
  }
}

template class LowOrderCorrection<float>;
template class LowOrderCorrection<double>;

}  // namespace cloudbow
