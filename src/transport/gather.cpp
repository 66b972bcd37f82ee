#include "cloudbow/transport/gather.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "backward_march.hpp"

namespace cloudbow {
namespace {

constexpr double golden = .6180339887498949;
constexpr double sun_asymmetry = .85;  // how the extra directions crowd about the sun
constexpr double band_growth = 1.6;    // each distance band ends this many times as far as the last
constexpr double class_growth = 1.4;   // directions of one class differ in spread by at most this factor
constexpr int most_classes = 16;
constexpr double blur_per_spread = .3;  // Gaussian width as a fraction of the beam's spread
constexpr double least_blur = .15;      // columns; below it a blur changes nothing
constexpr std::size_t batch = 16;       // directions marched side by side and then added in order

double fraction(double x) { return x - std::floor(x); }

double henyey_greenstein_density(double cosine) {
  const double g = sun_asymmetry;
  return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5) / (4 * std::numbers::pi);
}

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

// Cell-integrated Gaussian, cut at three sigma and at half the row.
std::vector<double> gaussian_kernel(double sigma, int n) {
  const int reach = sigma < least_blur ? 0 : std::min(static_cast<int>(std::ceil(3 * sigma)), n / 2);
  std::vector<double> kernel(2 * reach + 1, 1.);
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    if (reach > 0)
      kernel[i + reach] =
          .5 * (std::erf((i + .5) / sigma / std::numbers::sqrt2) - std::erf((i - .5) / sigma / std::numbers::sqrt2));
    sum += kernel[i + reach];
  }
  for (double& k : kernel) k /= sum;
  return kernel;
}

// Spreads each value over its row; what would fall out of an open side stays in the part of the kernel that is inside.
void blur_row(std::vector<double>& row, const std::vector<double>& kernel, bool periodic,
              std::vector<double>& scratch) {
  const int n = static_cast<int>(row.size());
  const int reach = static_cast<int>(kernel.size()) / 2;
  scratch.assign(row.size(), 0.);
  for (int i = 0; i < n; ++i) {
    if (row[i] == 0) continue;
    if (periodic) {
      for (int d = -reach; d <= reach; ++d) scratch[wrapped(i + d, n)] += row[i] * kernel[d + reach];
    } else {
      const int low = std::max(-reach, -i);
      const int high = std::min(reach, n - 1 - i);
      double inside = 0;
      for (int d = low; d <= high; ++d) inside += kernel[d + reach];
      for (int d = low; d <= high; ++d) scratch[i + d] += row[i] * kernel[d + reach] / inside;
    }
  }
  row = scratch;
}

void blur(std::vector<double>& field, const BoxGrid& box, double sigma_m) {
  const auto kernel_x = gaussian_kernel(sigma_m / box.dx_m, box.nx);
  const auto kernel_y = gaussian_kernel(sigma_m / box.dy_m, box.ny);
  std::vector<double> row, scratch;
  if (kernel_x.size() > 1) {
    row.resize(box.nx);
    for (int j = 0; j < box.ny; ++j) {
      std::copy_n(field.data() + static_cast<std::size_t>(j) * box.nx, box.nx, row.data());
      blur_row(row, kernel_x, box.periodic, scratch);
      std::copy_n(row.data(), box.nx, field.data() + static_cast<std::size_t>(j) * box.nx);
    }
  }
  if (kernel_y.size() > 1) {
    row.resize(box.ny);
    for (int i = 0; i < box.nx; ++i) {
      for (int j = 0; j < box.ny; ++j) row[j] = field[static_cast<std::size_t>(j) * box.nx + i];
      blur_row(row, kernel_y, box.periodic, scratch);
      for (int j = 0; j < box.ny; ++j) field[static_cast<std::size_t>(j) * box.nx + i] = row[j];
    }
  }
}

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
  constexpr double grazing =
      1e-4;  // nothing arrives through a plane from below it, and grazing rays cross endless cells
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

template <class Real>
std::vector<double> gather_flux(const GatherScene<Real>& scene, int edge, bool upward,
                                const std::vector<GatherDirection>& directions) {
  const BoxGrid& box = scene.box;
  const std::size_t columns = box.columns();
  const LevelRange levels = upward ? LevelRange{0, edge} : LevelRange{edge, box.nz()};

  // Directions by class of spread: those of one class are blurred alike.
  double least = beam_spread(directions.front());
  for (const auto& d : directions) least = std::min(least, beam_spread(d));
  const auto class_of = [&](const GatherDirection& d) {
    return std::min(most_classes - 1,
                    static_cast<int>(std::log(beam_spread(d) / least * (1 + 1e-12)) / std::log(class_growth)));
  };
  std::vector<GatherDirection> sorted = directions;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](const auto& a, const auto& b) { return class_of(a) < class_of(b); });

  const PathPattern vertical = make_path_pattern(box, Direction(0, 0, upward ? -1 : 1), .5, .5, true, levels);
  const std::vector<Band> bands = distance_bands(box, scene.cells.rows, vertical);

  std::vector<double> flux(columns, 0.);
  std::vector<std::vector<double>> of_class(bands.size(), std::vector<double>(columns, 0.));
  std::vector<std::vector<std::vector<Real>>> of_direction(batch, std::vector<std::vector<Real>>(bands.size()));
  std::vector<std::vector<Real>> beyond(batch);
  double spread_sum = 0;
  double weight_sum = 0;
  const auto finish_class = [&] {
    if (weight_sum == 0) return;
    const double spread = std::sqrt(spread_sum / weight_sum);  // flux-weighted
#pragma omp parallel for schedule(dynamic, 1)
    for (std::size_t b = 0; b < bands.size(); ++b) {
      if (!bands[b].empty) blur(of_class[b], box, blur_per_spread * spread * bands[b].distance_m);
    }
    for (std::size_t b = 0; b < bands.size(); ++b) {
      for (std::size_t c = 0; c < columns; ++c) flux[c] += of_class[b][c];
      std::fill(of_class[b].begin(), of_class[b].end(), 0.);
    }
    spread_sum = weight_sum = 0;
  };

#pragma omp parallel
  {
    GatherWorkspace<Real> work;
    for (std::size_t first = 0; first < sorted.size();) {
      std::size_t last = first + 1;
      while (last < sorted.size() && last - first < batch && class_of(sorted[last]) == class_of(sorted[first])) ++last;
#pragma omp for schedule(dynamic, 1)
      for (std::size_t q = first; q < last; ++q) {
        const PathPattern pattern = make_path_pattern(box, -sorted[q].travel, .5, .5, false, levels);
        march_back(scene, pattern, bands, sorted[q].travel, work, of_direction[q - first], beyond[q - first]);
      }
#pragma omp for schedule(static)
      for (std::size_t c = 0; c < columns; ++c) {
        for (std::size_t q = first; q < last; ++q) {
          const double power = sorted[q].weight * std::abs(sorted[q].travel.z());
          for (std::size_t b = 0; b < bands.size(); ++b) {
            if (!bands[b].empty) of_class[b][c] += power * static_cast<double>(of_direction[q - first][b][c]);
          }
          flux[c] += power * static_cast<double>(beyond[q - first][c]);
        }
      }
#pragma omp single
      {
        for (std::size_t q = first; q < last; ++q) {
          const double power = sorted[q].weight * std::abs(sorted[q].travel.z());
          const double spread = beam_spread(sorted[q]);
          spread_sum += power * spread * spread;
          weight_sum += power;
        }
      }
      first = last;
      if (first == sorted.size() || class_of(sorted[first]) != class_of(sorted[first - 1])) {
#pragma omp single
        finish_class();
      }
    }
  }
  return flux;
}

template <class Real>
std::vector<float> march_level_fluxes(const GatherScene<Real>& scene, bool upward,
                                      const std::vector<GatherDirection>& directions) {
  const BoxGrid& box = scene.box;
  const std::size_t columns = box.columns();
  const int levels = box.nz() + 1;
  constexpr std::size_t groups = 4;  // fixed, so that sums have one order
  std::vector<std::vector<float>> of_group(groups);
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t g = 0; g < groups; ++g) {
    std::vector<float>& flux = of_group[g];
    flux.assign(columns * levels, 0.F);
    LinearSource<Real> source;
    source.resize(scene.cells.size());
    std::vector<Real> rays;
    std::vector<Real> from_ground;
    for (std::size_t q = g; q < directions.size(); q += groups) {
      const Direction& travel = directions[q].travel;
      scene.source.query(travel, source.value.data());
      source.make_gradient(scene.cells);
      const PathPattern pattern = make_path_pattern(box, travel, .5, .5, false, {0, box.nz()});
      if (upward) {
        const Real* const start_of_rays = scene.ground->along(travel, from_ground);
        rays.assign(start_of_rays, start_of_rays + columns);
        rays.resize(columns + lane_padding);
      } else {
        rays.assign(columns + lane_padding, static_cast<Real>(scene.sky_radiance));
      }
      const float power = static_cast<float>(directions[q].weight * std::abs(travel.z()));
      std::vector<Real> side;
      if (!box.periodic && scene.side_radiance) {
        const std::vector<double> by_height = scene.side_radiance(travel);
        side.assign(by_height.begin(), by_height.end());
        if (!upward) std::reverse(side.begin(), side.end());
      }
      march<Real, false>(pattern, scene.cells.rows, source.view(scene.cells), box.periodic, side, source.value.data(),
                         rays.data(), nullptr, [&](int step, const Real* p) {
                           float* const at = flux.data() + columns * (upward ? step : levels - 1 - step);
                           spread_on_columns(pattern.x[step], pattern.y[step], 1., box.nx, box.ny, box.periodic,
                                             [&](std::size_t column, std::size_t ray, double weight) {
                                               at[column] +=
                                                   power * static_cast<float>(weight) * static_cast<float>(p[ray]);
                                             });
                         });
    }
  }
  for (std::size_t g = 1; g < groups; ++g) {
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
