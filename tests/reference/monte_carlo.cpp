#include "reference/monte_carlo.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "reference/monte_carlo_backward.hpp"
#include "reference/photon_box.hpp"

namespace cloudbow::reference {
namespace {

constexpr double least_contribution = 0.3;  // in units of an isotropic scattering that nothing dims

/// Sources of thermal emission and sky, by power.
class Emitters {
 public:
  Emitters(const MonteCarloScene& scene, const Box& box) : columns_(scene.columns[0] * scene.columns[1]) {
    cumulative_.push_back(pi * scene.sky_radiance);
    const auto add = [&](double power) { cumulative_.push_back(cumulative_.back() + power / columns_); };
    for (int c = 0; c < columns_; ++c) add(pi * (1 - scene.surface_albedo) * box.surface_planck(c));
    const std::size_t cells = scene.emission.planck.size();
    for (std::size_t c = 0; c < cells; ++c) add(box.emitted(c));
  }

  double power() const { return cumulative_.back(); }  // by area of the domain

  /// Below a share `uniform` of the power: -1 for the sky, then the columns of the surface, then the cells.
  int at(double uniform) const {
    const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, uniform * power());
    return static_cast<int>(above - cumulative_.begin()) - 1;
  }

 private:
  int columns_;
  std::vector<double> cumulative_;
};

/// One batch: its photons and their tallies, plane after plane as in MonteCarloResult.
class Batch {
 public:
  Batch(const MonteCarloScene& scene, const Box& box, const Emitters& emitters, std::uint64_t seed, int number)
      : scene_(scene),
        box_(box),
        emitters_(emitters),
        random_(seed, static_cast<std::uint64_t>(number)),
        columns_(scene.columns[0] * scene.columns[1]),
        level_(scene.z_edge_m.size(), -1),
        sun_(reversed(towards(scene.sun_zenith_deg, scene.sun_azimuth_deg))) {
    const int levels = static_cast<int>(scene.levels.size());
    for (int n = 0; n < levels; ++n) level_[scene.levels[n]] = n;
    first_down_ = static_cast<std::size_t>(levels) * columns_;
    first_circumsolar_ = 2 * first_down_;
    first_absorbed_ = (scene.circumsolar_deg > 0 ? 3 : 2) * first_down_;
    cone_cosine_ = scene.circumsolar_deg > 0 ? std::cos(scene.circumsolar_deg * pi / 180) : 2;
    first_radiance_ = first_absorbed_ + (scene.absorption ? static_cast<std::size_t>(box.layers()) * columns_ : 0);
    for (const View& view : scene.views) view_.push_back(towards(view.zenith_deg, view.azimuth_deg));
    tally_.resize(first_radiance_ + view_.size() * columns_);
    for (double& shift : shift_) shift = random_.uniform();
    lit_area_ = {std::abs(sun_[0]) * box.width(1), std::abs(sun_[1]) * box.width(0),
                 -sun_[2] * box.width(0) * box.width(1)};
    for (int axis = 0; axis < 2; ++axis) lit_area_[axis] *= scene.open_sides ? box.height() : 0;
  }

  std::vector<double> run(std::int64_t photons) {
    const double of_sun = scene_.sun_flux * (lit_area_[0] + lit_area_[1] + lit_area_[2]) / lit_area_[2];
    const double power = of_sun + emitters_.power();
    // Both kinds get photons by their power, and a photon of each stands for as much power but for rounding.
    const std::int64_t from_sun = power > 0 ? std::llround(static_cast<double>(photons) * of_sun / power) : 0;
    strength_ = from_sun > 0 ? of_sun * columns_ / static_cast<double>(from_sun) : 0;
    for (std::int64_t n = 0; n < from_sun; ++n) follow(start(n));
    const std::int64_t emitted = photons - from_sun;
    strength_ = emitted > 0 ? emitters_.power() * columns_ / static_cast<double>(emitted) : 0;
    for (std::int64_t n = 0; n < emitted; ++n) {
      follow(emit((static_cast<double>(n) + random_.uniform()) / static_cast<double>(emitted)));
    }
    const std::size_t cells = scene_.absorption ? scene_.emission.planck.size() : 0;
    for (std::size_t c = 0; c < cells; ++c) tally_[first_absorbed_ + c] -= box_.emitted(c);
    return std::move(tally_);
  }

 private:
  /// Entry points of sunlight follow an additive sequence in the plane (Roberts' R2, powers of the root of
  /// x^3 = x + 1). It is shifted at random in each batch. The points are evenly spread over the columns, unlike plain
  /// random points.
  Photon start(std::int64_t n) {
    constexpr double step[2] = {0.7548776662466927, 0.5698402909980532};
    double u[2];
    for (int a = 0; a < 2; ++a) {
      u[a] = shift_[a] + static_cast<double>(n) * step[a];
      u[a] -= std::floor(u[a]);
    }
    Photon p;
    p.direction = sun_;
    const double at = random_.uniform() * (lit_area_[0] + lit_area_[1] + lit_area_[2]);
    const double bottom = box_.bottom();
    const auto entry = [&](int axis) { return sun_[axis] > 0 ? 0.0 : box_.width(axis); };
    if (at < lit_area_[2]) {
      p.position = {u[0] * box_.width(0), u[1] * box_.width(1), scene_.z_edge_m.back()};
    } else if (at < lit_area_[2] + lit_area_[0]) {
      p.position = {entry(0), u[0] * box_.width(1), bottom + u[1] * box_.height()};
    } else {
      p.position = {u[0] * box_.width(0), entry(1), bottom + u[1] * box_.height()};
    }
    const auto above = std::lower_bound(scene_.z_edge_m.begin() + 1, scene_.z_edge_m.end() - 1, p.position[2]);
    p.k = static_cast<int>(above - scene_.z_edge_m.begin()) - 1;
    box_.locate(p);
    if (p.position[2] == scene_.z_edge_m.back()) count(p, box_.layers());
    return p;
  }

  /// A photon of the source below a share `uniform` of the emitted power.
  Photon emit(double uniform) {
    const int source = emitters_.at(uniform), nx = scene_.columns[0];
    Photon p;
    p.diffuse = true;
    if (source < 0) {
      p.position = {random_.uniform() * box_.width(0), random_.uniform() * box_.width(1), scene_.z_edge_m.back()};
      p.k = box_.layers() - 1;
      box_.locate(p);
      leave_plane(p, false);
      return p;
    }
    const int column = source % columns_;
    p.i = column % nx;
    p.j = column / nx;
    p.position = {(p.i + random_.uniform()) * scene_.column_size_m[0],
                  (p.j + random_.uniform()) * scene_.column_size_m[1], box_.bottom()};
    if (source < columns_) {
      leave_plane(p, true);
      return p;
    }
    p.k = source / columns_ - 1;
    // The density is linear in height, as B is.
    const std::size_t cell = box_.cell_of(p);
    const double u = random_.uniform(), s = box_.planck_step(cell) / (2 * box_.planck(cell));
    const double height = 2 * u / (1 - s + std::sqrt((1 - s) * (1 - s) + 4 * s * u));
    p.position[2] = scene_.z_edge_m[p.k] + height * box_.thickness(p.k);
    for (std::size_t v = 0; v < view_.size(); ++v) estimate(p, v, 1);
    p.direction = at_cosine(2 * random_.uniform() - 1, 2 * pi * random_.uniform());
    return p;
  }

  /// From the surface upwards or from the sky downwards, by the law of cosines.
  void leave_plane(Photon& p, bool up) {
    for (std::size_t v = 0; v < view_.size(); ++v) {
      if ((view_[v][2] > 0) == up) estimate(p, v, p.weight * 4 * std::abs(view_[v][2]));
    }
    const double mu = std::sqrt(random_.uniform());
    p.direction = at_cosine(up ? mu : -mu, 2 * pi * random_.uniform());
    count(p, up ? 0 : box_.layers());
  }

  void follow(Photon p) {
    const auto crossed = [&](int edge) { count(p, edge); };
    for (;;) {
      double depth = -std::log(random_.uniform());
      const Event event = box_.fly(p, depth, crossed);
      if (event == Event::collision) {
        scatter(p);
      } else if (event == Event::surface) {
        reflect(p);
      } else {
        return;
      }
      if (p.weight < least_weight) {
        if (random_.uniform() * survivor_weight >= p.weight) return;
        p.weight = survivor_weight;
      }
    }
  }

  void count(const Photon& p, int edge) {
    if (level_[edge] < 0) return;
    const std::size_t at = static_cast<std::size_t>(level_[edge]) * columns_ + box_.column_of(p);
    tally_[(p.direction[2] > 0 ? 0 : first_down_) + at] += strength_ * p.weight;
    if (const double cosine = dot(p.direction, sun_); p.diffuse && p.direction[2] < 0 && cosine >= cone_cosine_)
      tally_[first_circumsolar_ + at] += strength_ * p.weight * cosine / -p.direction[2];
  }

  void scatter(Photon& p) {
    const std::size_t cell = box_.cell_of(p);
    const Medium& medium = box_.collision_partner(cell, random_);
    if (scene_.absorption)
      tally_[first_absorbed_ + cell] += strength_ * p.weight * (1 - medium.single_scattering_albedo);
    p.weight *= medium.single_scattering_albedo;
    for (std::size_t v = 0; v < view_.size(); ++v) {
      estimate(p, v, p.weight * medium.scatterer(dot(p.direction, view_[v])));
    }
    p.diffuse = true;
    p.direction = turned(p.direction, medium.scatterer.cosine_at(random_.uniform()), random_);
  }

  void reflect(Photon& p) {
    p.weight *= scene_.surface_albedo;
    p.diffuse = true;
    p.k = 0;
    if (p.weight > 0) leave_plane(p, true);
  }

  /// Adds the contribution of this event to a sensor: `strength` is 4 pi times the power per steradian, before
  /// attenuation on the way to it. A contribution below the least continues at the least, with their ratio as
  /// probability. One draw determines beforehand the depth at which it ends.
  void estimate(const Photon& p, std::size_t view, double strength) {
    const double deepest = std::log(strength / (least_contribution * random_.uniform()));
    if (!(deepest > 0)) return;
    Photon ray = p;
    ray.direction = view_[view];
    double depth = deepest;
    const Event event = box_.fly(ray, depth, [](int) {});
    if (event != (view_[view][2] > 0 ? Event::top : Event::surface)) return;
    const double arriving = std::max(strength * std::exp(depth - deepest), least_contribution);
    tally_[first_radiance_ + view * columns_ + box_.column_of(ray)] +=
        strength_ * arriving / (4 * pi * std::abs(view_[view][2]));
  }

  const MonteCarloScene& scene_;
  const Box& box_;
  const Emitters& emitters_;
  Random random_;
  int columns_;
  std::vector<int> level_;  // edge to index of the level, -1: not counted
  Vector sun_;              // direction of travel
  std::vector<Vector> view_;
  std::size_t first_down_ = 0, first_circumsolar_ = 0, first_absorbed_ = 0, first_radiance_ = 0;
  double cone_cosine_ = 2;  // of its half angle; 2: nothing is counted
  Vector lit_area_{};       // seen along the beam: sides across x, across y, top
  std::array<double, 2> shift_{};
  double strength_ = 1;  // power of a photon of weight 1, by area of a column
  std::vector<double> tally_;
};

/// Mean and standard error of the mean of one number a batch.
std::array<double, 2> mean_and_error(std::span<const double> batch) {
  double mean = 0, square = 0;
  const double n = static_cast<double>(batch.size());
  for (const double value : batch) mean += value / n;
  for (const double value : batch) square += (value - mean) * (value - mean);
  return {mean, std::sqrt(square / (n * (n - 1)))};
}

std::vector<Plane> planes(const std::vector<std::vector<double>>& batch, std::size_t& first, std::size_t count,
                          std::size_t columns) {
  std::vector<Plane> result(count);
  std::vector<double> sample(batch.size());
  for (Plane& plane : result) {
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t b = 0; b < batch.size(); ++b) sample[b] = batch[b][first + c];
      const auto [value, error] = mean_and_error(sample);
      plane.value.push_back(value);
      plane.standard_error.push_back(error);
    }
    for (std::size_t b = 0; b < batch.size(); ++b) {
      sample[b] = 0;
      for (std::size_t c = 0; c < columns; ++c) sample[b] += batch[b][first + c] / static_cast<double>(columns);
    }
    const auto [value, error] = mean_and_error(sample);
    plane.mean = value;
    plane.mean_standard_error = error;
    first += columns;
  }
  return result;
}

}  // namespace

MonteCarloResult solve_by_monte_carlo(const MonteCarloScene& scene, const MonteCarloEffort& effort) {
  assert(effort.batches >= 2);
  if (effort.backward && (scene.sun_flux != 0 || scene.circumsolar_deg > 0))
    throw std::invalid_argument("backward photons do not find the sun");
  const Box box(scene);
  const Emitters emitters(scene, box);
  const std::int64_t photons = effort.photons / effort.batches;
  std::vector<std::vector<double>> batch(effort.batches);
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int b = next++; b < effort.batches; b = next++) {
      batch[b] = effort.backward ? backward_batch(scene, box, Random(effort.seed, b), photons)
                                 : Batch(scene, box, emitters, effort.seed, b).run(photons);
    }
  };
  std::vector<std::thread> others;
  for (int t = 1; t < effort.threads; ++t) others.emplace_back(work);
  work();
  for (std::thread& thread : others) thread.join();

  const auto columns = static_cast<std::size_t>(scene.columns[0]) * scene.columns[1];
  std::size_t first = 0;
  MonteCarloResult result;
  result.up = planes(batch, first, scene.levels.size(), columns);
  result.down = planes(batch, first, scene.levels.size(), columns);
  result.circumsolar = planes(batch, first, scene.circumsolar_deg > 0 ? scene.levels.size() : 0, columns);
  result.absorbed = planes(batch, first, scene.absorption ? scene.z_edge_m.size() - 1 : 0, columns);
  result.radiance = planes(batch, first, scene.views.size(), columns);
  return result;
}

}  // namespace cloudbow::reference
