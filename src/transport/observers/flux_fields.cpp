#include "transport/observers/flux_fields.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "cloudbow/core/not_negative.hpp"
#include "transport/iteration/source_iteration.hpp"

namespace cloudbow {
namespace {

// The largest change of scale of a gathered field, relative to its difference from the reference.
constexpr double largest_correction = .2;

double mean(const std::vector<double>& field) {
  double sum = 0;
  for (const double f : field) sum += f;
  return sum / static_cast<double>(field.size());
}

std::optional<Direction> sun_direction(const Problem& problem) {
  if (!problem.sun) return std::nullopt;
  return problem.sun->travel;
}

std::vector<GatherDirection> downward_directions(const Problem& problem, const SolverOptions& options) {
  return gather_directions(options.gather_directions, false, sun_direction(problem));
}

// With open sides the mean flux up at the top is that of the gather. The spiral alone then errs by .02 %, with more
// directions about a sun at 80 degrees by .24 %.
std::vector<GatherDirection> upward_directions(const Problem& problem, const SolverOptions& options) {
  return gather_directions(options.gather_directions, true,
                           problem.grid.box.periodic ? sun_direction(problem) : std::nullopt);
}

// Fluxes of one interface, column by column.
struct LevelFlux {
  std::vector<double> up;
  std::vector<double> down;     // diffuse apart from the light of the iteration's direct beam
  std::vector<double> carried;  // of that, the part that is not direct
};

template <class Real>
class FluxFields {
 public:
  FluxFields(const ConvergedField<Real>& field, DirectionalSource<Real>* source, const ProgressCallback& progress)
      : problem_(field.problem),
        options_(field.options),
        system_(field.system),
        solved_(field.result),
        progress_(progress),
        source_(source),
        share_(field.share),
        columns_(field.system.box.columns()),
        reference_(field.system.mean_planck) {
    const Discretisation& discretisation = field.discretisation;
    const LateralBoundary* const lateral_boundary = field.lateral_boundary;
    const bool by_ordinates = source == nullptr;
    if (problem_.sun) {
      const bool peaked = !by_ordinates && std::any_of(discretisation.peak.begin(), discretisation.peak.end(),
                                                       [](const ForwardPeak& peak) { return peak.share() > 0; });
      if (is_first()) {
        true_beam_ = beam(std::vector<double>(problem_.phase.size(), 0.), false);
        carried_beam_ = beam(discretisation.beam_fraction(), false);
      }
      if (peaked) set_peak(discretisation);
    }
    if (!by_ordinates) {
      set_first_order_beside_peak(problem_, discretisation, system_, *source_);
      if (lateral_boundary != nullptr)
        side_radiance_ = [lateral_boundary](const Direction& travel) {
          return lateral_boundary->radiance_beside_peak(travel);
        };
    }
  }

  void fill(Solution& solution) {
    if (is_first()) fill_profiles(solution);
    solution.flux_level = flux_levels(system_.box, options_);
    if (source_) gather_ends(solution);
    if (source_) gather_inner(solution);
    if (!is_first()) return;
    for (auto* field : {&solution.upwelling_flux, &solution.downwelling_diffuse_flux, &solution.direct_flux}) {
      field->reserve(columns_ * solution.flux_level.size());
    }
    for (const int edge : solution.flux_level) {
      LevelFlux flux;
      if (problem_.sun) {
        flux.carried = at_edge(*carried_beam_, edge);
        const std::span<const double> direct = true_beam_->flux_at(edge);
        for (std::size_t c = 0; c < columns_; ++c) flux.carried[c] -= direct[c];
      }
      if (!source_) {
        flux.up = slice(solved_.fluxes.column_up, edge);
        flux.down = slice(solved_.fluxes.column_down, edge);
      } else {
        set_plane(edge, solution, flux);
      }
      append(solution, edge, flux);
    }
  }

 private:
  // Whether this rank makes the fluxes; the others take part in the gather.
  bool is_first() const { return share_ == nullptr || share_->is_first(); }

  // Its fluxes are those of the ground and of the requested levels, at the first rank.
  DirectBeam<Real> beam(const std::vector<double>& forward_fraction, bool irradiance) const {
    std::vector<int> levels;
    if (is_first()) {
      levels = flux_levels(system_.box, options_);
      levels.push_back(0);
    }
    return beam_with<Real>(problem_, system_.cells->rows, forward_fraction, options_, {irradiance, false, levels});
  }

  // Light that the iteration's direct beam carries and the sharp one does not has been scattered within the forward
  // peak: once, as it is taken here, after which it goes as far as the iteration's beam.
  void set_peak(const Discretisation& discretisation) {
    sharp_beam_ = beam(discretisation.gather_fraction(), true);
    carried_extinction_ = scaled_extinction<Real>(problem_.grid, discretisation.beam_fraction());
    carried_extinction_.resize(carried_extinction_.size() + lane_padding);
    peak_source_.emplace(DirectionalSource<Real>{discretisation.points, {}, problem_.sun->travel, {}});
    std::vector<double> scattering;
    for (std::size_t p = 0; p < problem_.phase.size(); ++p) {
      const ForwardPeak& peak = discretisation.peak[p];
      scattering.push_back(std::accumulate(problem_.grid.scattering[p].begin(), problem_.grid.scattering[p].end(), 0.));
      if (peak.share() == 0) continue;
      add_single_scattering<Real>(
          peak_source_->first_order, [peak](double cos_angle) { return peak.peak(cos_angle); },
          problem_.grid.scattering[p], 1., carried_extinction_, sharp_beam_->irradiance);
    }
    if (peak_source_->first_order.empty()) return;
    const int count = std::max(std::min(128, options_.gather_directions), options_.gather_directions / 4);
    peak_directions_ = peak_directions(peak_angles(discretisation.peak, scattering, count), problem_.sun->travel);
  }

  GatherScene<Real> peak_scene() const {
    return {.box = system_.box,
            .cells = *system_.cells,
            .source = &*peak_source_,
            .own_extinction = carried_extinction_,
            .fill_columns = true,
            .linear_source = system_.linear_source,
            .beam_slope = system_.slopes ? &system_.slopes->beam() : nullptr,
            .slopes = solved_.slopes ? &*solved_.slopes : nullptr};
  }

  // Spreads the light of the beam that is not direct, at a plane, as in the gathered `peak`. On entry `flux` holds this
  // light on the sun's own line.
  void add_peak(std::vector<double> peak, int edge, std::vector<double>& flux) const {
    const std::vector<double> sharp = at_edge(*sharp_beam_, edge);
    const std::vector<double> direct = at_edge(*true_beam_, edge);
    rescale(peak, mean(flux) + mean(direct) - mean(sharp));
    for (std::size_t c = 0; c < columns_; ++c) flux[c] = peak[c] + sharp[c] - direct[c];
  }

  GatherScene<Real> gather_scene() const {
    return {.box = system_.box,
            .cells = *system_.cells,
            .source = source_,
            .side_radiance = side_radiance_,
            .sky_radiance = problem_.sky_radiance,
            .ground = ground_ ? &*ground_ : nullptr,
            .reference = reference_,
            .linear_source = system_.linear_source,
            .beam_slope = system_.slopes ? &system_.slopes->beam() : nullptr,
            .slopes = solved_.slopes ? &*solved_.slopes : nullptr};
  }

  static std::vector<double> at_edge(const DirectBeam<Real>& beam, int edge) {
    const std::span<const double> flux = beam.flux_at(edge);
    return {flux.begin(), flux.end()};
  }

  void report_progress(double fraction) const {
    if (progress_)
      progress_({"gather", solved_.report.sweeps, solved_.report.estimated_error, solved_.ledger.residual, fraction});
  }

  template <class Value>
  std::vector<double> slice(const std::vector<Value>& levels, int edge) const {
    const auto first = levels.begin() + static_cast<std::ptrdiff_t>(edge * columns_);
    return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(columns_));
  }

  double profile_up(int edge) const { return solved_.fluxes.profile_up[edge]; }
  double profile_down(int edge) const { return solved_.fluxes.profile_down[edge]; }

  // Brings a gathered field to the mean that the conservative iteration found; returns the ratio of the means. The flux
  // of the reference radiance is exact, so the difference from it is scaled. If that is small, the field is shifted.
  double rescale(std::vector<double>& field, double wanted) const {
    const double found = mean(field);
    const double exact = std::numbers::pi * reference_;
    const bool scales =
        exact == 0 ? found > 0 && wanted > 0 : std::abs(wanted - found) < largest_correction * std::abs(found - exact);
    const double factor = scales ? (wanted - exact) / (found - exact) : 1;
    const double shift = exact == 0 || scales ? 0 : wanted - found;
    for (double& f : field) f = exact + (f - exact) * factor + shift;
    return found > 0 && wanted > 0 ? wanted / found : 1;
  }

  void note_factor(Solution& solution, double factor) const {
    if (std::abs(factor - 1) > std::abs(solution.report.gather_rescaling - 1))
      solution.report.gather_rescaling = factor;
  }

  void gather_ends(Solution& solution) {
    report_progress(0);
    bottom_down_ = gather_flux<Real>(gather_scene(), 0, false, downward_directions(problem_, options_), share_);
    std::vector<double> peak;
    if (!peak_directions_.empty()) peak = gather_flux<Real>(peak_scene(), 0, false, peak_directions_, share_);
    light_ground(std::move(peak), solution);
    report_progress(.25);
    top_up_ = gather_flux<Real>(gather_scene(), system_.box.nz(), true, upward_directions(problem_, options_), share_);
    if (!is_first()) return;
    const double by_ordinates = profile_up(system_.box.nz());
    if (system_.box.periodic) {
      note_factor(solution, rescale(top_up_, by_ordinates));
    } else {
      // Ordinates give the right sum of the light that leaves through sides and top. The many directions here give the
      // shares of each more accurately.
      const double more = mean(top_up_) - by_ordinates;
      solution.profile_upwelling_flux.back() += more;
      solution.ledger.reflectance += more / system_.power;
      solution.ledger.side_loss -= more / system_.power;
    }
    report_progress(.5);
  }

  // The light that leaves the ground, from the gathered light that arrives there: made by the first rank, known to all.
  void light_ground(std::vector<double> peak, Solution& solution) {
    if (is_first()) {
      note_factor(solution, rescale(bottom_down_, profile_down(0)));
      std::vector<double> direct;
      if (problem_.sun) {
        direct = at_edge(*true_beam_, 0);
        bottom_carried_ = at_edge(*carried_beam_, 0);
        for (std::size_t c = 0; c < columns_; ++c) bottom_carried_[c] -= direct[c];
        if (!peak.empty()) add_peak(std::move(peak), 0, bottom_carried_);
        for (std::size_t c = 0; c < columns_; ++c) direct[c] += bottom_carried_[c];
      }
      ground_ = system_.ground.radiance(solved_.fluxes.surface_arriving, bottom_down_, direct, system_.ordinates);
      const double factor = rescale(ground_->flux, profile_up(0));
      for (auto& row : ground_->at_points.data) {
        for (Real& radiance : row) radiance *= static_cast<Real>(factor);
      }
      note_factor(solution, factor);
    } else {  // in its form, to be received
      ground_ = system_.ground.radiance(solved_.fluxes.surface_arriving, std::vector<double>(columns_), {},
                                        system_.ordinates);
    }
    if (share_ == nullptr) return;
    for (auto& row : ground_->at_points.data) share_->from_first(std::span<Real>(row));
  }

  // Between bottom and top.
  void gather_inner(const Solution& solution) {
    for (const int edge : solution.flux_level) {
      if (edge > 0 && edge < system_.box.nz()) inner_edges_.push_back(edge);
    }
    if (inner_edges_.empty()) return;
    const auto gather = [this](const GatherScene<Real>& scene, bool upward,
                               const std::vector<GatherDirection>& directions) {
      return gather_level_fluxes<Real>(scene, inner_edges_, upward, directions, share_);
    };
    inner_down_ = gather(gather_scene(), false, downward_directions(problem_, options_));
    report_progress(.7);
    inner_up_ = gather(gather_scene(), true, upward_directions(problem_, options_));
    report_progress(.9);
    if (!peak_directions_.empty()) inner_peak_ = gather(peak_scene(), false, peak_directions_);
  }

  void set_plane(int edge, Solution& solution, LevelFlux& flux) const {
    const int top = system_.box.nz();
    if (edge == 0) {
      flux.down = bottom_down_;
      if (problem_.sun) flux.carried = bottom_carried_;
      flux.up = ground_->flux;
    } else if (edge == top) {
      flux.up = top_up_;
      flux.down.assign(columns_, std::numbers::pi * problem_.sky_radiance);
    } else {
      const auto inner =
          static_cast<int>(std::lower_bound(inner_edges_.begin(), inner_edges_.end(), edge) - inner_edges_.begin());
      flux.up = slice(inner_up_, inner);
      flux.down = slice(inner_down_, inner);
      note_factor(solution, rescale(flux.up, profile_up(edge)));
      note_factor(solution, rescale(flux.down, profile_down(edge)));
      if (!inner_peak_.empty()) add_peak(slice(inner_peak_, inner), edge, flux.carried);
    }
  }

  void append(Solution& solution, int edge, const LevelFlux& flux) const {
    for (std::size_t c = 0; c < columns_; ++c) {
      double direct = 0;
      // In very dark cells the remaining correction of the iteration can make the flux slightly negative.
      double diffuse = not_negative(flux.down[c]);
      if (problem_.sun) {
        direct = true_beam_->flux_at(edge)[c];
        diffuse = not_negative(diffuse + flux.carried[c]);
      }
      solution.upwelling_flux.push_back(static_cast<float>(not_negative(flux.up[c])));
      solution.downwelling_diffuse_flux.push_back(static_cast<float>(diffuse));
      solution.direct_flux.push_back(static_cast<float>(direct));
    }
  }

  void fill_profiles(Solution& solution) const {
    const int levels = system_.box.nz() + 1;
    solution.profile_upwelling_flux = solved_.fluxes.profile_up;
    solution.profile_downwelling_diffuse_flux = solved_.fluxes.profile_down;
    for (auto* profile : {&solution.profile_upwelling_flux, &solution.profile_downwelling_diffuse_flux}) {
      for (double& flux : *profile) flux = not_negative(flux);
    }
    solution.profile_direct_flux.assign(levels, 0.);
    if (!problem_.sun) return;
    for (int e = 0; e < levels; ++e) {
      const double direct = true_beam_->mean_flux[e];
      solution.profile_direct_flux[e] = direct;
      solution.profile_downwelling_diffuse_flux[e] += system_.beam.profile[e] - direct;
    }
    solution.ledger.transmittance_direct = solution.profile_direct_flux[0] / system_.power;
  }

  const Problem& problem_;
  const SolverOptions& options_;
  const TransportSystem<Real>& system_;
  const IterationResult<Real>& solved_;
  const ProgressCallback& progress_;
  DirectionalSource<Real>* source_;
  const OrdinateShare* share_;
  std::size_t columns_;
  double reference_;
  SideRadiance side_radiance_;
  std::optional<DirectBeam<Real>> true_beam_;     // true extinction: light reported as direct
  std::optional<DirectBeam<Real>> carried_beam_;  // light that the iteration counts as direct
  std::vector<Real> carried_extinction_;          // of that
  std::optional<DirectionalSource<Real>> peak_source_;
  std::vector<GatherDirection> peak_directions_;  // none: no peak
  std::optional<DirectBeam<Real>> sharp_beam_;    // light that still counts as direct beside these
  std::vector<double> bottom_carried_;
  std::optional<GroundRadiance<Real>> ground_;
  std::vector<double> bottom_down_;
  std::vector<double> top_up_;
  std::vector<int> inner_edges_;                           // of flux levels those between bottom and top
  std::vector<float> inner_up_, inner_down_, inner_peak_;  // [inner_edges_][columns]
};

}  // namespace

std::vector<int> flux_levels(const BoxGrid& box, const OutputOptions& options) {
  if (options.flux_levels == FluxLevels::boundaries) return {0, box.nz()};
  if (options.flux_levels == FluxLevels::listed) return options.listed_levels;
  std::vector<int> all(box.nz() + 1);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

template <class Real>
void fill_flux_fields(const ConvergedField<Real>& field, DirectionalSource<Real>* source,
                      const ProgressCallback& progress, Solution& solution) {
  FluxFields<Real>(field, source, progress).fill(solution);
}

template <class Real>
void share_source(const ConvergedField<Real>& field, bool whole, DirectionalSource<Real>& source) {
  if (field.share == nullptr || source.at_points.rows == 0) return;
  const OrdinateShare& share = *field.share;
  std::vector<std::vector<bool>> needs(static_cast<std::size_t>(share.ranks().size()),
                                       std::vector<bool>(static_cast<std::size_t>(source.at_points.rows)));
  if (whole) needs.front().assign(needs.front().size(), true);
  for (const auto& directions :
       {downward_directions(field.problem, field.options), upward_directions(field.problem, field.options)}) {
    for (const GatherDirection& direction : directions) {
      std::vector<bool>& of_owner = needs[static_cast<std::size_t>(share.owner_of_octant(octant_of(direction.travel)))];
      for (const int point : source.points.stencil(direction.travel).index)
        of_owner[static_cast<std::size_t>(point)] = true;
    }
  }
  share.to_needed_rows(source.at_points, needs);
}

template void share_source<float>(const ConvergedField<float>&, bool, DirectionalSource<float>&);
template void share_source<double>(const ConvergedField<double>&, bool, DirectionalSource<double>&);
template void fill_flux_fields<float>(const ConvergedField<float>&, DirectionalSource<float>*, const ProgressCallback&,
                                      Solution&);
template void fill_flux_fields<double>(const ConvergedField<double>&, DirectionalSource<double>*,
                                       const ProgressCallback&, Solution&);

}  // namespace cloudbow
