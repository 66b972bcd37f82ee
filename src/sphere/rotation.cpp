#include "cloudbow/sphere/rotation.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numeric>

#include "cloudbow/sphere/spherical_function.hpp"

namespace cloudbow {
namespace {

constexpr int none = -1;

struct Pair {
  double distance;
  int source, target;
};

double distance(const Direction& rotated, const Direction& point) { return (rotated - point).squaredNorm(); }

PointPermutation match_best_first(std::span<const Direction> rotated, std::span<const Direction> point) {
  const int count = static_cast<int>(point.size());
  std::vector<Pair> pairs;
  pairs.reserve(count * count);
  for (int s = 0; s < count; ++s) {
    for (int t = 0; t < count; ++t) pairs.push_back({distance(rotated[s], point[t]), s, t});
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
  PointPermutation source(count, none);
  std::vector<bool> is_used(count, false);
  for (const Pair& pair : pairs) {
    if (source[pair.target] != none || is_used[pair.source]) continue;
    source[pair.target] = pair.source;
    is_used[pair.source] = true;
  }
  return source;
}

std::vector<std::vector<int>> neighbours(const ControlPoints& points) {
  std::vector<std::vector<int>> of(points.size());
  for (const auto& t : points.triangles()) {
    for (int k = 0; k < 3; ++k) of[t[k]].push_back(t[(k + 1) % 3]);  // each side is met once in either sense
  }
  return of;
}

PointPermutation match_outward(std::span<const Direction> rotated, const ControlPoints& points) {
  const auto point = points.directions();
  const int count = points.size();
  Pair best{std::numeric_limits<double>::infinity(), 0, 0};
  for (int s = 0; s < count; ++s) {
    for (int t = 0; t < count; ++t) {
      const double d = distance(rotated[s], point[t]);
      if (d < best.distance) best = {d, s, t};
    }
  }
  const auto neighbour = neighbours(points);
  PointPermutation source(count, none);
  std::vector<int> queue = {best.source};
  std::vector<bool> is_queued(count, false);
  is_queued[best.source] = true;
  for (int i = 0; i < static_cast<int>(queue.size()); ++i) {
    const int s = queue[i];
    int nearest = none;
    for (int t = 0; t < count; ++t) {
      if (source[t] != none) continue;
      if (nearest == none || distance(rotated[s], point[t]) < distance(rotated[s], point[nearest])) nearest = t;
    }
    source[nearest] = s;
    for (const int next : neighbour[s]) {
      if (!is_queued[next]) queue.push_back(next);
      is_queued[next] = true;
    }
  }
  return source;
}

// Shortest augmenting paths with prices (Jonker & Volgenant 1987): points are matched one after another, each by the
// cheapest chain of exchanges; prices keep all reduced costs >= 0, so that the chain is found as Dijkstra does.
PointPermutation match_least_squares(std::span<const Direction> rotated, std::span<const Direction> point) {
  const int count = static_cast<int>(point.size());
  std::vector<double> source_price(count, 0.0), target_price(count, 0.0);
  PointPermutation source(count, none);
  for (int start = 0; start < count; ++start) {
    std::vector<double> length(count, std::numeric_limits<double>::infinity());
    std::vector<int> came_from(count, none);  // target before this one on the chain
    std::vector<bool> is_done(count, false);
    int s = start, last = none;
    double reached = 0;
    while (s != none) {
      int next = none;
      for (int t = 0; t < count; ++t) {
        if (is_done[t]) continue;
        const double through = reached + distance(rotated[s], point[t]) - source_price[s] - target_price[t];
        if (through < length[t]) {
          length[t] = through;
          came_from[t] = last;
        }
        if (next == none || length[t] < length[next]) next = t;
      }
      reached = length[next];
      is_done[next] = true;
      last = next;
      s = source[next];
    }
    source_price[start] += reached;
    for (int t = 0; t < count; ++t) {
      if (!is_done[t] || t == last) continue;
      source_price[source[t]] += reached - length[t];
      target_price[t] -= reached - length[t];
    }
    while (last != none) {
      const int before = came_from[last];
      source[last] = before == none ? start : source[before];
      last = before;
    }
  }
  return source;
}

}  // namespace

std::optional<PointPermutation> exact_permutation(const ControlPoints& points, const Eigen::Matrix3d& rotation) {
  PointPermutation source;
  for (const Direction& v : points.directions()) {
    const Direction before = rotation.transpose() * v;
    const auto [index, weight] = points.stencil(before);
    const int nearest = index[std::max_element(weight.begin(), weight.end()) - weight.begin()];
    constexpr double tolerance = 1e-9;  // far above rounding, far below the spacing of points
    if ((points.directions()[nearest] - before).norm() > tolerance) return std::nullopt;
    source.push_back(nearest);
  }
  return source;
}

PointPermutation nearest_permutation(const ControlPoints& points, const Eigen::Matrix3d& rotation, Matching matching) {
  std::vector<Direction> rotated;
  for (const Direction& v : points.directions()) rotated.push_back(rotation * v);
  switch (matching) {
    case Matching::best_first:
      return match_best_first(rotated, points.directions());
    case Matching::outward:
      return match_outward(rotated, points);
    case Matching::least_squares:
      break;
  }
  return match_least_squares(rotated, points.directions());
}

std::vector<Stencil> reweighting(const ControlPoints& points, const Eigen::Matrix3d& rotation,
                                 Interpolation interpolation) {
  std::vector<Stencil> stencils;
  for (const Direction& v : points.directions()) {
    stencils.push_back(points.stencil(rotation.transpose() * v, interpolation));
  }
  return stencils;
}

template <class Real>
void permute(const PointPermutation& source, std::span<const Real> values, std::span<Real> rotated) {
  assert(values.size() == rotated.size() && values.size() % source.size() == 0);
  const std::size_t functions = values.size() / source.size();
  for (std::size_t m = 0; m < source.size(); ++m) {
    std::copy_n(values.data() + source[m] * functions, functions, rotated.data() + m * functions);
  }
}

template <class Real>
void reweight(std::span<const Stencil> stencils, std::span<const Real> values, std::span<Real> rotated) {
  query(stencils, values.size() / stencils.size(), values, rotated);
}

template void permute(const PointPermutation&, std::span<const float>, std::span<float>);
template void permute(const PointPermutation&, std::span<const double>, std::span<double>);
template void reweight(std::span<const Stencil>, std::span<const float>, std::span<float>);
template void reweight(std::span<const Stencil>, std::span<const double>, std::span<double>);

}  // namespace cloudbow
