#include "transport/acceleration/low_order_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cloudbow/core/parallel_errors.hpp"
#include "cloudbow/core/thread_scope.hpp"
#include "transport/acceleration/anderson.hpp"
#include "transport/acceleration/diffusion.hpp"
#include "transport/grid/threads.hpp"

namespace cloudbow {
namespace {

// Enough for the moments l <= 2; fewer azimuths lose one of them, and the correction with it.
constexpr const char* low_directions = "double-gauss-4x8";
constexpr int low_mixing_depth = 5;
// The correction is worth no more than its few directions are: it need not converge.
constexpr double low_tolerance = .1;
constexpr int most_low_sweeps = 12;
// Below this transport optical depth diffusion does not pay: light leaves within the few sweeps that are needed anyway.
constexpr double thin_for_diffusion = 2.5;
// Least optical depth for transport scattering along longest_free_path() of the levels at the top and bottom of its
// box.
constexpr double least_to_diffuse = .1;
// Optical depth of a cell beyond which its current is not corrected: light hardly crosses it within a sweep, and the
// correction would overshoot.
constexpr double thick_for_currents = 50;

}  // namespace

// Diffusion correction of scalar flux and current, on the levels that diffuse light.
template <class Real>
class LowOrderCorrection<Real>::Diffusion {
 public:
  Diffusion(const TransportSystem<Real>& system, const LevelRange& levels)
      : independent_columns_(system.independent_columns),
        box_(system.box),
        all_(system.cells->size()),
        first_(system.cells->rows.level_cell[levels.first]) {
    const std::size_t columns = box_.columns();
    const std::uint32_t last = system.cells->rows.level_cell[levels.last];
    for_each_place(system.cells->rows, [&](std::uint32_t cell, std::size_t place) {
      if (cell < first_ || cell >= last) return;
      dense_.push_back(static_cast<std::uint32_t>(place - static_cast<std::size_t>(levels.first) * columns));
      cell_.push_back(cell);
      share_.push_back(1 / system.cells->rows.places_of(cell));
    });
    box_.z_edge_m.assign(system.box.z_edge_m.begin() + levels.first, system.box.z_edge_m.begin() + levels.last + 1);
    const std::size_t places = columns * static_cast<std::size_t>(box_.nz());
    DiffusionCoefficients given;
    given.extinction.assign(places, 0.F);
    given.transport.assign(places, 0.F);
    given.absorption.assign(places, 0.F);
    given.surface_albedo = system.ground.mean_albedo();
    given.independent_columns = independent_columns_;
    const std::size_t n = dense_.size();
    power_.resize(n);
    forward_.resize(n);
    current_share_.resize(n);
    for (std::size_t c = 0; c < n; ++c) {
      const int level = static_cast<int>(dense_[c] / columns);
      const double extinction = static_cast<double>(system.cells->extinction[cell_[c]]);
      const double absorption = system.absorption[cell_[c]];
      double scattering = 0;
      double forward = 0;
      for (std::size_t p = 0; p < system.cells->scattered.size(); ++p) {
        const double share = static_cast<double>(system.cells->scattered[p][cell_[c]]) * extinction;
        scattering += share;
        forward += share * system.truncated_asymmetry[p];
      }
      const double transport = absorption + scattering - forward;
      given.extinction[dense_[c]] = static_cast<float>(extinction);
      given.transport[dense_[c]] = static_cast<float>(transport);
      given.absorption[dense_[c]] = static_cast<float>(absorption);
      power_[c] = scattering * box_.dx_m * box_.dy_m * box_.thickness_m(level);
      const double thickness = extinction * box_.thickness_m(level) / thick_for_currents;
      current_share_[c] = 1 / (1 + thickness * thickness);
      forward_[c] = forward;
    }
    operator_.emplace(box_, given);
    for (std::size_t c = 0; c < n; ++c)
      forward_[c] *= 3 * std::min(operator_->free_diffusivity(dense_[c]), 1e30) * current_share_[c];
    source_.resize(places);
    correction_.resize(places);
    for (auto& flow : flow_) flow.resize(places);
  }

  // moments += diffusive response to the change of scalar flux and current in one sweep.
  void correct(std::span<const Real> change, std::span<Real> moments) {
    const std::size_t n = dense_.size();
    std::fill(source_.begin(), source_.end(), 0.);
    for (auto& flow : flow_) std::fill(flow.begin(), flow.end(), 0.);
    for (std::size_t c = 0; c < n; ++c) {
      source_[dense_[c]] = power_[c] * static_cast<double>(change[cell_[c]]);
      for (std::size_t axis = 0; axis < 3; ++axis)
        flow_[axis][dense_[c]] =
            forward_[c] * static_cast<double>(change[(axis + 1) * all_ + cell_[c]]) / std::sqrt(3.);
    }
    diverge();
    operator_->solve(source_, correction_);
    const std::size_t columns = box_.columns();
    for (std::size_t c = 0; c < n; ++c) {
      const std::size_t at = dense_[c];
      const int i = static_cast<int>(at % box_.nx);
      const int j = static_cast<int>(at / box_.nx % box_.ny);
      const int k = static_cast<int>(at / columns);
      moments[cell_[c]] += static_cast<Real>(share_[c] * correction_[at]);
      const double slide = current_share_[c] * operator_->diffusivity(at);
      const auto add = [&](std::size_t axis, double gradient) {
        moments[(axis + 1) * all_ + cell_[c]] +=
            static_cast<Real>(share_[c] * std::sqrt(3.) * (flow_[axis][at] - slide * gradient));
      };
      const auto across = [&](int position, int count, std::size_t stride, double width) {
        const bool seam = box_.periodic;
        const std::size_t high = position + 1 < count ? at + stride
                                 : seam               ? at - stride * static_cast<std::size_t>(count - 1)
                                                      : at;
        const std::size_t low = position > 0 ? at - stride
                                : seam       ? at + stride * static_cast<std::size_t>(count - 1)
                                             : at;
        return (correction_[high] - correction_[low]) / (2 * width);
      };
      if (!independent_columns_ && box_.nx > 1) add(0, across(i, box_.nx, 1, box_.dx_m));
      if (!independent_columns_ && box_.ny > 1)
        add(1, across(j, box_.ny, static_cast<std::size_t>(box_.nx), box_.dy_m));
      // At the ends about half the flux is left on the face, half a cell away.
      const bool last = k + 1 == box_.nz();
      const double above = last ? correction_[at] / 2 : correction_[at + columns];
      const double below = k == 0 ? correction_[at] / 2 : correction_[at - columns];
      const double distance = last || k == 0 ? 1.5 : 2;
      add(2, (above - below) / (distance * box_.thickness_m(k)));
    }
  }

 private:
  // source -= divergence of the flow, through faces.
  void diverge() {
    const std::size_t columns = box_.columns();
    for (int k = 0; k < box_.nz(); ++k) {
      const double dz = box_.thickness_m(k);
      for (int j = 0; j < box_.ny; ++j) {
        for (int i = 0; i < box_.nx; ++i) {
          const std::size_t at = (static_cast<std::size_t>(k) * box_.ny + j) * box_.nx + i;
          const auto face = [&](std::size_t axis, std::size_t other, double area) {
            const double through = (flow_[axis][at] + flow_[axis][other]) / 2 * area;
            source_[at] -= through;
            source_[other] += through;
          };
          if (!independent_columns_ && box_.nx > 1 && (box_.periodic || i + 1 < box_.nx))
            face(0, at - i + (i + 1) % box_.nx, box_.dy_m * dz);
          if (!independent_columns_ && box_.ny > 1 && (box_.periodic || j + 1 < box_.ny)) {
            const std::size_t level = static_cast<std::size_t>(k) * columns;
            face(1, level + static_cast<std::size_t>((j + 1) % box_.ny) * box_.nx + i, box_.dx_m * dz);
          }
          if (k + 1 < box_.nz()) face(2, at + columns, box_.dx_m * box_.dy_m);
        }
      }
    }
  }

  bool independent_columns_;
  BoxGrid box_;
  std::size_t all_;                   // cells of the system
  std::size_t first_;                 // of them, the first in the box
  std::vector<std::uint32_t> dense_;  // [n] index in the box of each voxel with matter,
  std::vector<std::uint32_t> cell_;   // [n] its cell,
  std::vector<double> share_;         // [n] and its share of the cell's voxels
  std::optional<DiffusionOperator> operator_;
  std::vector<double> power_;          // [n] scattered power per scalar flux
  std::vector<double> forward_;        // [n] current that a change of the current leads to
  std::vector<double> current_share_;  // [n] of the correction of the current that is made
  std::vector<double> source_;         // [places]
  std::vector<double> correction_;     // [places]
  std::array<std::vector<double>, 3> flow_;
};

namespace {

// Part of the extinction of a cell that scatters light out of its direction, 1/m.
template <class Real>
double transport_scattering(const TransportSystem<Real>& system, std::size_t cell) {
  double share = 0;
  for (std::size_t p = 0; p < system.cells->scattered.size(); ++p)
    share += static_cast<double>(system.cells->scattered[p][cell]) * (1 - system.truncated_asymmetry[p]);
  return share * static_cast<double>(system.cells->extinction[cell]);
}

// Of scattering alone: absorption leaves few orders of scattering. Mean over the columns, each weighted with its own:
// clear columns do not count, nor columns of thin air alone.
template <class Real>
double transport_depth(const TransportSystem<Real>& system) {
  const std::size_t columns = system.box.columns();
  std::vector<double> depth(columns, 0.);
  for_each_place(system.cells->rows, [&](std::uint32_t c, std::size_t place) {
    depth[place % columns] +=
        transport_scattering(system, c) * system.box.thickness_m(static_cast<int>(place / columns));
  });
  double sum = 0, weighted = 0;
  for (const double d : depth) {
    sum += d;
    weighted += d * d;
  }
  return sum > 0 ? weighted / sum : 0;
}

// From the lowest to the highest level in which light diffuses. Above and below them light leaves freely. Diffusivity
// has a limit: in the box of the diffusion problem such levels would scatter light back, and the iteration diverges.
template <class Real>
LevelRange diffusing_levels(const TransportSystem<Real>& system) {
  const BoxGrid& box = system.box;
  const std::vector<std::uint32_t>& level_cell = system.cells->rows.level_cell;
  std::vector<double> most(box.nz(), 0.);
  for (int k = 0; k < box.nz(); ++k)
    for (std::size_t c = level_cell[k]; c < level_cell[k + 1]; ++c)
      most[k] = std::max(most[k], transport_scattering(system, c));
  // Without levels that count, the range stays.
  const auto trimmed = [](LevelRange levels, const auto& counts) {
    LevelRange inner = levels;
    while (inner.first < inner.last && !counts(inner.first)) ++inner.first;
    while (inner.first < inner.last && !counts(inner.last - 1)) --inner.last;
    return inner.first < inner.last ? inner : levels;
  };
  LevelRange levels = trimmed({0, box.nz()}, [&](int k) { return most[k] > 0; });
  for (int before = 0; before != levels.last - levels.first;) {
    before = levels.last - levels.first;
    const double depth = box.z_edge_m[levels.last] - box.z_edge_m[levels.first];
    levels = trimmed(levels, [&](int k) { return most[k] * longest_free_path(box, k, depth) >= least_to_diffuse; });
  }
  return levels;
}

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
  return {.box = box,
          .independent_columns = full.independent_columns,
          .cells = cells,
          .ordinates = ordinates,
          .paths = make_ordinate_paths(box, *cells, ordinates.direction, full.independent_columns),
          // A correction need not be finer if there are many cells.
          .linear_source = full.linear_source && !full.cells->heterogeneous,
          .scattering = OrdinateScattering<Real>(ordinates, std::move(matrix)),
          .truncated_asymmetry = full.truncated_asymmetry,
          .absorption = coarse ? std::vector<double>(coarse->grid.absorption.begin(), coarse->grid.absorption.end())
                               : full.absorption,
          .beam = {},
          // Corrections are differences of light: they contain no emission.
          .ground = same_ground ? full.ground.without_emission() : Ground<Real>(mean_surface, ordinates, std::nullopt),
          .side_radiance = {},
          .emission = std::vector<Real>(low_moments * cells->size())};
}

}  // namespace

template <class Real>
LowOrderCorrection<Real>::LowOrderCorrection(const TransportSystem<Real>& system)
    : coarse_(coarsen(system)), low_(low_order_system(system, coarse_)), full_(&system) {
  const LowMoments<double> full(system.ordinates);
  for (const Eigen::MatrixXd& moments : scattered_moments(system))
    scattered_moments_.push_back(moments.template cast<Real>());
  for (const BeamSource<Real>& beam : system.beam.source) {
    const Eigen::VectorXd moments = full.weights * beam.direction.template cast<double>();
    for (const double m : moments) beam_moments_.push_back(static_cast<Real>(m));
  }
  moments_.resize(low_.emission.size());
  if (system.thermal) {
    Surface surface;
    surface.albedo = system.ground.mean_albedo();
    surface.planck = system.ground.mean_planck();
    guess_ground_ =
        system.ground.is_lambertian() && !coarse_ ? system.ground : Ground<Real>(surface, low_.ordinates, std::nullopt);
  }
  radiance_ = AngularField<Real>(low_.ordinates.size(), low_.cells->size());
  if (transport_depth(system) > thin_for_diffusion)
    diffusion_ = std::make_unique<Diffusion>(low_, diffusing_levels(low_));
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

// Fills one moment of low_.emission: source(to) adds it to [n] values of the problem's own cells.
template <class Real>
template <class Source>
void LowOrderCorrection<Real>::emit(int moment, const Source& source) {
  const std::size_t n = low_.cells->size();
  Real* const emission = low_.emission.data() + moment * n;
  std::fill_n(emission, n, Real(0));
  if (!coarse_) {
    source(emission);
    return;
  }
  std::vector<Real> of_cell(full_->cells->size(), Real(0));
  source(of_cell.data());
  for (std::size_t c = 0; c < of_cell.size(); ++c) emission[coarse_->coarse_cell[c]] += coarse_->share[c] * of_cell[c];
}

template <class Real>
void LowOrderCorrection<Real>::guess(std::span<Real> moments) {
  const std::size_t n = full_->cells->size();
  ParallelErrors errors;
#pragma omp parallel for schedule(static)
  for (int m = 0; m < low_moments; ++m) {
    errors.run([&] {
      emit(m, [&](Real* __restrict source) {
        for (std::size_t b = 0; b < full_->beam.source.size(); ++b) {
          const Real share = beam_moments_[b * low_moments + m];
          const Real* __restrict const intensity = full_->beam.source[b].intensity.data();
          for (std::size_t c = 0; c < n; ++c) source[c] += share * intensity[c];
        }
        if (!full_->thermal || m > 0) return;
        for (std::size_t c = 0; c < n; ++c) {
          const double planck = full_->planck[c];
          if (planck > 0) source[c] += full_->emission[c] * static_cast<Real>(1 - full_->mean_planck / planck);
        }
      });
    });
  }
  errors.rethrow();
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
  for (std::size_t c = 0; c < n; ++c) moments[c] += reference;
}

template <class Real>
void LowOrderCorrection<Real>::correct(std::span<const Real> change, std::span<Real> correction) {
  const std::size_t n = full_->cells->size();
  ParallelErrors errors;
#pragma omp parallel for schedule(static)
  for (int m = 0; m < low_moments; ++m) {
    errors.run([&] {
      emit(m, [&](Real* __restrict source) {
        for (std::size_t p = 0; p < scattered_moments_.size(); ++p) {
          const Real* __restrict const scattered = full_->cells->scattered[p].data();
          for (int from = 0; from < low_moments; ++from) {
            const Real share = scattered_moments_[p](m, from);
            if (std::abs(share) < Real(1e-6)) continue;
            const Real* __restrict const of = change.data() + from * n;
            for (std::size_t c = 0; c < n; ++c) source[c] += share * scattered[c] * of[c];
          }
        }
      });
    });
  }
  errors.rethrow();
  solve(correction);
}

// Light of low_.emission, in moments_.
template <class Real>
void LowOrderCorrection<Real>::iterate() {
  const std::size_t n = low_.cells->size();
  const std::size_t mixed = 4 * n;  // the moments l <= 1
  const ThreadScope threads(threads_for(n, 0));
  AndersonMixer<Real> mixer(low_mixing_depth);
  std::vector<Real> x(mixed, Real(0)), g(mixed), correction, change(mixed);
  for (int sweeps = 1;; ++sweeps) {
    low_.scatter(radiance_, correction, sweeps == 1);
    sweep(low_, radiance_, false, work_);
    ++sweeps_;
    low_.moments(radiance_, moments_);
    g.assign(moments_.begin(), moments_.begin() + static_cast<std::ptrdiff_t>(mixed));
    if (diffusion_) {
      for (std::size_t i = 0; i < mixed; ++i) change[i] = g[i] - x[i];
      diffusion_->correct(change, g);
    }
    for (std::size_t i = 0; i < mixed; ++i) change[i] = g[i] - x[i];
    const auto flux = [n](const std::vector<Real>& of) { return std::span<const Real>(of).first(n); };
    const double size = ordered_dot<Real>(flux(g), flux(g));
    const double step = ordered_dot<Real>(flux(change), flux(change));
    if (step <= low_tolerance * low_tolerance * size || sweeps == most_low_sweeps) break;
    mixer.advance(x, g);
    correction.resize(mixed);
    for (std::size_t i = 0; i < mixed; ++i) correction[i] = x[i] - moments_[i];
  }
  std::copy(g.begin(), g.end(), moments_.begin());
}

// Light of low_.emission, at the problem's own cells.
template <class Real>
void LowOrderCorrection<Real>::solve(std::span<Real> moments) {
  iterate();
  if (!coarse_) {
    std::copy(moments_.begin(), moments_.end(), moments.begin());
    return;
  }
  // Between the centres of coarse cells the moments change linearly.
  const std::size_t n = low_.cells->size();
  const std::size_t cells = full_->cells->size();
  const Cells<Real>& of = *low_.cells;
  // Nothing throws here.
#pragma omp parallel for schedule(static)
  for (int m = 0; m < low_moments; ++m) {
    const Real* const from = moments_.data() + m * n;
    Real* const to = moments.data() + m * cells;
    for (std::size_t c = 0; c < cells; ++c) {
      const std::uint32_t at = coarse_->coarse_cell[c];
      Real value = from[at];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        value += Real(.25) * static_cast<Real>(coarse_->quarters[c][axis]) * of.scale[axis][at] *
                 (from[of.high[axis][at]] - from[of.low[axis][at]]);
      }
      to[c] = value;
    }
  }
}

template class LowOrderCorrection<float>;
template class LowOrderCorrection<double>;

}  // namespace cloudbow
