// Flights of photons through the cells of a scene, for the forward and the backward Monte Carlo.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "reference/monte_carlo.hpp"

namespace cloudbow::reference {

using std::numbers::pi;
using Vector = std::array<double, 3>;

inline constexpr double least_weight = 0.1, survivor_weight = 0.5;

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

inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Unit vector towards a point of the sky.
inline Vector towards(double zenith_deg, double azimuth_deg) {
  const double zenith = zenith_deg * pi / 180, azimuth = azimuth_deg * pi / 180;
  return {std::sin(zenith) * std::cos(azimuth), std::sin(zenith) * std::sin(azimuth), std::cos(zenith)};
}

inline Vector reversed(const Vector& v) { return {-v[0], -v[1], -v[2]}; }

/// Turned by the angle of the given cosine, at an azimuth about `d` that is drawn.
inline Vector turned(const Vector& d, double cosine, Random& random) {
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

/// About the vertical, the cosine with it given.
inline Vector at_cosine(double mu, double azimuth) {
  const double sine = std::sqrt(std::max(0.0, 1 - mu * mu));
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), mu};
}

struct Photon {
  Vector position, direction;
  int i = 0, j = 0, k = 0;  // i and j hold only in layers that are not uniform, until `locate`
  double weight = 1;
  bool diffuse = false;  // has scattered, or does not come from the sun
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
        absorption_(extinction_.size(), 0.0),
        uniform_(nz_, 1) {
    const std::size_t columns = static_cast<std::size_t>(nx_) * ny_;
    for (const Medium& medium : scene.media) {
      assert(medium.extinction.size() == extinction_.size());
      for (std::size_t c = 0; c < extinction_.size(); ++c) {
        extinction_[c] += medium.extinction[c];
        absorption_[c] += medium.extinction[c] * (1 - medium.single_scattering_albedo);
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
  double bottom() const { return scene_.z_edge_m.front(); }
  double thickness(int layer) const { return scene_.z_edge_m[layer + 1] - scene_.z_edge_m[layer]; }
  double extinction(std::size_t cell) const { return extinction_[cell]; }
  double absorption(std::size_t cell) const { return absorption_[cell]; }
  /// Planck radiances: mean of a cell, its step, and at the photon in its cell.
  double planck(std::size_t cell) const { return scene_.emission.planck.empty() ? 0 : scene_.emission.planck[cell]; }
  double planck_step(std::size_t cell) const { return scene_.emission.step.empty() ? 0 : scene_.emission.step[cell]; }
  double planck_at(const Photon& p) const {
    const std::size_t cell = cell_of(p);
    const double height = (p.position[2] - scene_.z_edge_m[p.k]) / thickness(p.k);
    return planck(cell) + (height - 0.5) * planck_step(cell);
  }
  double surface_planck(int column) const {
    return scene_.emission.surface.empty() ? 0 : scene_.emission.surface[column];
  }
  /// Power that a cell emits, by area of the column.
  double emitted(std::size_t cell) const {
    return 4 * pi * absorption_[cell] * planck(cell) * thickness(static_cast<int>(cell / (nx_ * ny_)));
  }

  /// The medium with which the photon collides.
  const Medium& collision_partner(std::size_t cell, Random& random) const {
    if (scene_.media.size() == 1) return scene_.media.front();
    double at = random.uniform() * extinction_[cell];
    for (const Medium& medium : scene_.media) {
      at -= medium.extinction[cell];
      if (at < 0) return medium;
    }
    return scene_.media.back();
  }

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
  std::vector<double> absorption_;  // its part that absorbs
  std::vector<char> uniform_;       // layers in which all columns are equal
};

}  // namespace cloudbow::reference
