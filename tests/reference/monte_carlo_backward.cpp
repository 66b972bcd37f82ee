#include "reference/monte_carlo_backward.hpp"

#include <algorithm>
#include <cmath>

namespace cloudbow::reference {
namespace {

/// Photons of one batch, which run from the sensors against the light.
class BackwardBatch {
 public:
  BackwardBatch(const MonteCarloScene& scene, const Box& box, Random random, std::int64_t photons)
      : scene_(scene), box_(box), random_(random), columns_(scene.columns[0] * scene.columns[1]) {
    const std::size_t all_cells = static_cast<std::size_t>(box.layers()) * columns_;
    std::size_t cells = 0;
    for (std::size_t c = 0; scene.absorption && c < all_cells; ++c) cells += box.absorption(c) > 0;
    const std::size_t sensors = (2 * scene.levels.size() + scene.views.size()) * columns_ + cells;
    photons_ = std::max<std::int64_t>(1, photons / static_cast<std::int64_t>(std::max<std::size_t>(sensors, 1)));
    // The warm matter is seen more often than the sky.
    typical_ = box.surface_planck(0);
    for (std::size_t c = 0; c < all_cells; ++c) typical_ = std::max(typical_, box.planck(c));
  }

  std::vector<double> run() {
    for (const bool up : {true, false}) {
      for (const int level : scene_.levels) {
        for (int c = 0; c < columns_; ++c) tally_.push_back(pi * mean([&](double u) { return flux(level, up, c, u); }));
      }
    }
    const std::size_t cells = scene_.absorption ? static_cast<std::size_t>(box_.layers()) * columns_ : 0;
    for (std::size_t c = 0; c < cells; ++c) {
      const double factor = 4 * pi * box_.absorption(c) * box_.thickness(static_cast<int>(c / columns_));
      tally_.push_back(factor > 0 ? factor * mean([&](double u) { return net_of_cell(c, u); }) : 0);
    }
    for (const View& view : scene_.views) {
      const Vector against = reversed(towards(view.zenith_deg, view.azimuth_deg));
      const int edge = against[2] < 0 ? box_.layers() : 0;
      for (int c = 0; c < columns_; ++c) {
        tally_.push_back(mean([&](double) { return collect(in_column(c, edge, against), typical_); }));
      }
    }
    return std::move(tally_);
  }

 private:
  /// Mean of `collected(uniform)` over photons, the numbers evenly spread from 0 to 1.
  template <class Collected>
  double mean(const Collected& collected) {
    const double n = static_cast<double>(photons_);
    double sum = 0;
    for (std::int64_t p = 0; p < photons_; ++p) sum += collected((static_cast<double>(p) + random_.uniform()) / n);
    return sum / n;
  }

  /// On the plane `edge` of a column, on its way into the layer ahead.
  Photon in_column(int column, int edge, const Vector& direction) {
    Photon p;
    p.i = column % scene_.columns[0];
    p.j = column / scene_.columns[0];
    p.k = direction[2] > 0 ? edge : edge - 1;
    p.position = {(p.i + random_.uniform()) * scene_.column_size_m[0],
                  (p.j + random_.uniform()) * scene_.column_size_m[1], scene_.z_edge_m[edge]};
    p.direction = direction;
    return p;
  }

  /// Radiance of the light that goes through the plane `edge`, drawn by the law of cosines.
  double flux(int edge, bool up, int column, double uniform) {
    const double mu = std::sqrt(uniform), azimuth = 2 * pi * random_.uniform();
    Photon p = in_column(column, edge, at_cosine(up ? -mu : mu, azimuth));
    if (!up && edge == box_.layers()) return scene_.sky_radiance;
    if (up && edge == 0) {
      const double emitted = (1 - scene_.surface_albedo) * (box_.surface_planck(column) - typical_);
      p.weight = scene_.surface_albedo;
      if (p.weight == 0) return typical_ + emitted;
      p.direction[2] = mu;
      p.k = 0;
      return emitted + collect(p, typical_);
    }
    return collect(p, typical_);
  }

  /// Radiance at a point of the cell in a direction, less the Planck radiance of the point.
  double net_of_cell(std::size_t cell, double uniform) {
    const auto layer = static_cast<int>(cell / columns_);
    Photon p =
        in_column(static_cast<int>(cell % columns_), layer, at_cosine(2 * uniform - 1, 2 * pi * random_.uniform()));
    p.k = layer;
    p.position[2] += random_.uniform() * box_.thickness(layer);
    const double planck = box_.planck_at(p);
    return collect(p, planck) - planck;
  }

  /// Planck radiances of the matter that absorbs the photon, by weight. They are summed as differences to `known`,
  /// since the weights have the sum 1. Roulette then adds noise by the differences alone.
  double collect(Photon p, double known) {
    double sum = known;
    for (;;) {
      double depth = -std::log(random_.uniform());
      const Event event = box_.fly(p, depth, [](int) {});
      double kept = 0, planck = 0;
      if (event == Event::collision) {
        const Medium& medium = box_.collision_partner(box_.cell_of(p), random_);
        kept = medium.single_scattering_albedo;
        planck = box_.planck_at(p);
        p.direction = turned(p.direction, medium.scatterer.cosine_at(random_.uniform()), random_);
      } else if (event == Event::surface) {
        kept = scene_.surface_albedo;
        planck = box_.surface_planck(box_.column_of(p));
        p.direction = at_cosine(std::sqrt(random_.uniform()), 2 * pi * random_.uniform());
        p.k = 0;
      } else if (event == Event::top) {
        planck = scene_.sky_radiance;
      }
      sum += p.weight * (1 - kept) * (planck - known);
      p.weight *= kept;
      if (p.weight < least_weight) {
        if (random_.uniform() * survivor_weight >= p.weight) return sum;
        p.weight = survivor_weight;
      }
    }
  }

  const MonteCarloScene& scene_;
  const Box& box_;
  Random random_;
  int columns_;
  std::int64_t photons_ = 1;  // of each sensor
  double typical_ = 0;        // the largest Planck radiance, about
  std::vector<double> tally_;
};

}  // namespace

std::vector<double> backward_batch(const MonteCarloScene& scene, const Box& box, Random random, std::int64_t photons) {
  return BackwardBatch(scene, box, random, photons).run();
}

}  // namespace cloudbow::reference
