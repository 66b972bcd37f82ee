#include "cloudbow/transport/gather.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "backward_march.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "plane_blur.hpp"

namespace cloudbow {
namespace {

constexpr double golden = .6180339887498949;
// Nothing arrives through a plane from below it, and grazing rays cross endless cells.
constexpr double grazing = 1e-4;
constexpr double sun_asymmetry = .85;  // how the extra directions crowd about the sun
constexpr double band_growth = 1.6;    // each distance band ends this many times as far as the last
constexpr double class_growth = 1.4;   // directions of one class differ in spread by at most this factor
constexpr int most_classes = 16;
constexpr double blur_per_spread = .3;  // Gaussian width as a fraction of the beam's spread
// Directions are shared out over this many sums whatever the number of threads, so that sums have one order.
constexpr std::size_t groups = 8;
constexpr std::size_t level_groups = 4;       // fewer for sums over all levels, which take memory
constexpr std::size_t worth_a_gradient = 64;  // directions for which the source's gradient is worked out anew

double fraction(double x) { return x - std::floor(x); }

double henyey_greenstein_density(double cosine) {
  const double g = sun_asymmetry;
  return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5) / (4 * std::numbers::pi);
}

// Where in their columns the rays of a direction start: at the centre, from where each is right to second order, or in
// places that fill a column evenly (additive recurrence of the plastic number, Roberts 2018), for light that changes
// within the columns, as at a cloud's top.
struct LaunchPlace {
  double x;
  double y;
};

LaunchPlace launch_place(std::size_t direction, bool filling) {
  const double q = static_cast<double>(direction);
  if (!filling) return {.5, .5};
  return {fraction(.5 + .7548776662466927 * q), fraction(.5 + .5698402909980532 * q)};
}

// What a direction's radiance counts in a flux.
double power(const GatherDirection& direction) { return direction.weight * std::abs(direction.travel.z()); }

// Distance over which the beam of one direction spreads, per unit height.
double beam_spread(const GatherDirection& direction) {
  const double mu2 = direction.travel.z() * direction.travel.z();
  return std::sqrt(.5 * direction.weight * (1 / (mu2 * mu2) + 1 / mu2));
}

std::vector<Band> distance_bands(const BoxGrid& box, const ActiveRows& rows, const PathPattern& pattern) {
  std::vector<Band> bands;
  double distance = 0;
  for (int first = 0; first < pattern.levels();) {
    const int last =
        first == 0 ? 1 : std::min(pattern.levels(), std::max(static_cast<int>(band_growth * first), first + 1));
    double thickness = 0;
    bool empty = true;
    for (int step = first; step < last; ++step) {
      const int k = pattern.level(step);
      thickness += box.thickness_m(k);
      empty = empty && rows.level_cell[k] == rows.level_cell[k + 1];
    }
    bands.push_back({first, last, distance + thickness / 2, empty});
    distance += thickness;
    first = last;
  }
  return bands;
}

// Directions that are blurred alike: of like spread of their beams, [first, last) of those in order of it.
struct SpreadClass {
  std::size_t first;
  std::size_t last;
  double spread;  // flux-weighted
};

// Sorts the directions.
std::vector<SpreadClass> spread_classes(std::vector<GatherDirection>& directions) {
  double least = beam_spread(directions.front());
  for (const auto& d : directions) least = std::min(least, beam_spread(d));
  const auto class_of = [&](const GatherDirection& d) {
    return std::min(most_classes - 1,
                    static_cast<int>(std::log(beam_spread(d) / least * (1 + 1e-12)) / std::log(class_growth)));
  };
  std::stable_sort(directions.begin(), directions.end(),
                   [&](const auto& a, const auto& b) { return class_of(a) < class_of(b); });
  std::vector<SpreadClass> classes;
  for (std::size_t first = 0; first < directions.size();) {
    std::size_t last = first;
    double spread_sum = 0;
    double weight_sum = 0;
    for (; last < directions.size() && class_of(directions[last]) == class_of(directions[first]); ++last) {
      const double spread = beam_spread(directions[last]);
      spread_sum += power(directions[last]) * spread * spread;
      weight_sum += power(directions[last]);
    }
    classes.push_back({first, last, std::sqrt(spread_sum / weight_sum)});
    first = last;
  }
  return classes;
}

// Gradient of the source, relative to it: of the mean over directions of one quadrant where cells are varied, else of
// each direction's own.
template <class Real>
class SourceGradients {
 public:
  explicit SourceGradients(const GatherScene<Real>& scene) : scene_(scene) {}

  // For the directions that along() will be asked for next.
  void prepare(std::span<const GatherDirection> directions) {
    if (!scene_.cells.varied) return;
    const DirectionalSource<Real>& source = *scene_.source;
    for (int q = 0; q < quadrants; ++q) {
      std::vector<double> of_point(source.points.size(), 0.);
      std::vector<double> of_beam(source.first_order.size(), 0.);
      for (const GatherDirection& d : directions) {
        if (quadrant(d.travel) != q) continue;
        if (source.at_points.rows > 0) {
          const Stencil stencil = source.points.stencil(d.travel);
          for (int k = 0; k < 3; ++k) of_point[stencil.index[k]] += power(d) * stencil.weight[k];
        }
        for (std::size_t b = 0; b < of_beam.size(); ++b)
          of_beam[b] += power(d) * std::abs(source.first_order[b].phase(d.travel.dot(source.sun_travel)));
      }
      make_mean(of_point, of_beam);
      make_gradient(gradient_[q]);
    }
  }

  // @param own holds the gradient where it is the direction's own.
  CellView<Real> along(const Direction& travel, LinearSource<Real>& own) const {
    const Cells<Real>& cells = scene_.cells;
    if (cells.varied) {
      const Gradient& gradient = gradient_[quadrant(travel)];
      return {scene_.extinction(), {gradient[0].data(), gradient[1].data(), gradient[2].data()}};
    }
    own.resize(cells.size());
    scene_.source->query(travel, own.value.data());
    // A forward peak sends less than nothing in some directions; what is relative to it is the same.
    for (Real& value : own.value) value = std::abs(value);
    own.make_gradient(cells);
    CellView<Real> view = own.view(cells);
    view.extinction = scene_.extinction();
    return view;
  }

 private:
  static constexpr int quadrants = 4;
  static constexpr std::size_t block_cells = 4096;    // a thread's share of loops over cells
  using Gradient = std::array<std::vector<Real>, 3>;  // [n + lane_padding] along x, y, z

  static int quadrant(const Direction& travel) { return (travel.x() > 0 ? 1 : 0) + (travel.y() > 0 ? 2 : 0); }

  void make_mean(const std::vector<double>& of_point, const std::vector<double>& of_beam) {
    const std::size_t n = scene_.cells.size();
    mean_.resize(n);
    // Nothing throws here.
#pragma omp parallel for schedule(static)
    for (std::size_t first = 0; first < n; first += block_cells) {
      const std::size_t count = std::min(block_cells, n - first);
      Real* __restrict const to = mean_.data() + first;
      std::fill_n(to, count, Real(0));
      const auto add = [&](double weight, const Real* __restrict from) {
        const Real scale = static_cast<Real>(weight);
        for (std::size_t c = 0; c < count; ++c) to[c] += scale * from[c];
      };
      std::array<Real, block_cells> room{};
      for (std::size_t m = 0; m < of_point.size(); ++m) {
        if (of_point[m] > 0)
          add(of_point[m], scene_.source->at_points.stored_row(static_cast<int>(m)).read(first, count, room.data()));
      }
      for (std::size_t b = 0; b < of_beam.size(); ++b)
        add(of_beam[b], scene_.source->first_order[b].intensity.data() + first);
    }
  }

  void make_gradient(Gradient& gradient) {
    const std::size_t n = scene_.cells.size();
    // Nothing throws here but before the loop.
    for (auto& axis : gradient) axis.resize(n + lane_padding);
#pragma omp parallel for schedule(static)
    for (std::size_t first = 0; first < n; first += block_cells) {
      source_gradient(scene_.cells, first, std::min(block_cells, n - first), mean_.data(), gradient[0].data() + first,
                      gradient[1].data() + first, gradient[2].data() + first);
    }
  }

  const GatherScene<Real>& scene_;
  std::vector<Real> mean_;
  std::array<Gradient, quadrants> gradient_;
};

}  // namespace

std::vector<GatherDirection> gather_directions(int count, bool upward, const std::optional<Direction>& sun_travel) {
  std::vector<GatherDirection> set;
  const double side = upward ? 1 : -1;
  for (int i = 0; i < count; ++i) {
    const double mu = std::sqrt((i + .5) / count);
    const double azimuth = 2 * std::numbers::pi * fraction(golden * i);
    const double sine = std::sqrt(1 - mu * mu);
    set.push_back({{sine * std::cos(azimuth), sine * std::sin(azimuth), side * mu}, std::numbers::pi / (count * mu)});
  }
  if (!sun_travel) return set;
  const int extra = count / 4;
  const Direction a = sun_travel->unitOrthogonal();
  const Direction b = sun_travel->cross(a);
  const double g = sun_asymmetry;
  for (int i = 0; i < extra; ++i) {
    const double q = (1 - g * g) / (1 - g + 2 * g * (i + .5) / extra);
    const double cosine = (1 + g * g - q * q) / (2 * g);
    const double sine = std::sqrt(std::max(0., 1 - cosine * cosine));
    const double azimuth = 2 * std::numbers::pi * fraction(golden * i + .37);
    const Direction travel = cosine * *sun_travel + sine * (std::cos(azimuth) * a + std::sin(azimuth) * b);
    if (travel.z() * side > grazing) set.push_back({travel, 0.});
  }
  for (GatherDirection& d : set) {
    d.weight = 1 / (count * std::abs(d.travel.z()) / std::numbers::pi +
                    extra * henyey_greenstein_density(d.travel.dot(*sun_travel)));
  }
  return set;
}

std::vector<GatherDirection> peak_directions(std::span<const PeakAngle> angles, const Direction& sun_travel) {
  std::vector<GatherDirection> set;
  const Direction a = sun_travel.unitOrthogonal();
  const Direction b = sun_travel.cross(a);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double cosine = angles[i].cos_angle;
    const double sine = std::sqrt(std::max(0., 1 - cosine * cosine));
    const double azimuth = 2 * std::numbers::pi * fraction(golden * static_cast<double>(i));
    const Direction travel = cosine * sun_travel + sine * (std::cos(azimuth) * a + std::sin(azimuth) * b);
    if (travel.z() < -grazing) set.push_back({travel, 1 / (static_cast<double>(angles.size()) * angles[i].density)});
  }
  return set;
}

template <class Real>
std::vector<double> gather_flux(const GatherScene<Real>& scene, int edge, bool upward,
                                const std::vector<GatherDirection>& directions) {
  const BoxGrid& box = scene.box;
  const std::size_t columns = box.columns();
  const LevelRange levels = upward ? LevelRange{0, edge} : LevelRange{edge, box.nz()};
  std::vector<GatherDirection> sorted = directions;
  const std::vector<SpreadClass> classes = spread_classes(sorted);
  const PathPattern vertical = make_path_pattern(box, Direction(0, 0, upward ? -1 : 1), .5, .5, true, levels);
  const std::vector<Band> bands = distance_bands(box, scene.cells.rows, vertical);

  // Downward, a few directions about the sun's carry too much of the light to be put anywhere but at the centre.
  const bool filling = scene.fill_columns || (upward && !bands.empty() && !bands.front().empty);

  std::vector<double> flux(columns, 0.);
  std::vector<Gathered<Real>> sums(groups);
  SourceGradients<Real> gradients(scene);
  std::size_t prepared = 0;
  for (const SpreadClass& alike : classes) {
    if (alike.last > prepared) {
      prepared = std::min(sorted.size(), std::max(alike.last, alike.first + worth_a_gradient));
      gradients.prepare({sorted.data() + alike.first, prepared - alike.first});
    }
    ParallelErrors errors;
#pragma omp parallel
    {
      GatherWorkspace<Real> work;
      LinearSource<Real> own;
#pragma omp for schedule(dynamic, 1)
      for (std::size_t g = 0; g < groups; ++g) {
        errors.run([&] {
          sums[g].clear(bands.size(), columns);
          for (std::size_t q = alike.first + g; q < alike.last; q += groups) {
            const Direction& travel = sorted[q].travel;
            const LaunchPlace start = launch_place(q, filling);
            march_back(scene, make_path_pattern(box, -travel, start.x, start.y, false, levels), bands, travel,
                       scene.source->along(travel), static_cast<Real>(power(sorted[q])), gradients.along(travel, own),
                       work, sums[g]);
          }
        });
      }
#pragma omp for schedule(dynamic, 1)
      for (std::size_t b = 0; b < bands.size(); ++b) {
        errors.run([&] {
          if (bands[b].empty) return;
          std::vector<Real>& band = sums[0].of_band[b];
          for (std::size_t g = 1; g < groups; ++g) {
            const Real* __restrict const more = sums[g].of_band[b].data();
            for (std::size_t c = 0; c < columns; ++c) band[c] += more[c];
          }
          band.resize(columns);
          blur_plane(band, box, blur_per_spread * alike.spread * bands[b].distance_m);
        });
      }
#pragma omp single
      errors.run([&] {
        for (std::size_t b = 0; b < bands.size(); ++b) {
          if (bands[b].empty) continue;
          for (std::size_t c = 0; c < columns; ++c) flux[c] += static_cast<double>(sums[0].of_band[b][c]);
        }
        for (const Gathered<Real>& sum : sums) {
          for (std::size_t c = 0; c < columns; ++c) flux[c] += static_cast<double>(sum.beyond[c]);
        }
      });
    }
    errors.rethrow();
  }
  return flux;
}

template <class Real>
std::vector<float> march_level_fluxes(const GatherScene<Real>& scene, bool upward,
                                      const std::vector<GatherDirection>& directions) {
  const BoxGrid& box = scene.box;
  const ActiveRows& rows = scene.cells.rows;
  const std::size_t columns = box.columns();
  const int levels = box.nz() + 1;
  SourceGradients<Real> gradients(scene);
  gradients.prepare(directions);
  std::vector<std::vector<float>> of_group(level_groups);
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t g = 0; g < level_groups; ++g) {
    errors.run([&] {
      std::vector<float>& flux = of_group[g];
      flux.assign(columns * levels, 0.F);
      LinearSource<Real> own;
      std::vector<Real> sent(scene.cells.size() + lane_padding);
      std::vector<Real> rays(columns + lane_padding);
      std::vector<Real> from_ground, side;
      for (std::size_t q = g; q < directions.size(); q += level_groups) {
        const Direction& travel = directions[q].travel;
        const LaunchPlace start = launch_place(q, upward || scene.fill_columns);
        const PathPattern pattern = make_path_pattern(box, travel, start.x, start.y, false, {0, box.nz()});
        const SourceAlong<Real> source = scene.source->along(travel, power(directions[q]));
        const Real weight = static_cast<Real>(power(directions[q]));
        if (upward) {
          const Real* const leaving = scene.ground->along(travel, from_ground);
          for (std::size_t c = 0; c < columns; ++c) rays[c] = weight * leaving[c];
        } else {
          std::fill(rays.begin(), rays.end(), weight * static_cast<Real>(scene.sky_radiance));
        }
        if (!box.periodic && scene.side_radiance) {
          const std::vector<double> by_height = scene.side_radiance(travel);
          side.assign(by_height.begin(), by_height.end());
          for (Real& radiance : side) radiance *= weight;
          if (!upward) std::reverse(side.begin(), side.end());
        }
        const auto at_level = [&](int step, const Real* p) {
          float* const at = flux.data() + columns * (upward ? step : levels - 1 - step);
          // A ray counts for the column it is in: its place there is any.
          for_shifted_rows(pattern.shift_x(step), pattern.shift_y(step), box.nx, box.ny,
                           [&](std::size_t column, std::size_t ray, int n) {
                             float* __restrict const to = at + column;
                             const Real* __restrict const from = p + ray;
                             for (int i = 0; i < n; ++i) to[i] += static_cast<float>(from[i]);
                           });
          if (step == pattern.levels()) return;
          const std::size_t first = rows.level_cell[pattern.level(step)];  // of the cells that are crossed next
          source.fill(first, rows.level_cell[pattern.level(step) + 1] - first, sent.data() + first);
        };
        march<Real, false>(pattern, rows, gradients.along(travel, own), box.periodic, side, sent.data(), rays.data(),
                           nullptr, at_level);
      }
    });
  }
  errors.rethrow();
  for (std::size_t g = 1; g < level_groups; ++g) {
    for (std::size_t c = 0; c < of_group[0].size(); ++c) of_group[0][c] += of_group[g][c];
  }
  return of_group[0];
}

template std::vector<double> gather_flux<float>(const GatherScene<float>&, int, bool,
                                                const std::vector<GatherDirection>&);
template std::vector<double> gather_flux<double>(const GatherScene<double>&, int, bool,
                                                 const std::vector<GatherDirection>&);
template std::vector<float> march_level_fluxes<float>(const GatherScene<float>&, bool,
                                                      const std::vector<GatherDirection>&);
template std::vector<float> march_level_fluxes<double>(const GatherScene<double>&, bool,
                                                       const std::vector<GatherDirection>&);

}  // namespace cloudbow
