#include "transport/gather/gather.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/gather/backward_march.hpp"
#include "transport/gather/gather_classes.hpp"
#include "transport/gather/plane_blur.hpp"
#include "transport/gather/source_gradients.hpp"

namespace cloudbow {
namespace {

constexpr double golden = .6180339887498949;
// Nothing arrives through a plane from below it, and grazing rays cross endless cells.
constexpr double grazing = 1e-4;
constexpr double sun_asymmetry = .85;   // how the extra directions crowd about the sun
constexpr double band_growth = 1.6;     // each distance band ends this many times as far as the last
constexpr double blur_per_spread = .3;  // Gaussian width as a fraction of the beam's spread
// Growth of rounded widths. Column fluxes change by .04 %; with that of few directions, which err by more, by .15 %.
constexpr double width_growth = 1.05;
constexpr double width_growth_of_few = 1.25;
constexpr std::size_t few_directions = 64;
// Directions of a quadrant are shared out over this many sums for any number of threads: sums have one order.
constexpr std::size_t groups_of_quadrant = 2;
constexpr std::size_t groups = quadrants * groups_of_quadrant;
constexpr std::size_t worth_threads = 10000;  // fewer columns are added in less time than threads take to start

double fraction(double x) { return x - std::floor(x); }

double henyey_greenstein_density(double cosine) {
  const double g = sun_asymmetry;
  return (1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5) / (4 * std::numbers::pi);
}

// Whether light comes from level k. @param differs light is the difference from a reference: all matter counts.
template <class Real>
bool is_bright(const Cells<Real>& cells, int k, bool differs) {
  return differs ? cells.rows.level_cell[k + 1] > cells.rows.level_cell[k] : cells.sends_light(k);
}

// Bands next to the plane in whose levels all rays are alike become one: its light is the same everywhere.
template <class Real>
std::vector<Band> distance_bands(const BoxGrid& box, const Cells<Real>& cells, const PathPattern& pattern,
                                 bool differs) {
  std::vector<Band> bands;
  double distance = 0;
  int uniform = 0;
  while (box.periodic && uniform < pattern.levels() && cells.rows.is_uniform(pattern.level(uniform))) ++uniform;
  for (int first = 0; first < pattern.levels();) {
    const int last =
        first == 0 ? 1 : std::min(pattern.levels(), std::max(static_cast<int>(band_growth * first), first + 1));
    double thickness = 0;
    bool empty = true;
    for (int step = first; step < last; ++step) {
      const int k = pattern.level(step);
      thickness += box.thickness_m(k);
      empty = empty && !is_bright(cells, k, differs);
    }
    const bool is_uniform = last <= uniform;
    if (is_uniform && !bands.empty()) {
      bands.front().last_step = last;
      bands.front().empty = bands.front().empty && empty;
    } else {
      bands.push_back({first, last, distance + thickness / 2, empty, is_uniform});
    }
    distance += thickness;
    first = last;
  }
  return bands;
}

}  // namespace

std::vector<GatherDirection> gather_directions(int count, bool upward, const std::optional<Direction>& sun_travel) {
  std::vector<GatherDirection> set;
  const double side = upward ? 1 : -1;
  for (int i = 0; i < count; ++i) {
    const double mu = std::sqrt((i + .5) / count);
    const double azimuth = 2 * std::numbers::pi * fraction(golden * i);
    const double sine = std::sqrt(1 - mu * mu);
    const double spacing = std::numbers::pi / (count * mu);
    set.push_back({{sine * std::cos(azimuth), sine * std::sin(azimuth), side * mu}, spacing, spacing});
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
    if (travel.z() * side > grazing) set.push_back({travel, 0., 1 / (extra * henyey_greenstein_density(cosine))});
  }
  double sum = 0;
  for (GatherDirection& d : set) {
    d.weight = 1 / (count * std::abs(d.travel.z()) / std::numbers::pi +
                    extra * henyey_greenstein_density(d.travel.dot(*sun_travel)));
    sum += power(d);
  }
  for (GatherDirection& d : set) d.weight *= std::numbers::pi / sum;  // exact for isotropic light, as the spiral alone
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
    const double spacing = 1 / (static_cast<double>(angles.size()) * angles[i].density);
    if (travel.z() < -grazing) set.push_back({travel, spacing, spacing});
  }
  return set;
}

namespace {

// The sums of quadrants that other ranks have marched come to the first rank.
// @param lit quadrants in which there are directions.
// @param sums the first of each quadrant is that of the quadrant.
template <class Real>
void collect_sums(const OrdinateShare& share, bool upward, const std::array<bool, quadrants>& lit,
                  const std::vector<Band>& bands, std::size_t columns, std::vector<Gathered<Real>>& sums) {
  std::vector<Ranks::Outgoing> outgoing;
  std::vector<Ranks::Incoming> incoming;
  for (int quadrant = 0; quadrant < quadrants; ++quadrant) {
    if (!lit[static_cast<std::size_t>(quadrant)]) continue;
    const int octant = quadrant + (upward ? octants / 2 : 0);
    const int owner = share.owner_of_octant(octant);
    if (owner == 0 || (!share.is_first() && !share.has_octant(octant))) continue;
    Gathered<Real>& sum = sums[static_cast<std::size_t>(quadrant) * groups_of_quadrant];
    if (share.is_first()) sum.clear(bands.size(), columns);
    const auto move = [&](std::vector<Real>& values) {
      const std::span of_columns(values.data(), columns);
      if (share.is_first()) {
        incoming.push_back({owner, std::as_writable_bytes(of_columns)});
      } else {
        outgoing.push_back({0, std::as_bytes(of_columns)});
      }
    };
    for (std::size_t b = 0; b < bands.size(); ++b) {
      if (!bands[b].empty) move(sum.of_band[b]);
    }
    move(sum.beyond);
  }
  share.ranks().exchange(outgoing, incoming);
}

}  // namespace

template <class Real>
std::vector<double> gather_flux(const GatherScene<Real>& scene, int edge, bool upward,
                                const std::vector<GatherDirection>& directions, const OrdinateShare* share) {
  const BoxGrid& box = scene.box;
  const std::size_t columns = box.columns();
  const LevelRange levels = upward ? LevelRange{0, edge} : LevelRange{edge, box.nz()};
  std::vector<GatherDirection> sorted = directions;
  const std::vector<SpreadClass> classes = spread_classes(sorted);
  const PathPattern vertical = make_path_pattern(box, Direction(0, 0, upward ? -1 : 1), .5, .5, true, levels);
  const std::vector<Band> bands = distance_bands(box, scene.cells, vertical, scene.reference != 0);

  // Downward, a few directions near the sun's carry much of the light, so their rays start at the centre.
  const bool lit_at_plane = vertical.levels() > 0 && is_bright(scene.cells, vertical.level(0), scene.reference != 0);
  const bool filling = scene.fill_columns || (upward && lit_at_plane);

  double powers = 0;
  for (const GatherDirection& direction : sorted) powers += power(direction);
  std::vector<double> flux(columns, powers * scene.reference);
  std::vector<Gathered<Real>> sums(groups);
  const BlurWidths widths(box, directions.size() < few_directions ? width_growth_of_few : width_growth);
  std::vector<std::vector<Real>> planes(static_cast<std::size_t>(widths.count()));  // light by the width of its blur
  const auto is_here = [&](int quadrant) {
    return share == nullptr || share->has_octant(quadrant + (upward ? octants / 2 : 0));
  };
  for (const SpreadClass& alike : classes) {
    const auto of_quadrant = by_quadrant(sorted, alike.first, alike.last);
    const auto has_directions = [&](std::size_t g) {
      return g % groups_of_quadrant < of_quadrant[g / groups_of_quadrant].size();
    };
    std::array<bool, quadrants> lit{};
    for (std::size_t quadrant = 0; quadrant < quadrants; ++quadrant) lit[quadrant] = !of_quadrant[quadrant].empty();
    ParallelErrors errors;
#pragma omp parallel
    {
      GatherWorkspace<Real> work;
#pragma omp for schedule(dynamic, 1)
      for (std::size_t g = 0; g < groups; ++g) {
        errors.run([&] {
          const std::size_t quadrant = g / groups_of_quadrant;
          if (!is_here(static_cast<int>(quadrant)) || !has_directions(g)) return;
          const std::vector<std::size_t>& own = of_quadrant[quadrant];
          sums[g].clear(bands.size(), columns);
          for (std::size_t i = g % groups_of_quadrant; i < own.size(); i += groups_of_quadrant) {
            const std::size_t q = own[i];
            const Direction& travel = sorted[q].travel;
            const LaunchPlace start = launch_place(q, filling);
            work.source.start(scene, travel);
            march_back(scene, scene.path(make_path_pattern(box, -travel, start.x, start.y, false, levels)), bands,
                       travel, static_cast<Real>(power(sorted[q])), work, sums[g]);
          }
        });
      }
      // Nothing throws here.
#pragma omp for collapse(2) schedule(dynamic, 1)
      for (std::size_t quadrant = 0; quadrant < quadrants; ++quadrant) {
        for (std::size_t b = 0; b <= bands.size(); ++b) {
          if (!is_here(static_cast<int>(quadrant)) || !lit[quadrant] || (b < bands.size() && bands[b].empty)) continue;
          const auto values = [&](Gathered<Real>& sum) {
            return b < bands.size() ? sum.of_band[b].data() : sum.beyond.data();
          };
          Real* __restrict const to = values(sums[quadrant * groups_of_quadrant]);
          for (std::size_t g = 1; g < groups_of_quadrant; ++g) {
            if (!has_directions(quadrant * groups_of_quadrant + g)) continue;
            const Real* __restrict const more = values(sums[quadrant * groups_of_quadrant + g]);
            for (std::size_t c = 0; c < columns; ++c) to[c] += more[c];
          }
        }
      }
    }
    errors.rethrow();
    if (share != nullptr) collect_sums(*share, upward, lit, bands, columns, sums);
    if (share != nullptr && !share->is_first()) continue;
    for (std::size_t quadrant = 0; quadrant < quadrants; ++quadrant) {
      if (!lit[quadrant]) continue;
      const Gathered<Real>& sum = sums[quadrant * groups_of_quadrant];
      for (std::size_t b = 0; b < bands.size(); ++b) {
        if (bands[b].empty) continue;
        const double width_m = bands[b].same_everywhere ? 0 : blur_per_spread * alike.spread * bands[b].distance_m;
        std::vector<Real>& plane = planes[static_cast<std::size_t>(widths.number(width_m))];
        plane.resize(columns);
        const Real* __restrict const band = sum.of_band[b].data();
        // Nothing throws here.
#pragma omp parallel for simd schedule(static) if (columns > worth_threads)
        for (std::size_t c = 0; c < columns; ++c) plane[c] += band[c];
      }
      for (std::size_t c = 0; c < columns; ++c) flux[c] += static_cast<double>(sum.beyond[c]);
    }
  }
  if (share != nullptr && !share->is_first()) return {};
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t width = 0; width < planes.size(); ++width) {
    errors.run([&] {
      if (!planes[width].empty()) blur_plane(planes[width], box, widths.width_m(static_cast<int>(width)));
    });
  }
  errors.rethrow();
  for (const std::vector<Real>& plane : planes) {
    for (std::size_t c = 0; c < plane.size(); ++c) flux[c] += static_cast<double>(plane[c]);
  }
  return flux;
}

template std::vector<double> gather_flux<float>(const GatherScene<float>&, int, bool,
                                                const std::vector<GatherDirection>&, const OrdinateShare*);
template std::vector<double> gather_flux<double>(const GatherScene<double>&, int, bool,
                                                 const std::vector<GatherDirection>&, const OrdinateShare*);

}  // namespace cloudbow
