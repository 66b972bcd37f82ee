#include "transport/rays/direct_beam.hpp"

#include <cmath>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/rays/slope_fit.hpp"

namespace cloudbow {
namespace {

// Rays are shared out over this many accumulators whatever the number of threads, so that sums have one order.
constexpr int groups = 4;

// (1 - e^-t)/t: mean over the path of light that enters as 1. Below one half (1 - e)/t loses digits in float; the
// series to t^7 does not.
template <class Real>
[[gnu::always_inline]] inline Real mean_transmission(Real t) {
  Real series = Real(1) - t * Real(1. / 8);
  for (int k = 7; k >= 2; --k) series = Real(1) - t * series * (Real(1) / static_cast<Real>(k));
  const Real thick = (Real(1) - transmission(t)) / (t + std::numeric_limits<Real>::min());
  return t < Real(.5) ? series : thick;
}

template <class Real>
struct Accumulator {
  std::vector<Real> irradiance;
  std::array<std::vector<Real>, 3> moment;  // first moments of the irradiance about the cells' centres
  std::vector<Eigen::Vector3d> place;       // [nz] of the rays' mean places
  std::vector<Eigen::Matrix3d> spread;      // [nz] of their places' second moments
  std::vector<double> level_flux;           // [requested interfaces][columns]
  std::vector<double> mean_flux;            // [nz+1]
  double gain = 0;
  double loss = 0;

  void note_places(const PathPattern& pattern, int step) {
    const int level = pattern.level(step);
    for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
      const Segment& segment = pattern.segments[s];
      for (int axis = 0; axis < 3; ++axis)
        place[level][axis] += segment.fraction * .5 * (segment.from[axis] + segment.to[axis]);
    }
    spread[level] += spread_of_places(pattern, step);
  }
};

// Rays of one segment cross blocks of air.
template <class Real>
class BeamInAir {
 public:
  // @param t optical path of the segment; @param path of the rays so far.
  BeamInAir(const SegmentGeometry<Real>& geometry, Real t, Real irradiance_of_ray, const ActiveRows& rows,
            std::vector<Real>& path, Accumulator<Real>& sum)
      : g_(geometry), t_(t), entering_(g_.share * irradiance_of_ray), rows_(rows), path_(path), sum_(sum) {}

  void enter(std::size_t cell) {
    cell_ = cell;
    part_.fill(0);
  }
  void cross(std::size_t ray, int n) {
    Real* __restrict const before = path_.data() + ray;
    Real* __restrict const part = part_.data();
    const Real t = t_;
    const bool sums = !sum_.irradiance.empty();
    for (int first = 0; first < n; first += lanes) {
      if (sums) {
        for_lanes<Real>(
            std::min(lanes, n - first), [=](int i, bool active) __attribute__((always_inline)) {
              part[i] += active ? transmission(before[first + i]) : Real(0);
            });
      }
      for_lanes<Real>(
          std::min(lanes, n - first), [=](int i, bool active) __attribute__((always_inline)) {
            before[first + i] += active ? t : Real(0);
          });
    }
  }
  void leave() {
    if (sum_.irradiance.empty()) return;
    Real light = 0;
    for (const Real of_lane : part_) light += of_lane;
    light *= entering_ / static_cast<Real>(rows_.places[cell_]);
    const Real held = light * mean_transmission(t_);
    sum_.irradiance[cell_] += held;
    if (sum_.moment[2].empty()) return;
    const auto phi = exponential_functions(std::min(t_, static_cast<Real>(largest_optical_path)));
    sum_.moment[2][cell_] += g_.from_z * held + (g_.to_z - g_.from_z) * light * (phi.phi1 - phi.phi2);
  }

 private:
  SegmentGeometry<Real> g_;
  Real t_;
  Real entering_;
  const ActiveRows& rows_;
  std::vector<Real>& path_;
  Accumulator<Real>& sum_;
  std::size_t cell_ = 0;
  std::array<Real, lanes> part_{};
};

// A ray crosses the first `steps` levels, which are uniform, as all rays do. Returns its optical path after them.
// before(step, transmitted) is called before each.
template <class Real, class Before>
Real cross_uniform_levels(const PathPattern& pattern, int steps, const ActiveRows& rows,
                          const std::vector<Real>& extinction, Real irradiance_of_ray, Accumulator<Real>& sum,
                          bool keeps_slopes, const Before& before) {
  double path = 0;
  for (int step = 0; step < steps; ++step) {
    before(step, std::exp(-path));
    if (keeps_slopes) sum.note_places(pattern, step);
    const int level = pattern.level(step);
    const std::size_t cell = rows.level_cell[level];
    if (cell == rows.level_cell[level + 1]) continue;
    for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
      const SegmentGeometry<double> g(pattern.segments[s], pattern.chord_m[step]);
      const double t = static_cast<double>(extinction[cell]) * g.length;
      if (!sum.irradiance.empty()) {
        const double entering = g.share * static_cast<double>(irradiance_of_ray) * std::exp(-path);
        const double held = entering * mean_transmission(t);
        sum.irradiance[cell] += static_cast<Real>(held);
        if (keeps_slopes) {
          const auto phi = exponential_functions(std::min(t, static_cast<double>(largest_optical_path)));
          sum.moment[2][cell] +=
              static_cast<Real>(g.from_z * held + (g.to_z - g.from_z) * entering * (phi.phi1 - phi.phi2));
        }
      }
      path += t;
    }
  }
  return static_cast<Real>(path);
}

// Slopes relative to the irradiance, from the sums over all rays. Cells that the beam does not reach have none.
template <class Real>
std::array<std::vector<Real>, 3> slopes_from(const std::vector<Accumulator<Real>>& sums, const ActiveRows& rows,
                                             std::span<const Real> irradiance, int rays, double sun_irradiance) {
  std::array<std::vector<Real>, 3> slope;
  for (auto& axis : slope) axis.assign(rows.size() + lane_padding, Real(0));
  for (int k = 0; k < rows.nz; ++k) {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& sum : sums) {
      place += sum.place[k] / rays;
      spread += sum.spread[k] / rays;
    }
    const Eigen::Matrix3d inverse = regular_inverse(spread - place * place.transpose());
    const double along_z = spread(2, 2) - place.z() * place.z();
    constexpr double dark = 1e-20;
    for (std::uint32_t c = rows.level_cell[k]; c < rows.level_cell[k + 1]; ++c) {
      const double here = static_cast<double>(irradiance[c]);
      if (here <= dark * sun_irradiance) continue;
      Eigen::Vector3d moment = Eigen::Vector3d::Zero();
      for (const auto& sum : sums) moment += Eigen::Vector3d(sum.moment[0][c], sum.moment[1][c], sum.moment[2][c]);
      const Eigen::Vector3d off = moment / here - place;
      // Blocks of air have a slope along z alone.
      const Eigen::Vector3d g =
          c < rows.voxels_end(k) ? Eigen::Vector3d(inverse * off) : Eigen::Vector3d(0, 0, off.z() / along_z);
      for (int axis = 0; axis < 3; ++axis) slope[axis][c] = static_cast<Real>(g[axis]);
    }
  }
  return slope;
}

}  // namespace

template <class Real>
DirectBeam<Real> direct_beam(const BoxGrid& box, const ActiveRows& rows, std::span<const Real> extinction,
                             std::span<const double> layer_extinction, const Sun& sun, const BeamOptions& options) {
  const double mu0 = -sun.travel.z();
  const int across = static_cast<int>(std::lround(std::sqrt(options.rays)));
  const bool still_x = options.independent_columns || (box.periodic && box.nx == 1);
  const bool still_y = options.independent_columns || (box.periodic && box.ny == 1);
  const int rays_x = still_x ? 1 : across;
  const int rays_y = still_y ? 1 : across;
  const int rays = rays_x * rays_y;
  const double width = 1. / across;
  const double power_of_ray = sun.irradiance / rays;
  const Real irradiance_of_ray = static_cast<Real>(power_of_ray);
  const std::size_t columns = box.columns();

  // Place of each interface among those whose flux is requested by column; -1: not requested.
  std::vector<int> place(box.nz() + 1, options.parts.levels && box.periodic ? -1 : 0);
  if (options.parts.levels) {
    for (const int edge : *options.parts.levels) place[edge] = 0;
  }
  int requested = 0;
  for (int& at : place) at = at < 0 ? -1 : requested++;

  // Levels from the top down to the first that is not uniform. All rays are alike there.
  int first_step = 0;
  while (box.periodic && first_step < box.nz() && rows.is_uniform(box.nz() - 1 - first_step)) ++first_step;

  // Optical path from the top down to each interface, in marching order, of the layers alone.
  std::vector<double> layer_path(box.nz() + 1, 0.);
  for (int step = 0; step < box.nz(); ++step) {
    const int k = box.nz() - 1 - step;
    layer_path[step + 1] = layer_path[step] + layer_extinction[k] * box.thickness_m(k) / mu0;
  }

  std::vector<Real> padded(extinction.begin(), extinction.end());
  padded.resize(extinction.size() + lane_padding);
  std::vector<Accumulator<Real>> sums(std::min(groups, rays));
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t g = 0; g < sums.size(); ++g) {
    errors.run([&] {
      Accumulator<Real>& sum = sums[g];
      sum.irradiance.assign(options.parts.irradiance ? rows.size() + lane_padding : 0, Real(0));
      for (auto& moment : sum.moment) moment.assign(options.parts.slopes ? rows.size() + lane_padding : 0, Real(0));
      sum.place.assign(box.nz(), Eigen::Vector3d::Zero());
      sum.spread.assign(box.nz(), Eigen::Matrix3d::Zero());
      sum.level_flux.assign(columns * static_cast<std::size_t>(requested), 0.);
      sum.mean_flux.assign(box.nz() + 1, 0.);
      // Rays carry their optical path, not their light: thousands of thin segments then add no rounding to speak of.
      std::vector<Real> path(columns + lane_padding);
      std::vector<Real> light(columns);
      for (int ray = static_cast<int>(g); ray < rays; ray += static_cast<int>(sums.size())) {
        // The offset keeps rays off the faces if the sun's azimuth is along an axis.
        const int row = ray / rays_x;
        const PathPattern pattern =
            at_true_places(make_path_pattern(box, sun.travel, (ray % rays_x + .5) / rays_x + 1e-7,
                                             (row + .5) / rays_y + 1e-7, options.independent_columns, {0, box.nz()}));
        double landed = 0;  // at the interface recorded last
        const auto record = [&](int step) {
          landed = 0;
          const int edge = box.nz() - step;
          if (box.periodic)
            sum.mean_flux[edge] += mu0 * power_of_ray * plane_sum(light.data(), columns) / static_cast<double>(columns);
          if (place[edge] < 0) return;
          double* const flux = sum.level_flux.data() + columns * static_cast<std::size_t>(place[edge]);
          spread_on_columns(pattern.x[step], pattern.y[step], width, box.nx, box.ny, box.periodic,
                            [&](std::size_t column, std::size_t from, int n, double weight) {
                              double* __restrict const to = flux + column;
                              const double share = mu0 * power_of_ray * weight;
                              for (int i = 0; i < n; ++i) to[i] += share * static_cast<double>(light[from + i]);
                              if (box.periodic) return;
                              for (int i = 0; i < n; ++i) landed += weight * static_cast<double>(light[from + i]);
                            });
        };
        const auto record_everywhere = [&](int step, double transmitted) {
          const int edge = box.nz() - step;
          const double more = mu0 * power_of_ray * transmitted;
          sum.mean_flux[edge] += more;
          if (place[edge] < 0) return;
          double* const flux = sum.level_flux.data() + columns * static_cast<std::size_t>(place[edge]);
          for (std::size_t c = 0; c < columns; ++c) flux[c] += more;
        };
        const Real above = cross_uniform_levels<Real>(pattern, first_step, rows, padded, irradiance_of_ray, sum,
                                                      options.parts.slopes, record_everywhere);
        std::fill(path.begin(), path.end(), above);
        std::fill(light.begin(), light.end(), transmission(above));
        record(first_step);
        for (int step = first_step; step < box.nz(); ++step) {
          const int level = pattern.level(step);
          const Real chord = static_cast<Real>(pattern.chord_m[step]);
          const auto light_up = [&](const Segment& segment) {
            const Real length = chord * static_cast<Real>(segment.fraction);
            const Real share = static_cast<Real>(segment.fraction) * irradiance_of_ray;
            return [&, length, share](std::size_t m, std::size_t cell, int count) {
              Real* __restrict const before = path.data() + m;
              const Real* __restrict const sigma = padded.data() + cell;
              Real* __restrict const mean = sum.irradiance.data() + cell;
              for_lanes<Real>(
                  count, [=](int i, bool active) __attribute__((always_inline)) {
                    const Real t = active ? sigma[i] * length : Real(0);
                    const Real entering = active ? share : Real(0);
                    mean[i] += entering * mean_transmission(t) * transmission(before[i]);
                    before[i] += t;
                  });
            };
          };
          const auto light_up_with_moments = [&](const Segment& segment) {
            const SegmentGeometry<Real> of(segment, pattern.chord_m[step]);
            return [&, of](std::size_t m, std::size_t cell, int count) {
              Real* __restrict const before = path.data() + m;
              const Real* __restrict const sigma = padded.data() + cell;
              Real* __restrict const mean = sum.irradiance.data() + cell;
              Real* __restrict const x = sum.moment[0].data() + cell;
              Real* __restrict const y = sum.moment[1].data() + cell;
              Real* __restrict const z = sum.moment[2].data() + cell;
              for_lanes<Real>(
                  count, [=](int i, bool active) __attribute__((always_inline)) {
                    const Real t = active ? sigma[i] * of.length : Real(0);
                    const Real entering = (active ? of.share * irradiance_of_ray : Real(0)) * transmission(before[i]);
                    const auto phi = exponential_functions(std::min(t, static_cast<Real>(largest_optical_path)));
                    const Real held = entering * mean_transmission(t);
                    const Real along = entering * (phi.phi1 - phi.phi2);
                    mean[i] += held;
                    x[i] += of.from_x * held + (of.to_x - of.from_x) * along;
                    y[i] += of.from_y * held + (of.to_y - of.from_y) * along;
                    z[i] += of.from_z * held + (of.to_z - of.from_z) * along;
                    before[i] += t;
                  });
            };
          };
          const auto dim = [&](const Segment& segment) {
            return
                [&, length = chord * static_cast<Real>(segment.fraction)](std::size_t m, std::size_t cell, int count) {
                  Real* __restrict const before = path.data() + m;
                  const Real* __restrict const sigma = padded.data() + cell;
                  for_lanes<Real>(
                      count, [=](int i, bool active)
                                 __attribute__((always_inline)) { before[i] += active ? sigma[i] * length : Real(0); });
                };
          };
          const auto begin_air = [&](const Segment& segment) {
            const SegmentGeometry<Real> of(segment, pattern.chord_m[step]);
            return BeamInAir<Real>(of, padded[rows.air[level].first_cell] * of.length, irradiance_of_ray, rows, path,
                                   sum);
          };
          const auto enter = [&](const Segment& segment, double at) {
            if (box.periodic) return;
            const Real outside = static_cast<Real>((1 - at) * layer_path[step] + at * layer_path[step + 1]);
            for_rays_through_side(segment, box.nx, box.ny, [&](std::size_t m) {
              sum.loss += static_cast<double>(transmission(path[m]));
              sum.gain += static_cast<double>(transmission(outside));
              path[m] = outside;
            });
          };
          if (options.parts.slopes) {
            sum.note_places(pattern, step);
            cross_level(pattern, step, level, rows, light_up_with_moments, begin_air, enter);
          } else if (options.parts.irradiance) {
            cross_level(pattern, step, level, rows, light_up, begin_air, enter);
          } else {
            cross_level(pattern, step, level, rows, dim, begin_air, enter);
          }
          if (!box.periodic || rows.level_cell[level] < rows.level_cell[level + 1]) {
            for (std::size_t m = 0; m < columns; ++m) light[m] = transmission(path[m]);
          }
          record(step + 1);
        }
        if (!box.periodic) {  // rays that overlap a side let in or out: landed minus carried light
          for (const Real rest : light) landed -= static_cast<double>(rest);
          (landed > 0 ? sum.gain : sum.loss) += std::abs(landed);
        }
      }
    });
  }
  errors.rethrow();

  DirectBeam<Real> result;
  result.irradiance.assign(options.parts.irradiance ? rows.size() : 0, Real(0));
  result.level_flux.assign(columns * static_cast<std::size_t>(requested), 0.);
  result.mean_flux.assign(box.nz() + 1, 0.);
  for (const auto& sum : sums) {
    for (std::size_t c = 0; c < result.irradiance.size(); ++c) result.irradiance[c] += sum.irradiance[c];
    for (int edge = 0; edge <= box.nz(); ++edge) result.mean_flux[edge] += sum.mean_flux[edge];
    for (std::size_t c = 0; c < result.level_flux.size(); ++c) result.level_flux[c] += sum.level_flux[c];
  }
  result.level = place;
  if (!box.periodic) {  // all were requested
    for (int edge = 0; edge <= box.nz(); ++edge)
      result.mean_flux[edge] =
          plane_sum(result.level_flux.data() + columns * edge, columns) / static_cast<double>(columns);
  }
  if (options.parts.slopes) result.slope = slopes_from<Real>(sums, rows, result.irradiance, rays, sun.irradiance);
  for (const auto& sum : sums) {
    result.side_gain += sum.gain * mu0 * sun.irradiance / rays / static_cast<double>(columns);
    result.side_loss += sum.loss * mu0 * sun.irradiance / rays / static_cast<double>(columns);
  }
  return result;
}

template DirectBeam<float> direct_beam<float>(const BoxGrid&, const ActiveRows&, std::span<const float>,
                                              std::span<const double>, const Sun&, const BeamOptions&);
template DirectBeam<double> direct_beam<double>(const BoxGrid&, const ActiveRows&, std::span<const double>,
                                                std::span<const double>, const Sun&, const BeamOptions&);

}  // namespace cloudbow
