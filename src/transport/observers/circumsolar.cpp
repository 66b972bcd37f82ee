#include "transport/observers/circumsolar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "cloudbow/core/not_negative.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "transport/observers/viewing_source.hpp"
#include "transport/rays/march.hpp"

namespace cloudbow {
namespace {

// Rays are shared out over this many sums whatever the number of threads, so that sums have one order.
constexpr std::size_t groups = 8;

double fraction(double x) { return x - std::floor(x); }

// Scattering by each phase function in all, in arbitrary units.
std::vector<double> whole_scattering(const OpticalGrid& grid) {
  std::vector<double> sum;
  for (const auto& scattering : grid.scattering)
    sum.push_back(std::accumulate(scattering.begin(), scattering.end(), 0.));
  return sum;
}

// Optical depth of scattering into the peak: the beam of the iteration over light that never scattered.
double peak_depth(double carried, double never) {
  return carried > 0 ? std::log(carried / std::max(never, 1e-30 * carried)) : 0;
}

// Value at a place among the nodes.
double at_place(std::span<const double> nodes, double place) {
  const auto node = static_cast<std::size_t>(std::min(place, CircumsolarPhase::nodes - 2.));
  const double share = place - static_cast<double>(node);
  return (1 - share) * nodes[node] + share * nodes[node + 1];
}

}  // namespace

template <class Real>
struct CircumsolarLight<Real>::Source {
  LinearSource<Real> rest;      // all light but that in the peak
  LinearSource<Real> peak;      // no values: there is none
  std::vector<Real> side_peak;  // in marching order; empty: none
};

template <class Real>
struct CircumsolarLight<Real>::Ray {
  Direction travel;
  double x, y;    // start in the launch column
  double width;   // in columns
  double weight;  // sr of a plane that faces the sun
};

int circumsolar_rays_across(const AngularOptions& options) {
  return std::max(1, static_cast<int>(std::lround(std::sqrt(options.beam_rays))) / 2);
}

std::size_t circumsolar_bytes(std::size_t cells, std::size_t phases, std::size_t columns_at_levels, std::size_t real) {
  constexpr std::size_t of_source = 2 * 4 + 1;  // values and gradients of both, and the part from the beam
  return cells * (real * (phases + 2 + of_source) + sizeof(float)) + groups * columns_at_levels * real;
}

template <class Real>
CircumsolarLight<Real>::CircumsolarLight(const ConvergedField<Real>& field)
    : field_(field),
      rings_(cone_rings(field.options.circumsolar_half_angle, circumsolar_rings)),
      phase_(field.problem.phase, field.discretisation.beam, whole_scattering(field.problem.grid), rings_) {
  const Problem& problem = field.problem;
  const TransportSystem<Real>& system = field.system;
  const AngularField<Real> seen = higher_orders_seen<Real>(field, std::span(&problem.sun->travel, 1));
  if (!field.is_first()) return;
  higher_orders_.assign(seen.row(0), seen.row(0) + seen.cells);
  const std::vector<Real>& carried = system.beam.irradiance;
  if (phase_.has_peak()) {
    const DirectBeam<Real> never = beam_with<Real>(
        problem, system.cells->rows, std::vector<double>(problem.phase.size(), 0.), field.options, of_cells);
    place_.resize(carried.size());
    for (std::size_t c = 0; c < place_.size(); ++c) {
      place_[c] = static_cast<float>(CircumsolarPhase::place(
          peak_depth(static_cast<double>(carried[c]), static_cast<double>(never.irradiance[c]))));
    }
    carried_extinction_ = scaled_extinction<Real>(problem.grid, field.discretisation.beam_fraction());
    carried_extinction_.resize(carried_extinction_.size() + lane_padding);
  }
  for (std::size_t p = 0; p < problem.phase.size(); ++p) {
    std::vector<SingleScattering<Real>> first;
    add_single_scattering<Real>(first, problem.phase[p], problem.grid.scattering[p], 1., system.cells->extinction,
                                carried);
    first_order_.push_back(first.empty() ? std::vector<Real>{} : std::move(first.front().intensity));
  }
}

template <class Real>
typename CircumsolarLight<Real>::Source CircumsolarLight<Real>::source_of(std::size_t ring) const {
  const TransportSystem<Real>& system = field_.system;
  const Cells<Real>& cells = *system.cells;
  const std::size_t n = cells.size();
  Source source;
  LinearSource<Real>& rest = source.rest;
  rest.resize(n);
  rest.from_beam.assign(n, Real(0));
  if (phase_.has_peak()) source.peak.value.assign(n + lane_padding, Real(0));
  for (std::size_t p = 0; p < first_order_.size(); ++p) {
    if (first_order_[p].empty()) continue;
    const Real out_of_peak = static_cast<Real>(phase_.rest(p, ring));
    for (std::size_t c = 0; c < n; ++c) rest.from_beam[c] += out_of_peak * first_order_[p][c];
    const std::span<const double> peak = phase_.peak(p, ring);
    for (std::size_t c = 0; c < n && !peak.empty(); ++c) {
      if (first_order_[p][c] == 0) continue;
      const Real by_extinction = first_order_[p][c] * (cells.extinction[c] / carried_extinction_[c]);
      source.peak.value[c] += static_cast<Real>(at_place(peak, static_cast<double>(place_[c]))) * by_extinction;
    }
  }
  for (std::size_t c = 0; c < n; ++c) rest.value[c] = higher_orders_[c] + rest.from_beam[c];

  const Direction& travel = field_.problem.sun->travel;
  if (field_.result.slopes) {
    rest.gradient =
        slopes_seen<Real>(field_, std::span(&travel, 1), std::span<const Real>(rest.value).first(n), rest.from_beam);
    if (phase_.has_peak()) {
      const std::vector<Real>& value = source.peak.value;
      mix_slopes<Real>(field_.result.slopes->of_octant[octant_of(travel)], system.slopes->beam(), {}, 0, n,
                       value.data(), value.data(), source.peak.gradient);
    }
  } else if (system.linear_source) {
    rest.make_gradient(cells, system.thermal_emission());
    if (phase_.has_peak()) {
      // The emission is negative in places; gradients relative to it are the same.
      LinearSource<Real> size = source.peak;
      for (Real& value : size.value) value = std::abs(value);
      size.make_gradient(cells);
      source.peak.gradient = std::move(size.gradient);
    }
  }
  source.side_peak = side_peak(ring);
  return source;
}

// Light in the peak of the layers outside open sides, in closed form.
template <class Real>
std::vector<Real> CircumsolarLight<Real>::side_peak(std::size_t ring) const {
  if (field_.lateral_boundary == nullptr || !phase_.has_peak()) return {};
  const OpticalGrid& grid = field_.problem.grid;
  const Sun& sun = *field_.problem.sun;
  const std::vector<double> fraction_of = field_.discretisation.beam_fraction();
  std::vector<Real> radiance{Real(0)};
  double carried = 0, into_peak = 0;  // optical depths along the sun's rays
  for (int k = grid.box.nz() - 1; k >= 0; --k) {
    const double path = grid.box.thickness_m(k) / -sun.travel.z();
    carried += path * grid.layer_absorption[k];
    for (std::size_t p = 0; p < fraction_of.size(); ++p) {
      carried += path * (1 - fraction_of[p]) * grid.layer_scattering[p][k];
      into_peak += path * fraction_of[p] * grid.layer_scattering[p][k];
    }
    radiance.push_back(static_cast<Real>(sun.irradiance * std::exp(-carried) / (4 * std::numbers::pi) *
                                         at_place(phase_.carried(ring), CircumsolarPhase::place(into_peak))));
  }
  return radiance;
}

template <class Real>
std::vector<typename CircumsolarLight<Real>::Ray> CircumsolarLight<Real>::rays_of(std::size_t ring) const {
  const TransportSystem<Real>& system = field_.system;
  const Direction& sun = field_.problem.sun->travel;
  const Direction a = sun.unitOrthogonal();
  const Direction b = sun.cross(a);
  const double cosine = rings_[ring].mean_cosine();
  const double sine = std::sqrt(1 - cosine * cosine);
  const int across = circumsolar_rays_across(field_.options);
  const int rays = system.independent_columns ? 1 : across;
  std::vector<Ray> result;
  for (int m = 0; m < circumsolar_azimuths; ++m) {
    const double azimuth =
        2 * std::numbers::pi * (m + fraction(.37 + .618 * static_cast<double>(ring))) / circumsolar_azimuths;
    const Direction travel = cosine * sun + sine * (std::cos(azimuth) * a + std::sin(azimuth) * b);
    if (travel.z() >= 0) continue;  // from below the horizon
    const double q = static_cast<double>(ring) * circumsolar_azimuths + m;
    for (int r = 0; r < rays * rays; ++r) {
      const auto start = [&](int ray, double step) {
        return system.independent_columns ? .5 : (ray + fraction(.5 + step * q)) / across;
      };
      const int row = r / rays;
      result.push_back({off_the_horizon(travel), start(r % rays, .7548776662466927), start(row, .5698402909980532),
                        1. / across, rings_[ring].power() / (circumsolar_azimuths * rays * rays)});
    }
  }
  return result;
}

template <class Real>
void CircumsolarLight<Real>::march(const Ray& ray, const Source& source, std::span<const int> plane,
                                   std::vector<Real>& flux) const {
  const TransportSystem<Real>& system = field_.system;
  const BoxGrid& box = system.box;
  PathPattern pattern = make_path_pattern(box, ray.travel, ray.x, ray.y, system.independent_columns, {0, box.nz()});
  if (field_.result.slopes) pattern = at_true_places(std::move(pattern));
  const auto land = [&](int step, const Real* rays, auto&) {
    const int at = plane[static_cast<std::size_t>(box.nz() - step)];
    if (at < 0) return;
    Real* const of_plane = flux.data() + static_cast<std::size_t>(at) * box.columns();
    spread_on_columns(pattern.x[step], pattern.y[step], ray.width, box.nx, box.ny, box.periodic,
                      [&](std::size_t column, std::size_t from, int n, double overlap) {
                        const Real weight = static_cast<Real>(ray.weight * overlap);
                        for (int i = 0; i < n; ++i) of_plane[column + i] += weight * rays[from + i];
                      });
  };
  const auto march_one = [&](const LinearSource<Real>& of, const CellView<Real>& cells, double sky,
                             std::span<const Real> side) {
    std::vector<Real> rays(box.columns() + lane_padding, static_cast<Real>(sky));
    cloudbow::march<Real, false>(pattern, system.cells->rows, cells, box.periodic, side, of.value.data(), rays.data(),
                                 false, {}, land);
  };
  std::vector<Real> side;
  if (field_.lateral_boundary != nullptr) {
    const auto by_height = field_.lateral_boundary->radiance_beside_peak(ray.travel);
    side.assign(by_height.rbegin(), by_height.rend());
  }
  march_one(source.rest, source.rest.view(*system.cells), field_.problem.sky_radiance, side);
  if (source.peak.value.empty()) return;
  CellView<Real> carried = source.peak.view(*system.cells);
  carried.extinction = carried_extinction_.data();
  march_one(source.peak, carried, 0, source.side_peak);
}

template <class Real>
void CircumsolarLight<Real>::fill(Solution& solution) const {
  const BoxGrid& box = field_.system.box;
  std::vector<int> plane(static_cast<std::size_t>(box.nz()) + 1, -1);
  for (std::size_t at = 0; at < solution.flux_level.size(); ++at)
    plane[static_cast<std::size_t>(solution.flux_level[at])] = static_cast<int>(at);
  const std::size_t values = solution.flux_level.size() * box.columns();
  std::vector<std::vector<Real>> sums(groups, std::vector<Real>(values, Real(0)));
  for (std::size_t ring = 0; ring < rings_.size(); ++ring) {
    const Source source = source_of(ring);
    const std::vector<Ray> rays = rays_of(ring);
    ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t g = 0; g < groups; ++g) {
      errors.run([&] {
        for (std::size_t r = g; r < rays.size(); r += groups) march(rays[r], source, plane, sums[g]);
      });
    }
    errors.rethrow();
  }
  solution.circumsolar_flux.resize(values);
  for (std::size_t n = 0; n < values; ++n) {
    double sum = 0;
    for (const std::vector<Real>& of : sums) sum += static_cast<double>(of[n]);
    solution.circumsolar_flux[n] = static_cast<float>(not_negative(sum));
  }
}

template class CircumsolarLight<float>;
template class CircumsolarLight<double>;

}  // namespace cloudbow
