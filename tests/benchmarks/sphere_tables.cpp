// Makes the tables of docs/sphere.md: sphere_tables
// [weights|location|shapes|queries|solve|rotation|deformation|curves]... Without arguments, all but curves (the numbers
// behind the pictures). Times are processor time of one thread.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <ctime>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <string_view>

#include "cloudbow/sphere/gauss_legendre.hpp"
#include "cloudbow/sphere/harmonic_series.hpp"
#include "cloudbow/sphere/icosphere.hpp"
#include "cloudbow/sphere/rotation.hpp"
#include "cloudbow/sphere/spherical_function.hpp"
#include "representations.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;
using Function = std::function<double(const Direction&)>;
using PointsPtr = std::shared_ptr<const ControlPoints>;

struct Shape {
  const char* name;
  double g;
};
constexpr Shape shapes[] = {{"smooth (HG .3)", 0.3}, {"peaked (HG .85)", 0.85}};

/// Beside these two, a peak sharper than any of the representations.
constexpr Shape query_shapes[] = {shapes[0], shapes[1], {"sharp (HG .95)", 0.95}};

/// Of processor time: other programs on the machine count less.
double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double seconds_of(const std::function<void()>& work) {
  const double start = processor_seconds();
  work();
  return processor_seconds() - start;
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

PointsPtr make_points(int count) { return std::make_shared<ControlPoints>(count, control_point_frame_rotation()); }

// ---------------------------------------------------------------------------------------------------------- weights

double worst_linear_error(const ControlPoints& points, Interpolation kind) {
  double worst = 0;
  for (const Direction& d : random_directions(200000)) {
    const auto [index, weight] = points.stencil(d, kind);
    Direction sum = Direction::Zero();
    for (int k = 0; k < 3; ++k) sum += weight[k] * points.directions()[index[k]];
    worst = std::max(worst, (sum - d).norm());
  }
  return worst;
}

using Weights = std::array<double, 3> (*)(const Direction&, const Direction&, const Direction&, const Direction&);

/// Largest difference of an end's weights, seen from the two triangles that share a side.
double worst_jump(const ControlPoints& points, Weights weights) {
  const auto v = points.directions();
  std::vector<std::vector<std::pair<int, int>>> apex(points.size());  // of side (from, to), by from
  for (const auto& t : points.triangles()) {
    for (int k = 0; k < 3; ++k) apex[t[k]].push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
  }
  double worst = 0;
  for (int a = 0; a < points.size(); ++a) {
    for (const auto& [b, left] : apex[a]) {
      const auto back = std::find_if(apex[b].begin(), apex[b].end(), [&](const auto& side) { return side.first == a; });
      for (double x = 0.05; x < 1; x += 0.05) {
        const Direction p = ((1 - x) * v[a] + x * v[b]).normalized();
        worst =
            std::max(worst, std::abs(weights(p, v[a], v[b], v[left])[0] - weights(p, v[b], v[a], v[back->second])[1]));
      }
    }
  }
  return worst;
}

void print_weights() {
  fmt::print(
      "\n## weights\n\n| points | kind | linear error | order | jump on sides | worst sum - 1 | least weight | "
      "worst 1 - weight at a vertex | ns |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Interpolation kind : {Interpolation::spherical_area, Interpolation::planar}) {
    double coarse = 0;
    for (int subdivisions = 1; subdivisions <= 4; ++subdivisions) {
      const ControlPoints points(Polyhedron::icosahedron, subdivisions);
      const double error = worst_linear_error(points, kind);
      double worst_sum = 0, least = 1, worst_vertex = 0, sink = 0;
      const auto directions = random_directions(200000);
      for (const Direction& d : directions) {
        const auto w = points.stencil(d, kind).weight;
        worst_sum = std::max(worst_sum, std::abs(w[0] + w[1] + w[2] - 1));
        least = std::min({least, w[0], w[1], w[2]});
      }
      for (const Direction& v : points.directions()) {
        const auto w = points.stencil(v, kind).weight;
        worst_vertex = std::max(worst_vertex, 1 - std::max({w[0], w[1], w[2]}));
      }
      const double time = seconds_of([&] {
        for (const Direction& d : directions) sink += points.stencil(d, kind).weight[0];
      });
      if (sink < 0) fmt::print("impossible\n");
      fmt::print("| {} | {} | {:.2e} | {} | {:.1e} | {:.0e} | {:.0e} | {:.0e} | {:.0f} |\n", points.size(),
                 kind == Interpolation::planar ? "planar" : "spherical areas", error,
                 coarse > 0 ? fmt::format("{:.2f}", std::log2(coarse / error)) : "",
                 worst_jump(points, kind == Interpolation::planar ? planar_weights : spherical_area_weights), worst_sum,
                 least, worst_vertex, time / static_cast<double>(directions.size()) * 1e9);
      coarse = error;
    }
  }

  fmt::print(
      "\n| polyhedron | points | triangles | largest / smallest | sum of areas / 4 pi - 1 |\n"
      "| --- | --- | --- | --- | --- |\n");
  constexpr std::pair<Polyhedron, const char*> polyhedra[] = {{Polyhedron::icosahedron, "icosahedron"},
                                                              {Polyhedron::octahedron, "octahedron"},
                                                              {Polyhedron::tetrahedron, "tetrahedron"}};
  for (const auto& [polyhedron, name] : polyhedra) {
    for (int subdivisions = 0; subdivisions <= 4; ++subdivisions) {
      const SphereMesh mesh = make_sphere_mesh(polyhedron, subdivisions);
      double sum = 0, lost = 0, least = 4 * pi, most = 0;
      for (const auto& [a, b, c] : mesh.triangle) {
        const double area = spherical_triangle_area(mesh.vertex[a], mesh.vertex[b], mesh.vertex[c]);
        const double next = sum + area;
        lost += (sum - next) + area;
        sum = next;
        least = std::min(least, area);
        most = std::max(most, area);
      }
      fmt::print("| {} | {} | {} | {:.2f} | {:.0e} |\n", name, mesh.vertex.size(), mesh.triangle.size(), most / least,
                 (sum + lost) / (4 * pi) - 1);
    }
  }

  fmt::print(
      "\n| points | least, largest orbit weight x M / 4 pi | largest error to degree | of the degree above |\n"
      "| --- | --- | --- | --- |\n");
  constexpr int exactness[] = {5, 9, 15, 27};
  for (int subdivisions = 0; subdivisions <= 3; ++subdivisions) {
    const int degree = exactness[subdivisions];
    const auto weight = icosphere_weights(subdivisions);
    const auto [least, most] = std::minmax_element(weight.begin(), weight.end());
    Eigen::VectorXd integral = real_spherical_harmonics(make_icosphere(subdivisions).vertex, degree + 1) *
                               Eigen::Map<const Eigen::VectorXd>(weight.data(), weight.size());
    integral[0] -= std::sqrt(4 * pi);
    const double scale = static_cast<double>(weight.size()) / (4 * pi);
    fmt::print("| {} | {:.4f}, {:.4f} | {:.0e} ({}) | {:.1e} |\n", weight.size(), *least * scale, *most * scale,
               integral.head(harmonic_count(degree)).cwiseAbs().maxCoeff(), degree,
               integral.tail(2 * degree + 3).cwiseAbs().maxCoeff());
  }
}

// --------------------------------------------------------------------------------------------------------- location

void print_location() {
  constexpr int count = 1000000;
  fmt::print(
      "\n## location\n\n| polyhedron, points | directions | held less well than by the best triangle | by more "
      "than 1e-15 | ns |\n| --- | --- | --- | --- | --- |\n");
  constexpr std::tuple<Polyhedron, int, const char*> sets[] = {{Polyhedron::icosahedron, 2, "icosahedron"},
                                                               {Polyhedron::octahedron, 2, "octahedron"},
                                                               {Polyhedron::tetrahedron, 3, "tetrahedron"}};
  for (const auto& [polyhedron, subdivisions, name] : sets) {
    const ControlPoints points(polyhedron, subdivisions);
    const auto v = points.directions();
    std::vector<std::array<Direction, 3>> side;  // normals of the sides' planes
    for (const auto& [a, b, c] : points.triangles())
      side.push_back({v[a].cross(v[b]), v[b].cross(v[c]), v[c].cross(v[a])});
    auto directions = random_directions(count);
    for (int axis = 0; axis < 3; ++axis) {
      directions.push_back(Direction::Unit(axis));
      directions.push_back(-Direction::Unit(axis));
    }
    for (const auto& [a, b, c] : points.triangles()) {
      directions.insert(directions.end(), {v[a], (v[a] + v[b]).normalized(), (v[b] + v[c]).normalized(),
                                           (0.9 * v[c] + 0.1 * v[a]).normalized()});
    }
    int worse = 0, wrong = 0, sink = 0;
    for (const Direction& d : directions) {
      const auto held = [&](std::size_t t) {
        return std::min({d.dot(side[t][0]), d.dot(side[t][1]), d.dot(side[t][2])});
      };
      double best = -1;
      for (std::size_t t = 0; t < side.size(); ++t) best = std::max(best, held(t));
      const double found = held(points.triangle_at(d));
      worse += found < best;
      wrong += found < best - 1e-15;
    }
    const double time = seconds_of([&] {
      for (const Direction& d : directions) sink += points.triangle_at(d);
    });
    if (sink < 0) fmt::print("impossible\n");
    fmt::print("| {}, {} | {} | {} | {} | {:.0f} |\n", name, points.size(), directions.size(), worse, wrong,
               time / static_cast<double>(directions.size()) * 1e9);
  }
}

// ----------------------------------------------------------------------------------------------------------- shapes

/// Control values that fit a function best, in the sense of least squares, on 2562 evenly spread samples.
class LeastSquares {
 public:
  explicit LeastSquares(const PointsPtr& points) : points_(points), sample_(make_icosphere(4).vertex) {
    Eigen::MatrixXd interpolation = Eigen::MatrixXd::Zero(sample_.size(), points->size());
    for (std::size_t i = 0; i < sample_.size(); ++i) {
      const auto [index, weight] = points->stencil(sample_[i]);
      for (int k = 0; k < 3; ++k) interpolation(i, index[k]) = weight[k];
    }
    adjoint_ = interpolation.transpose();
    gram_ = adjoint_ * interpolation;
    projector_ = gram_.ldlt().solve(adjoint_);
  }
  SphericalFunction fit(const Function& f) const { return with_values(projector_ * sampled(f)); }

  /// The best of all with control values >= 0: one value after another is set to its best, over and over.
  SphericalFunction non_negative_fit(const Function& f) const {
    const Eigen::VectorXd right = adjoint_ * sampled(f);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size());
    for (int round = 0; round < 200; ++round) {
      for (Eigen::Index m = 0; m < x.size(); ++m) {
        x[m] = std::max(0.0, x[m] + (right[m] - gram_.col(m).dot(x)) / gram_(m, m));
      }
    }
    return with_values(x);
  }

 private:
  Eigen::VectorXd sampled(const Function& f) const {
    Eigen::VectorXd y(sample_.size());
    for (std::size_t i = 0; i < sample_.size(); ++i) y[i] = f(sample_[i]);
    return y;
  }
  SphericalFunction with_values(const Eigen::VectorXd& x) const {
    return {points_, std::vector<double>(x.begin(), x.end())};
  }

  PointsPtr points_;
  std::vector<Direction> sample_;
  Eigen::MatrixXd adjoint_, gram_, projector_;
};

struct Errors {
  double rms = 0;                                          // over the function's own RMS
  double max = 0;                                          // over the function's largest value
  double least = std::numeric_limits<double>::infinity();  // least value of the representation, over the mean of 1
};

/// Over 16 places of the peak, because those at a control point are easier than those between.
Errors errors_of(double g, const std::function<Function(const Function&)>& represent) {
  Errors errors;
  double square = 0, norm = 0, peak = 0;
  const auto directions = random_directions(4000, 7);
  for (const Direction& axis : random_directions(16, 3)) {
    const Function f = [&](const Direction& v) { return henyey_greenstein(g, axis, v); };
    const Function r = represent(f);
    auto samples = directions;
    for (const Direction& d : random_directions(400, 9)) samples.push_back((axis + 0.15 * d).normalized());
    samples.push_back(axis);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const double exact = f(samples[i]), value = r(samples[i]);
      if (i < directions.size()) {  // the rest crowds at the peak: for the largest error only
        square += (value - exact) * (value - exact);
        norm += exact * exact;
      }
      errors.max = std::max(errors.max, std::abs(value - exact));
      errors.least = std::min(errors.least, value);
      peak = std::max(peak, exact);
    }
  }
  errors.rms = std::sqrt(square / norm);
  errors.max /= peak;
  return errors;
}

Errors errors_of_harmonics(double g, int degree) {
  static const OrdinateSet quadrature = make_ordinate_set("double-gauss-64x128");
  return errors_of(g, [&](const Function& f) -> Function { return HarmonicSeries(degree, quadrature, f); });
}

/// Factors by degree that make the projection of every non-negative function non-negative: the Legendre coefficients
/// of the non-negative kernel of this (even) degree that blurs least, [P_n+1(c) / (c - c0)]^2 with n half the degree
/// and c0 the largest zero of P_n+1.
std::vector<double> non_negative_damping(int degree) {
  const int n = degree / 2;
  const double largest_zero = make_gauss_legendre(n + 1).node.back();
  const GaussLegendre rule = make_gauss_legendre(2 * degree + 2);
  std::vector<double> factor(degree + 1, 0.0);
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double c = rule.node[i], root = std::legendre(n + 1, c) / (c - largest_zero);
    for (int l = 0; l <= degree; ++l) factor[l] += rule.weight[i] * root * root * std::legendre(l, c);
  }
  for (int l = degree; l >= 0; --l) factor[l] /= factor[0];
  return factor;
}

Errors errors_of_non_negative_harmonics(double g, int degree) {
  static const OrdinateSet quadrature = make_ordinate_set("double-gauss-64x128");
  const auto factor = non_negative_damping(degree);
  return errors_of(g, [&](const Function& f) -> Function {
    const HarmonicSeries plain(degree, quadrature, f);
    std::vector<double> damped(plain.coefficients().begin(), plain.coefficients().end());
    for (int l = 0; l <= degree; ++l) {
      for (int m = -l; m <= l; ++m) damped[harmonic_index(l, m)] *= factor[l];
    }
    return HarmonicSeries(degree, std::move(damped));
  });
}

enum class Fit { values, least_squares, non_negative };

Errors errors_of_points(double g, int count, Fit how) {
  const PointsPtr points = make_points(count);
  const LeastSquares fit(points);
  return errors_of(g, [&](const Function& f) -> Function {
    if (how == Fit::values) return SphericalFunction(points, f);
    return how == Fit::least_squares ? fit.fit(f) : fit.non_negative_fit(f);
  });
}

/// Seconds that a query of all functions in one direction takes; every call in another direction.
class PointQueries {
 public:
  PointQueries(int count, std::size_t functions)
      : points_(make_points(count)), values_(filled(count, functions)), result_(functions) {}
  double seconds() {
    const Direction d = directions_[next_++ % directions_.size()];
    return seconds_of([&] { query<float>(points_->stencil(d), values_, result_); });
  }

 private:
  PointsPtr points_;
  std::vector<float> values_, result_;
  std::vector<Direction> directions_ = random_directions(64);
  std::size_t next_ = 0;
};

class HarmonicQueries {
 public:
  HarmonicQueries(int degree, std::size_t functions)
      : basis_(degree),
        coefficients_(filled(harmonic_count(degree), functions)),
        harmonics_(harmonic_count(degree)),
        result_(functions) {}
  double seconds() {
    const Direction d = directions_[next_++ % directions_.size()];
    return seconds_of([&] {
      basis_.evaluate(d, harmonics_);
      query_harmonics<float>(harmonics_, coefficients_, result_);
    });
  }

 private:
  HarmonicBasis basis_;
  std::vector<float> coefficients_;
  std::vector<double> harmonics_;
  std::vector<float> result_;
  std::vector<Direction> directions_ = random_directions(64);
  std::size_t next_ = 0;
};

double milliseconds(const std::function<double()>& timed, int repeats) {
  std::vector<double> times;
  timed();
  for (int i = 0; i < repeats; ++i) times.push_back(timed() * 1e3);
  return median(times);
}

void print_shapes() {
  constexpr std::size_t functions = 100000;
  fmt::print(
      "\n## shapes\n\n| shape | representation | RMS error % | largest error % of the peak | least value | query "
      "of {} functions, ms |\n| --- | --- | --- | --- | --- | --- |\n",
      functions);
  for (const auto& [name, g] : shapes) {
    for (const int degree : {3, 7, 12}) {
      HarmonicQueries queries(degree, functions);
      const Errors e = errors_of_harmonics(g, degree);
      fmt::print("| {} | {} harmonics | {:.2f} | {:.2f} | {:.2f} | {:.3f} |\n", name, harmonic_count(degree),
                 100 * e.rms, 100 * e.max, e.least, milliseconds([&] { return queries.seconds(); }, 50));
    }
    for (const int count : {42, 162}) {
      PointQueries queries(count, functions);
      const double time = milliseconds([&] { return queries.seconds(); }, 200);
      constexpr std::pair<Fit, const char*> fits[] = {{Fit::values, "values"},
                                                      {Fit::least_squares, "least squares"},
                                                      {Fit::non_negative, "non-negative least squares"}};
      for (const auto& [how, fit_name] : fits) {
        const Errors e = errors_of_points(g, count, how);
        fmt::print("| {} | {} points, {} | {:.2f} | {:.2f} | {:.2f} | {:.3f} |\n", name, count, fit_name, 100 * e.rms,
                   100 * e.max, e.least, time);
      }
    }
  }
}

// ---------------------------------------------------------------------------------------------------------- queries

struct Times {
  double median, least;  // [ms]
};

/// Of queries in turns: what slows the machine slows both.
std::pair<Times, Times> query_times(int points, int degree, std::size_t functions) {
  PointQueries of_points(points, functions);
  HarmonicQueries of_harmonics(degree, functions);
  std::vector<double> point_times, harmonic_times;
  of_points.seconds();
  of_harmonics.seconds();
  for (int i = 0; i < 11; ++i) {
    for (int k = 0; k < 9; ++k) point_times.push_back(of_points.seconds() * 1e3);
    harmonic_times.push_back(of_harmonics.seconds() * 1e3);
  }
  const auto summary = [](const std::vector<double>& t) {
    return Times{median(t), *std::min_element(t.begin(), t.end())};
  };
  return {summary(point_times), summary(harmonic_times)};
}

/// All directions at once, for which harmonics become a matrix product that stays in cache.
void print_many_directions(std::size_t functions) {
  constexpr int count = 64, degree = 12;
  constexpr std::size_t block = 1024;
  const auto directions = random_directions(count);
  const PointsPtr points = make_points(162);
  std::vector<float> result(count * functions);
  double p = 0, h = 0;
  {
    const auto values = filled(points->size(), functions);
    p = milliseconds(
        [&] {
          return seconds_of([&] {
            std::vector<Stencil> stencils;
            for (const Direction& d : directions) stencils.push_back(points->stencil(d));
            query<float>(stencils, functions, values, result);
          });
        },
        5);
  }
  const auto coefficients = filled(harmonic_count(degree), functions);
  h = milliseconds(
      [&] {
        return seconds_of([&] {
          using Rows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
          const Eigen::MatrixXf basis = real_spherical_harmonics(directions, degree).transpose().cast<float>();
          const Eigen::Map<const Rows> c(coefficients.data(), harmonic_count(degree), functions);
          Eigen::Map<Rows> r(result.data(), count, functions);
          for (std::size_t first = 0; first < functions; first += block) {
            const std::size_t n = std::min(block, functions - first);
            r.middleCols(first, n).noalias() = basis * c.middleCols(first, n);
          }
        });
      },
      5);
  fmt::print(
      "\n{} directions at once, {} functions, 162 points {:.0f} ms, 169 harmonics as a matrix product {:.0f} ms: "
      "{:.1f}\n",
      count, functions, p, h, h / p);
}

void print_queries() {
  constexpr std::size_t functions = 1000000;
  fmt::print(
      "\n## queries\n\n| shape, points | equal error | of the points % | harmonics that reach it | their error % | "
      "points, ms | harmonics, ms | ratio of medians | of least times |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const auto& [name, g] : query_shapes) {
    for (const int count : {42, 162}) {
      for (const bool non_negative : {false, true}) {
        const Errors of_points = errors_of_points(g, count, non_negative ? Fit::non_negative : Fit::least_squares);
        for (const auto& [what, error] : {std::pair("RMS", &Errors::rms), std::pair("largest", &Errors::max)}) {
          constexpr int highest = 24;
          int degree = 0;
          Errors of_harmonics;
          do {
            degree += non_negative ? 2 : 1;
            of_harmonics = non_negative ? errors_of_non_negative_harmonics(g, degree) : errors_of_harmonics(g, degree);
          } while (of_harmonics.*error > of_points.*error && degree < highest);
          const bool reached = of_harmonics.*error <= of_points.*error;
          const auto [p, h] = query_times(count, degree, functions);
          fmt::print("| {}, {} | {}{} | {:.2f} | {}{} | {:.2f} | {:.3f} | {:.2f} | {:.1f} | {:.1f} |\n", name, count,
                     what, non_negative ? ", both non-negative" : "", 100 * (of_points.*error),
                     reached ? "" : "more than ", harmonic_count(degree), 100 * (of_harmonics.*error), p.median,
                     h.median, h.median / p.median, h.least / p.least);
        }
      }
    }
  }

  fmt::print(
      "\n| equal storage | functions | points, ms | harmonics, ms | ratio of medians | of least times |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  for (const auto& [count, degree] : {std::pair(42, 6), std::pair(162, 12)}) {
    for (const std::size_t n : {std::size_t(13000), functions}) {
      const auto [p, h] = query_times(count, degree, n);
      fmt::print("| {} points, {} harmonics | {} | {:.4f} | {:.3f} | {:.1f} | {:.1f} |\n", count,
                 harmonic_count(degree), n, p.median, h.median, h.median / p.median, h.least / p.least);
    }
  }
  print_many_directions(functions);
}

// ------------------------------------------------------------------------------------------------------------ solve

constexpr std::size_t rays = 650, layers = 20;  // 13 000 voxels

void add_to_points(const Stencil& stencil, float weight, std::span<const float> radiance, float* values) {
  float* a = values + stencil.index[0] * rays;
  float* b = values + stencil.index[1] * rays;
  float* c = values + stencil.index[2] * rays;
  const float wa = weight * static_cast<float>(stencil.weight[0]), wb = weight * static_cast<float>(stencil.weight[1]),
              wc = weight * static_cast<float>(stencil.weight[2]);
  for (std::size_t n = 0; n < rays; ++n) {
    a[n] += wa * radiance[n];
    b[n] += wb * radiance[n];
    c[n] += wc * radiance[n];
  }
}

void add_to_harmonics(std::span<const double> basis, float weight, std::span<const float> radiance, float* values) {
  for (std::size_t k = 0; k < basis.size(); ++k) {
    const float b = weight * static_cast<float>(basis[k]);
    float* row = values + k * rays;
    for (std::size_t n = 0; n < rays; ++n) row[n] += b * radiance[n];
  }
}

/// One sweep of all directions: in every voxel the source is evaluated in the direction of the ray, the ray is
/// attenuated and fed, and its mean is added to the voxel's radiance, in the same representation. Rows of a layer are
/// kept together, so that they stay in cache.
/// @param query (layer's source, result), add (mean radiance, layer's radiance).
template <class Query, class Add>
void march(std::size_t rows, bool upward, std::span<const float> source, std::span<float> radiance,
           const Query& query_source, const Add& add) {
  constexpr float transmittance = 0.9f;
  std::array<float, rays> ray{}, emitted, mean;
  for (std::size_t i = 0; i < layers; ++i) {
    const std::size_t layer = upward ? i : layers - 1 - i;
    query_source(source.subspan(layer * rows * rays, rows * rays), std::span<float>(emitted));
    for (std::size_t n = 0; n < rays; ++n) {
      const float after = transmittance * ray[n] + (1 - transmittance) * emitted[n];
      mean[n] = 0.5f * (ray[n] + after);
      ray[n] = after;
    }
    add(std::span<const float>(mean), radiance.data() + layer * rows * rays);
  }
}

double solve_with_points(const ControlPoints& points, std::span<const Direction> directions) {
  const auto source = filled(points.size(), rays * layers);
  std::vector<float> radiance(source.size());
  const float weight = 1 / static_cast<float>(directions.size());
  return seconds_of([&] {
    for (const Direction& d : directions) {
      const Stencil stencil = points.stencil(d);
      march(
          points.size(), d.z() > 0, source, radiance,
          [&](std::span<const float> layer, std::span<float> result) { query<float>(stencil, layer, result); },
          [&](std::span<const float> mean, float* layer) { add_to_points(stencil, weight, mean, layer); });
    }
  });
}

double solve_with_harmonics(int degree, std::span<const Direction> directions) {
  const HarmonicBasis basis(degree);
  std::vector<double> harmonics(harmonic_count(degree));
  const auto source = filled(harmonics.size(), rays * layers);
  std::vector<float> radiance(source.size());
  const float weight = 1 / static_cast<float>(directions.size());
  return seconds_of([&] {
    for (const Direction& d : directions) {
      basis.evaluate(d, harmonics);
      march(
          harmonics.size(), d.z() > 0, source, radiance,
          [&](std::span<const float> layer, std::span<float> result) {
            query_harmonics<float>(harmonics, layer, result);
          },
          [&](std::span<const float> mean, float* layer) { add_to_harmonics(harmonics, weight, mean, layer); });
    }
  });
}

void print_solve() {
  fmt::print(
      "\n## solve\n\nSeconds of one sweep of {} voxels.\n\n| directions | 42 points | 162 points | 16 harmonics | "
      "64 harmonics | 169 harmonics | 64 harmonics / 42 points | 169 harmonics / 162 points |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n",
      rays * layers);
  const ControlPoints few(42), many(162);
  for (const int count : {45, 111, 223, 489, 1131, 2013}) {
    const auto directions = random_directions(count);
    std::vector<double> t[5];
    for (int repeat = 0; repeat < 3; ++repeat) {
      t[0].push_back(solve_with_points(few, directions));
      t[1].push_back(solve_with_points(many, directions));
      t[2].push_back(solve_with_harmonics(3, directions));
      t[3].push_back(solve_with_harmonics(7, directions));
      t[4].push_back(solve_with_harmonics(12, directions));
    }
    fmt::print("| {} | {:.4f} | {:.4f} | {:.4f} | {:.3f} | {:.3f} | {:.1f} | {:.1f} |\n", count, median(t[0]),
               median(t[1]), median(t[2]), median(t[3]), median(t[4]), median(t[3]) / median(t[0]),
               median(t[4]) / median(t[1]));
  }
}

// --------------------------------------------------------------------------------------------------------- rotation

/// One turn of the values.
using Turn = std::function<std::vector<double>(const std::vector<double>&)>;

double rms_difference(const Function& a, const Function& b, std::span<const Direction> directions) {
  double square = 0, norm = 0;
  for (const Direction& d : directions) {
    square += std::pow(a(d) - b(d), 2);
    norm += b(d) * b(d);
  }
  return std::sqrt(square / norm);
}

Turn permutation_turn(PointPermutation source) {
  return [source = std::move(source)](const std::vector<double>& values) {
    std::vector<double> rotated(values.size());
    permute<double>(source, values, rotated);
    return rotated;
  };
}

Turn reweighting_turn(std::vector<Stencil> stencils) {
  return [stencils = std::move(stencils)](const std::vector<double>& values) {
    std::vector<double> rotated(values.size());
    reweight<double>(stencils, values, rotated);
    return rotated;
  };
}

void print_rotation_row(const char* shape, const char* method, const std::vector<double>& start, const Turn& turn,
                        const std::function<Function(std::vector<double>)>& make, const Direction& axis, double g,
                        const Eigen::Matrix3d& rotation) {
  const auto directions = random_directions(20000, 5);
  const Function exact = [&](const Direction& v) { return henyey_greenstein(g, axis, v); };
  const Function exact_turned = [&](const Direction& v) { return henyey_greenstein(g, rotation * axis, v); };
  auto values = start;
  double after_one = 0;
  for (int i = 0; i < 36; ++i) {
    values = turn(values);
    if (i == 0) after_one = rms_difference(make(values), exact_turned, directions);
  }
  fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.1e} | {:.2f} |\n", shape, method,
             100 * rms_difference(make(start), exact, directions), 100 * after_one,
             100 * rms_difference(make(values), exact, directions),
             rms_difference(make(values), make(start), directions), make(values)(axis) / make(start)(axis));
}

void print_rotation() {
  fmt::print(
      "\n## rotation\n\n| shape | method | RMS error %: unrotated | after 10 degrees | after 36 times 10 degrees | "
      "36 times, against the unrotated representation | value at the peak, 36 times / unrotated |\n"
      "| --- | --- | --- | --- | --- | --- | --- |\n");
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(pi / 18, Direction(1, 2, 3).normalized()).toRotationMatrix();
  const Direction axis = Direction(0.8, -0.3, 0.5).normalized();
  const OrdinateSet quadrature = make_ordinate_set("double-gauss-64x128");
  for (const auto& [name, g] : shapes) {
    const Function f = [&, g = g](const Direction& v) { return henyey_greenstein(g, axis, v); };
    for (const int count : {42, 162, 642}) {
      const PointsPtr points = make_points(count);
      const SphericalFunction start(points, f);
      const std::vector<double> values(start.values().begin(), start.values().end());
      const auto make = [&](std::vector<double> v) -> Function { return SphericalFunction(points, std::move(v)); };
      const auto row = [&](std::string_view method, const Turn& turn) {
        print_rotation_row(name, fmt::format("{} points, {}", count, method).c_str(), values, turn, make, axis, g,
                           rotation);
      };
      row("permuted best first", permutation_turn(nearest_permutation(*points, rotation, Matching::best_first)));
      row("permuted outward", permutation_turn(nearest_permutation(*points, rotation, Matching::outward)));
      row("permuted by least squares",
          permutation_turn(nearest_permutation(*points, rotation, Matching::least_squares)));
      row("reweighted", reweighting_turn(reweighting(*points, rotation)));
      row("reweighted, planar", reweighting_turn(reweighting(*points, rotation, Interpolation::planar)));
    }
    for (const int degree : {3, 7, 12}) {
      const HarmonicSeries start(degree, quadrature, f);
      const HarmonicRotation turn(rotation, degree);
      print_rotation_row(
          name, fmt::format("{} harmonics", harmonic_count(degree)).c_str(),
          {start.coefficients().begin(), start.coefficients().end()},
          [&](const std::vector<double>& c) {
            std::vector<double> rotated(c.size());
            turn.apply<double>(c, rotated);
            return rotated;
          },
          [&](std::vector<double> c) -> Function { return HarmonicSeries(degree, std::move(c)); }, axis, g, rotation);
    }
  }

  fmt::print(
      "\n| points | worst displacement by 10 degrees, degrees: best first | outward | least squares | mean: best "
      "first | outward | least squares |\n| --- | --- | --- | --- | --- | --- | --- |\n");
  for (const int count : {42, 162, 642}) {
    const PointsPtr points = make_points(count);
    std::vector<double> worst, mean;
    for (const Matching matching : {Matching::best_first, Matching::outward, Matching::least_squares}) {
      const auto source = nearest_permutation(*points, rotation, matching);
      worst.push_back(0);
      mean.push_back(0);
      for (int m = 0; m < count; ++m) {
        const Direction moved = rotation * points->directions()[source[m]];
        const double angle = 180 / pi * std::acos(std::min(1.0, moved.dot(points->directions()[m])));
        worst.back() = std::max(worst.back(), angle);
        mean.back() += angle / count;
      }
    }
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", count, worst[0], worst[1], worst[2],
               mean[0], mean[1], mean[2]);
  }

  fmt::print(
      "\n| 60 icosahedral rotations, {} | largest difference to the rotated values / peak: permuted | reweighted "
      "|\n| --- | --- | --- |\n",
      shapes[1].name);
  for (const int count : {12, 42, 162, 642}) {
    const PointsPtr points = make_points(count);
    const SphericalFunction start(points, [&](const Direction& v) { return henyey_greenstein(0.85, axis, v); });
    double permuted = 0, reweighted = 0;
    int rotations = 0;
    for (const auto& g : icosahedral_group()) {
      if (g.determinant() < 0) continue;
      const Eigen::Matrix3d r = points->rotation() * g * points->rotation().transpose();
      const auto permutation = exact_permutation(*points, r);
      if (!permutation) continue;
      ++rotations;
      std::vector<double> a(count), b(count);
      permute<double>(*permutation, start.values(), a);
      reweight<double>(reweighting(*points, r), start.values(), b);
      for (int m = 0; m < count; ++m) {
        const double expected = henyey_greenstein(0.85, r * axis, points->directions()[m]);
        permuted = std::max(permuted, std::abs(a[m] - expected));
        reweighted = std::max(reweighted, std::abs(b[m] - expected));
      }
    }
    const double peak = henyey_greenstein(0.85, axis, axis);
    fmt::print("| {} points ({} found exact) | {:.0e} | {:.0e} |\n", count, rotations, permuted / peak,
               reweighted / peak);
  }
}

// ------------------------------------------------------------------------------------------------------ deformation

using Change = std::function<void(SphericalFunction&, const Direction&)>;

/// A change by 1 of the value at 1000 directions, each of a function that is 0.
void print_deformation_row(const PointsPtr& points, const std::string& operation, const Change& change) {
  const auto directions = random_directions(1000, 11);
  const auto samples = random_directions(20000, 5);
  const SphericalFunction nothing(points, std::vector<double>(points->size(), 0.0));
  double error = 0, moved = 0, norm = 0, largest = 0, least_integral = 4 * pi, largest_integral = 0;
  for (std::size_t n = 0; n < directions.size(); ++n) {
    SphericalFunction changed = nothing;
    change(changed, directions[n]);
    error = std::max(error, std::abs(changed(directions[n]) - 1));
    double squares = 0;
    for (const double value : changed.values()) {
      moved += value != 0;
      squares += value * value;
      largest = std::max(largest, value);
    }
    norm += std::sqrt(squares);
    if (n % 20 != 0) continue;
    double integral = 0;
    for (const Direction& d : samples) integral += changed(d) * 4 * pi / static_cast<double>(samples.size());
    least_integral = std::min(least_integral, integral);
    largest_integral = std::max(largest_integral, integral);
  }
  SphericalFunction changed = nothing;
  const double time = seconds_of([&] {
    for (const Direction& d : directions) change(changed, d);
  });
  const auto count = static_cast<double>(directions.size());
  fmt::print("| {} | {} | {:.0e} | {:.1f} | {:.2f} | {:.2f} | {:.3f} to {:.3f} | {:.2g} |\n", points->size(), operation,
             error, moved / count, norm / count, largest, least_integral, largest_integral, time / count * 1e6);
}

void print_deformation() {
  fmt::print(
      "\n## deformation\n\n| points | operation | error there | control points that move | root of the sum of "
      "their squares | largest of them | integral, sr | microseconds |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const int count : {42, 162, 642}) {
    const PointsPtr points = make_points(count);
    print_deformation_row(points, "move_value_at",
                          [](SphericalFunction& f, const Direction& d) { f.move_value_at(d, 1); });
    for (const double reach : {0.7, 1.4}) {
      print_deformation_row(points, fmt::format("deform, reach {} rad", reach),
                            [reach](SphericalFunction& f, const Direction& d) { f.deform(d, f(d) + 1, reach); });
    }
  }
}

// ----------------------------------------------------------------------------------------------------------- curves

/// Values along a great circle through the peak: columns shape, angle [degrees], exact, then the representations.
void print_curves() {
  const Direction axis = Direction(0.8, -0.3, 0.5).normalized(), side = axis.cross(Direction(0, 0, 1)).normalized();
  const OrdinateSet quadrature = make_ordinate_set("double-gauss-64x128");
  const LeastSquares few(make_points(42)), many(make_points(162));
  fmt::print("shape,angle,exact,16 harmonics,64 harmonics,42 points,162 points\n");
  for (const auto& [name, g] : shapes) {
    const Function f = [&, g = g](const Direction& v) { return henyey_greenstein(g, axis, v); };
    const HarmonicSeries h16(3, quadrature, f), h64(7, quadrature, f);
    const SphericalFunction p42 = few.fit(f), p162 = many.fit(f);
    for (int degrees = -180; degrees <= 180; ++degrees) {
      const Direction d = std::cos(degrees * pi / 180) * axis + std::sin(degrees * pi / 180) * side;
      fmt::print("{},{},{},{},{},{},{}\n", name, degrees, f(d), h16(d), h64(d), p42(d), p162(d));
    }
  }
}

}  // namespace
}  // namespace cloudbow

int main(int argc, char** argv) {
  using namespace cloudbow;
  const std::pair<std::string_view, void (*)()> tables[] = {
      {"weights", print_weights},         {"location", print_location}, {"shapes", print_shapes},
      {"queries", print_queries},         {"solve", print_solve},       {"rotation", print_rotation},
      {"deformation", print_deformation}, {"curves", print_curves}};
  const std::vector<std::string_view> wanted(argv + 1, argv + argc);
  for (const auto& name : wanted) {
    if (std::none_of(std::begin(tables), std::end(tables), [&](const auto& table) { return table.first == name; })) {
      fmt::print(stderr,
                 "sphere_tables: there is no table \"{}\" (allowed: weights, location, shapes, queries, solve, "
                 "rotation, deformation, curves)\n",
                 name);
      return 2;
    }
  }
  for (const auto& [name, print] : tables) {
    if (wanted.empty() ? name != "curves" : std::find(wanted.begin(), wanted.end(), name) != wanted.end()) print();
  }
}
