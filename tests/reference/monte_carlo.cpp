#include "reference/monte_carlo.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>
#include <thread>

namespace cloudbow::reference {
namespace {

using std::numbers::pi;
using Vector = std::array<double, 3>;

constexpr double least_weight = 0.1, survivor_weight = 0.5;
constexpr double least_contribution = 0.3;  // in units of an isotropic scattering that nothing dims

/// xoshiro256++ (Blackman & Vigna 2021), seeded by SplitMix64: a stream of its own for every seed and batch.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t batch) {
    std::uint64_t counter = seed * 0xd1342543de82ef95u + batch * 0x2545f4914f6cdd1du;
    for (auto& word : state_) {
      counter += 0x9e3779b97f4a7c15u;
      std::uint64_t z = counter;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      word = z ^ (z >> 31);
    }
  }

  /// In (0, 1), both ends left out.
  double uniform() { return (static_cast<double>(next() >> 12) + 0.5) * 0x1p-52; }

 private:
  std::uint64_t next() {
    const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0], shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }
  std::array<std::uint64_t, 4> state_;
};

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Unit vector towards a point of the sky.
Vector towards(double zenith_deg, double azimuth_deg) {
  const double zenith = zenith_deg * pi / 180, azimuth = azimuth_deg * pi / 180;
  return {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth), std::cos(zenith)};
}

Vector reversed(const Vector& v) { return {-v[0], -v[1], -v[2]}; }

/// Turned by the angle of the given cosine, at an azimuth about `d` that is drawn.
Vector turned(const Vector& d, double cosine, Random& random) {
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine)), azimuth = 2 * pi * random.uniform();
  const double a = sine * std::cos(azimuth), b = sine * std::sin(azimuth);
  const double horizontal_square = d[0] * d[0] + d[1] * d[1];
  if (horizontal_square < 1e-12) return {a, b, d[2] > 0 ? cosine : -cosine};
  const double h = std::sqrt(horizontal_square);
  Vector to = {cosine * d[0] + (a * d[0] * d[2] - b * d[1]) / h, cosine * d[1] + (a * d[1] * d[2] + b * d[0]) / h,
               cosine * d[2] - a * h};
  const double scale = 1.5 - 0.5 * dot(to, to);  // a Newton step towards unit length: rounding does not pile up
  for (double& component : to) component *= scale;
  return to;
}

struct Photon {
  Vector position, direction;
  int i = 0, j = 0, k = 0;  // i and j hold only in layers that are not uniform, until `locate`
  double weight = 1;
};

enum class Event { collision, top, surface, side };

/// The scene, prepared for flights.
class Box {
 public:
  explicit Box(const MonteCarloScene& scene)
      : scene_(scene),
        nx_(scene.columns[0]),
        ny_(scene.columns[1]),
        nz_(static_cast<int>(scene.z_edge_m.size()) - 1),
        width_{nx_ * scene.column_size_m[0], ny_ * scene.column_size_m[1]},
        extinction_(static_cast<std::size_t>(nx_) * ny_ * nz_, 0.0),
        uniform_(nz_, 1) {
    const std::size_t columns = static_cast<std::size_t>(nx_) * ny_;
    for (const Medium& medium : scene.media) {
      assert(medium.extinction.size() == extinction_.size());
      for (std::size_t c = 0; c < extinction_.size(); ++c) {
        extinction_[c] += medium.extinction[c];
        if (medium.extinction[c] != medium.extinction[c / columns * columns]) uniform_[c / columns] = 0;
      }
    }
  }

  int column_of(const Photon& p) const { return p.j * nx_ + p.i; }
  std::size_t cell_of(const Photon& p) const {
    return static_cast<std::size_t>(p.k) * nx_ * ny_ + static_cast<std::size_t>(column_of(p));
  }
  double width(int axis) const { return width_[axis]; }
  double height() const { return scene_.z_edge_m.back() - scene_.z_edge_m.front(); }
  int layers() const { return nz_; }
  double extinction(std::size_t cell) const { return extinction_[cell]; }

  /// Brings a photon back between the sides and finds its column.
  void locate(Photon& p) const {
    std::array<int, 2> index{};
    for (int axis = 0; axis < 2; ++axis) {
      if (!scene_.open_sides) p.position[axis] -= width_[axis] * std::floor(p.position[axis] / width_[axis]);
      index[axis] =
          std::clamp(static_cast<int>(p.position[axis] / scene_.column_size_m[axis]), 0, scene_.columns[axis] - 1);
    }
    p.i = index[0];
    p.j = index[1];
  }

  /// Moves the photon until `depth` is used up or the photon leaves; the remainder stays in `depth`. Calls
  /// `crossed(edge)` for the horizontal faces on the way, the last included.
  template <class Crossed>
  Event fly(Photon& p, double& depth, const Crossed& crossed) const {
    Vector& x = p.position;
    const Vector& d = p.direction;
    Vector inverse;
    for (int axis = 0; axis < 3; ++axis) inverse[axis] = d[axis] == 0 ? 1e300 : 1 / d[axis];
    const int forth_x = d[0] >= 0, forth_y = d[1] >= 0, up = d[2] >= 0;
    const double dx = scene_.column_size_m[0], dy = scene_.column_size_m[1];
    for (;;) {
      const bool uniform = uniform_[p.k] != 0;
      double length = (scene_.z_edge_m[p.k + up] - x[2]) * inverse[2];
      int axis = 2;
      // A uniform layer is one cell as wide as the box, and with periodic sides has no sides at all.
      double face_x = 0, face_y = 0;
      if (!uniform || scene_.open_sides) {
        face_x = uniform ? forth_x * width_[0] : (p.i + forth_x) * dx;
        face_y = uniform ? forth_y * width_[1] : (p.j + forth_y) * dy;
        const double along_x = (face_x - x[0]) * inverse[0], along_y = (face_y - x[1]) * inverse[1];
        if (along_x < length) {
          length = along_x;
          axis = 0;
        }
        if (along_y < length) {
          length = along_y;
          axis = 1;
        }
      }
      length = std::max(length, 0.0);
      const std::size_t column = uniform ? 0 : static_cast<std::size_t>(column_of(p));
      const double extinction = extinction_[static_cast<std::size_t>(p.k) * nx_ * ny_ + column];
      const bool collides = extinction * length >= depth;
      if (collides) length = depth / extinction;
      for (int a = 0; a < 3; ++a) x[a] += length * d[a];
      if (collides) {
        depth = 0;
        if (uniform) locate(p);
        return Event::collision;
      }
      depth -= extinction * length;
      if (axis == 2) {
        const int edge = p.k + up;
        x[2] = scene_.z_edge_m[edge];
        if (uniform) locate(p);
        crossed(edge);
        p.k += up ? 1 : -1;
        if (p.k == nz_) return Event::top;
        if (p.k < 0) return Event::surface;
      } else if (uniform || !step_sideways(p, axis, axis == 0 ? forth_x : forth_y, axis == 0 ? face_x : face_y)) {
        return Event::side;
      }
    }
  }

 private:
  /// Into the next column; false if the photon has left through an open side.
  bool step_sideways(Photon& p, int axis, int forth, double face) const {
    int& index = axis == 0 ? p.i : p.j;
    p.position[axis] = face;
    index += forth ? 1 : -1;
    if (index < 0 || index == scene_.columns[axis]) {
      if (scene_.open_sides) return false;
      index = forth ? 0 : scene_.columns[axis] - 1;
      p.position[axis] = forth ? 0 : width_[axis];
    }
    return true;
  }

  const MonteCarloScene& scene_;
  int nx_, ny_, nz_;
  std::array<double, 2> width_;
  std::vector<double> extinction_;  // of all media
  std::vector<char> uniform_;       // layers in which all columns are equal
};

/// One batch: its photons and their tallies, plane after plane as in MonteCarloResult.
class Batch {
 public:
  Batch(const MonteCarloScene& scene, const Box& box, std::uint64_t seed, int number)
      : scene_(scene),
        box_(box),
        random_(seed, static_cast<std::uint64_t>(number)),
        columns_(scene.columns[0] * scene.columns[1]),
        level_(scene.z_edge_m.size(), -1),
        sun_(reversed(towards(scene.sun_zenith_deg, scene.sun_azimuth_deg))) {
    const int levels = static_cast<int>(scene.levels.size());
    for (int n = 0; n < levels; ++n) level_[scene.levels[n]] = n;
    first_down_ = static_cast<std::size_t>(levels) * columns_;
    first_absorbed_ = 2 * first_down_;
    first_radiance_ = first_absorbed_ + (scene.absorption ? static_cast<std::size_t>(box.layers()) * columns_ : 0);
    for (const View& view : scene.views) view_.push_back(towards(view.zenith_deg, view.azimuth_deg));
    tally_.resize(first_radiance_ + view_.size() * columns_);
    for (double& shift : shift_) shift = random_.uniform();
    lit_area_ = {std::abs(sun_[0]) * box.width(1), std::abs(sun_[1]) * box.width(0),
                 -sun_[2] * box.width(0) * box.width(1)};
    for (int axis = 0; axis < 2; ++axis) lit_area_[axis] *= scene.open_sides ? box.height() : 0;
  }

  std::vector<double> run(std::int64_t photons) {
    for (std::int64_t n = 0; n < photons; ++n) follow(start(n));
    const double power = (lit_area_[0] + lit_area_[1] + lit_area_[2]) / lit_area_[2];
    for (double& value : tally_) value *= power * columns_ / static_cast<double>(photons);
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
    const double bottom = scene_.z_edge_m.front();
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
    return p;
  }

  void follow(Photon p) {
    const auto crossed = [&](int edge) { count(p, edge); };
    if (p.position[2] == scene_.z_edge_m.back()) crossed(box_.layers());
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
    tally_[(p.direction[2] > 0 ? 0 : first_down_) + static_cast<std::size_t>(level_[edge]) * columns_ +
           box_.column_of(p)] += p.weight;
  }

  const Medium& collision_partner(std::size_t cell) {
    if (scene_.media.size() == 1) return scene_.media.front();
    double at = random_.uniform() * box_.extinction(cell);
    for (const Medium& medium : scene_.media) {
      at -= medium.extinction[cell];
      if (at < 0) return medium;
    }
    return scene_.media.back();
  }

  void scatter(Photon& p) {
    const std::size_t cell = box_.cell_of(p);
    const Medium& medium = collision_partner(cell);
    if (scene_.absorption) tally_[first_absorbed_ + cell] += p.weight * (1 - medium.single_scattering_albedo);
    p.weight *= medium.single_scattering_albedo;
    for (std::size_t v = 0; v < view_.size(); ++v) {
      estimate(p, v, p.weight * medium.scatterer(dot(p.direction, view_[v])));
    }
    p.direction = turned(p.direction, medium.scatterer.cosine_at(random_.uniform()), random_);
  }

  void reflect(Photon& p) {
    p.weight *= scene_.surface_albedo;
    if (p.weight == 0) return;
    p.k = 0;
    for (std::size_t v = 0; v < view_.size(); ++v) {
      if (view_[v][2] > 0) estimate(p, v, p.weight * 4 * view_[v][2]);
    }
    const double mu = std::sqrt(random_.uniform()), sine = std::sqrt(1 - mu * mu);
    const double azimuth = 2 * pi * random_.uniform();
    p.direction = {sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
    count(p, 0);
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
    tally_[first_radiance_ + view * columns_ + box_.column_of(ray)] += arriving / (4 * pi * std::abs(view_[view][2]));
  }

  const MonteCarloScene& scene_;
  const Box& box_;
  Random random_;
  int columns_;
  std::vector<int> level_;  // edge to index of the level, -1: not counted
  Vector sun_;              // direction of travel
  std::vector<Vector> view_;
  std::size_t first_down_ = 0, first_absorbed_ = 0, first_radiance_ = 0;
  Vector lit_area_{};  // seen along the beam: sides across x, across y, top
  std::array<double, 2> shift_{};
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

Scatterer Scatterer::isotropic() { return {}; }

Scatterer Scatterer::rayleigh() {
  Scatterer result;
  result.kind_ = Kind::rayleigh;
  return result;
}

Scatterer Scatterer::henyey_greenstein(double g) {
  assert(std::abs(g) < 1);
  Scatterer result;
  result.kind_ = std::abs(g) < 1e-6 ? Kind::isotropic : Kind::henyey_greenstein;
  result.g_ = g;
  return result;
}

Scatterer Scatterer::table(std::span<const double> angle_deg, std::span<const double> value) {
  assert(angle_deg.size() == value.size() && angle_deg.size() >= 2);
  Scatterer result;
  result.kind_ = Kind::table;
  for (std::size_t n = angle_deg.size(); n-- > 0;) {
    result.cosine_.push_back(std::cos(angle_deg[n] * pi / 180));
    result.value_.push_back(value[n]);
  }
  result.cosine_.front() = -1;
  result.cosine_.back() = 1;
  result.cumulative_ = {0.0};
  for (std::size_t n = 1; n < value.size(); ++n) {
    result.cumulative_.push_back(result.cumulative_.back() + (result.cosine_[n] - result.cosine_[n - 1]) *
                                                                 (result.value_[n] + result.value_[n - 1]) / 2);
  }
  const double mean = result.cumulative_.back() / 2;
  for (double& v : result.value_) v /= mean;
  for (double& c : result.cumulative_) c /= 2 * mean;
  return result;
}

double Scatterer::operator()(double cos_angle) const {
  switch (kind_) {
    case Kind::isotropic:
      return 1;
    case Kind::rayleigh:
      return 0.75 * (1 + cos_angle * cos_angle);
    case Kind::henyey_greenstein: {
      const double square = 1 + g_ * g_ - 2 * g_ * cos_angle;
      return (1 - g_ * g_) / (square * std::sqrt(square));
    }
    case Kind::table:
      break;
  }
  const auto above = std::upper_bound(cosine_.begin() + 1, cosine_.end() - 1, cos_angle);
  const auto n = static_cast<std::size_t>(above - cosine_.begin());
  const double share = (cos_angle - cosine_[n - 1]) / (cosine_[n] - cosine_[n - 1]);
  return value_[n - 1] + share * (value_[n] - value_[n - 1]);
}

double Scatterer::cosine_at(double uniform) const {
  switch (kind_) {
    case Kind::isotropic:
      return 2 * uniform - 1;
    case Kind::rayleigh: {
      // mu^3 + 3 mu = 8 u - 4, by Cardano.
      const double half = 4 * uniform - 2, root = std::cbrt(half + std::sqrt(half * half + 1));
      return root - 1 / root;
    }
    case Kind::henyey_greenstein: {
      const double ratio = (1 - g_ * g_) / (1 - g_ + 2 * g_ * uniform);
      return std::clamp((1 + g_ * g_ - ratio * ratio) / (2 * g_), -1.0, 1.0);
    }
    case Kind::table:
      break;
  }
  const auto above = std::upper_bound(cumulative_.begin() + 1, cumulative_.end() - 1, uniform);
  const auto n = static_cast<std::size_t>(above - cumulative_.begin());
  // Of the trapezium of this interval: rest = value x + slope x^2 / 2, solved for x without cancellation.
  const double rest = 2 * (uniform - cumulative_[n - 1]), width = cosine_[n] - cosine_[n - 1];
  const double value = value_[n - 1], slope = (value_[n] - value) / width;
  const double denominator = value + std::sqrt(std::max(0.0, value * value + 2 * slope * rest));
  return denominator > 0 ? std::min(cosine_[n - 1] + 2 * rest / denominator, cosine_[n]) : cosine_[n];
}

MonteCarloResult solve_by_monte_carlo(const MonteCarloScene& scene, const MonteCarloEffort& effort) {
  assert(effort.batches >= 2);
  const Box box(scene);
  std::vector<std::vector<double>> batch(effort.batches);
  std::atomic<int> next = 0;
  const auto work = [&] {
    for (int b = next++; b < effort.batches; b = next++) {
      batch[b] = Batch(scene, box, effort.seed, b).run(effort.photons / effort.batches);
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
  result.absorbed = planes(batch, first, scene.absorption ? scene.z_edge_m.size() - 1 : 0, columns);
  result.radiance = planes(batch, first, scene.views.size(), columns);
  return result;
}

}  // namespace cloudbow::reference
