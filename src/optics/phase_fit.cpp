#include "cloudbow/optics/phase_fit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "cloudbow/core/thread_scope.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"
#include "cloudbow/sphere/icosphere.hpp"
#include "column_fit.hpp"

namespace cloudbow {
namespace {

constexpr std::array<const char*, 8> names = {"collocation",
                                              "least-squares",
                                              "minimax-absolute",
                                              "minimax-relative",
                                              "minimax-square-root",
                                              "linear-programming",
                                              "linear-programming-interpolant",
                                              "linear-programming-bounded"};

void check(const PhaseFitOptions& options) {
  if (options.exact_moments < 1 || options.exact_moments > 12) {
    throw InputError(
        fmt::format("phase function fit: exact moments up to {} (allowed: 1 to 12)", options.exact_moments));
  }
  if (!(options.bound_factor >= 1)) {
    throw InputError(fmt::format("phase function fit: bound factor {} (allowed: 1 or more)", options.bound_factor));
  }
  if (!(options.travel.norm() > 0 && std::isfinite(options.travel.norm())))
    throw InputError("phase function fit: the direction of travel has no length, or one beyond what a number holds");
}

FitOptions column_options(const PhaseFitOptions& options) {
  FitOptions column;
  column.exact_moments = options.exact_moments;
  column.beam_half_range_rows = 0;
  return column;
}

/// Data that all fits of one function share.
class Fitter {
 public:
  Fitter(const PhaseFunction& phase, const ControlPoints& points, const OrdinateSet& ordinates,
         const PhaseFitOptions& options)
      : phase_(phase),
        options_(options),
        travel_(options.travel.normalized()),
        under_ordinates_(points, ordinates, column_options(options)),
        of_interpolant_(points, interpolant_quadrature(points), column_options(options)),
        value_(under_ordinates_.sampled(phase, travel_)) {
    for (const Direction& v : make_icosphere(5).vertex) {
      const Direction direction = points.rotation() * v;
      between_.push_back(points.stencil(direction));
      value_between_.push_back(phase(direction.dot(travel_)));
    }
  }

  PhaseFit fit(PhaseFitMethod method) const {
    const auto start = std::chrono::steady_clock::now();
    PhaseFit fit;
    fit.method = method;
    set_value(fit);
    fit.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (fit.value.size() > 0) fit.errors = errors_of(fit.value);
    return fit;
  }

 private:
  void set_value(PhaseFit& fit) const {
    const SphereFit& sphere_fit = under_ordinates_.sphere_fit();
    const auto minimax = [&](ResidualScale scale) {
      return sphere_fit.minimax(value_, scale).value_or(Eigen::VectorXd());
    };
    switch (fit.method) {
      case PhaseFitMethod::collocation:
        fit.value = under_ordinates_.at_points(phase_, travel_);
        break;
      case PhaseFitMethod::least_squares:
        fit.value = sphere_fit.least_squares(value_);
        break;
      case PhaseFitMethod::minimax_absolute:
        fit.value = minimax(ResidualScale::absolute);
        break;
      case PhaseFitMethod::minimax_relative:
        fit.value = minimax(ResidualScale::relative);
        break;
      case PhaseFitMethod::minimax_square_root:
        fit.value = minimax(ResidualScale::square_root);
        break;
      case PhaseFitMethod::linear_programming:
        set_value(fit, under_ordinates_, under_ordinates_.fit(phase_, travel_, 0));
        break;
      case PhaseFitMethod::linear_programming_interpolant:
        set_value(fit, of_interpolant_, of_interpolant_.fit(phase_, travel_, 0));
        break;
      case PhaseFitMethod::linear_programming_bounded:
        set_value(fit, under_ordinates_, bounded_fit());
        break;
    }
  }

  void set_value(PhaseFit& fit, const ColumnFit& column_fit, FittedColumn column) const {
    column_fit.polish(column, phase_, travel_);
    fit.value = std::move(column.value);
    fit.exact_degree = column.exact_degree;
  }

  FittedColumn bounded_fit() const {
    if (phase_.is_isotropic()) return under_ordinates_.fit(phase_, travel_, 0);
    const SphereFit& sphere_fit = under_ordinates_.sphere_fit();
    const auto least = sphere_fit.minimax(value_, ResidualScale::absolute);
    const double error = least ? (sphere_fit.interpolated(*least) - value_).cwiseAbs().maxCoeff() : 0;
    return under_ordinates_.fit_bounded(phase_, travel_, options_.bound_factor * error);
  }

  PhaseFitErrors errors_of(const Eigen::VectorXd& x) const {
    const SphereFit& sphere_fit = under_ordinates_.sphere_fit();
    const Eigen::VectorXd error = (sphere_fit.interpolated(x) - value_).cwiseAbs();
    PhaseFitErrors errors;
    Eigen::Index worst = 0;
    errors.max_error = error.maxCoeff(&worst);
    const double cosine = std::clamp(sphere_fit.samples()[static_cast<std::size_t>(worst)].dot(travel_), -1.0, 1.0);
    errors.worst_angle_deg = std::acos(cosine) * 180 / std::numbers::pi;
    errors.rms_error = std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
    errors.relative_rms_error =
        std::sqrt(error.cwiseQuotient(residual_scale(value_, ResidualScale::relative)).squaredNorm() /
                  static_cast<double>(error.size()));
    errors.scaled_error = error.cwiseQuotient(value_.cwiseAbs().cwiseMax(0.05).cwiseSqrt()).maxCoeff();
    for (std::size_t i = 0; i < between_.size(); ++i) {
      const auto& [index, weight] = between_[i];
      const double here = weight[0] * x[index[0]] + weight[1] * x[index[1]] + weight[2] * x[index[2]];
      errors.max_error_between = std::max(errors.max_error_between, std::abs(here - value_between_[i]));
    }
    errors.ordinate_norm = under_ordinates_.moment(x, travel_, 0);
    errors.ordinate_asymmetry = under_ordinates_.moment(x, travel_, 1);
    errors.interpolant_norm = of_interpolant_.moment(x, travel_, 0);
    errors.interpolant_asymmetry = of_interpolant_.moment(x, travel_, 1);
    errors.least_value = x.minCoeff();
    return errors;
  }

  const PhaseFunction& phase_;
  PhaseFitOptions options_;
  Direction travel_;
  ColumnFit under_ordinates_;
  ColumnFit of_interpolant_;
  Eigen::VectorXd value_;  // at the samples
  std::vector<Stencil> between_;
  std::vector<double> value_between_;
};

}  // namespace

std::vector<std::string> phase_fit_names() { return {names.begin(), names.end()}; }

std::string name_of(PhaseFitMethod method) { return names[static_cast<std::size_t>(method)]; }

PhaseFitMethod phase_fit_method(const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InputError(fmt::format("phase function fit: found \"{}\", allowed {}", name, fmt::join(names, ", ")));
  return static_cast<PhaseFitMethod>(found - names.begin());
}

OrdinateSet interpolant_quadrature(const ControlPoints& points) {
  // A plane triangle seen from the centre: solid angle = height / |x|^3 times area. The square of Gauss points is
  // drawn together to the triangle's first corner (Duffy 1982). Interpolants are smooth inside a triangle; fewer nodes
  // do in smaller ones.
  const GaussLegendre rule = make_gauss_legendre(points.size() <= 42 ? 14 : points.size() <= 162 ? 10 : 8);
  OrdinateSet set;
  set.name = "interpolant";
  for (const auto& corner : points.triangles()) {
    const Direction a = points.directions()[corner[0]], b = points.directions()[corner[1]],
                    c = points.directions()[corner[2]];
    const Eigen::Vector3d normal = (b - a).cross(c - a);  // of length twice the area
    const double height = normal.dot(a);                  // times twice the area
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double s = (1 + rule.node[i]) / 2;
      for (std::size_t j = 0; j < rule.node.size(); ++j) {
        const double t = (1 + rule.node[j]) / 2;
        const Eigen::Vector3d x = a + s * ((1 - t) * (b - a) + t * (c - a));
        const double length = x.norm();
        set.direction.push_back(x / length);
        set.weight.push_back(rule.weight[i] / 2 * rule.weight[j] / 2 * s * height / (length * length * length));
      }
    }
  }
  set.symmetry = {Eigen::Matrix3d::Identity()};
  return set;
}

std::vector<PhaseFit> fit_phase_function(const PhaseFunction& phase, const ControlPoints& points,
                                         const OrdinateSet& ordinates, std::span<const PhaseFitMethod> methods,
                                         const PhaseFitOptions& options) {
  check(options);
  const Fitter fitter(phase, points, ordinates, options);
  const auto count = static_cast<int>(methods.size());
  std::vector<PhaseFit> fits(methods.size());
  const ThreadScope threads(0);
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic)
  for (int i = 0; i < count; ++i) errors.run([&] { fits[i] = fitter.fit(methods[i]); });
  errors.rethrow();
  return fits;
}

std::vector<double> great_circle_section(const ControlPoints& points, const Eigen::VectorXd& value,
                                         const Direction& travel, std::span<const double> angle_deg) {
  const Direction forward = travel.normalized();
  const Direction aside = forward.unitOrthogonal();
  std::vector<double> section;
  for (const double angle : angle_deg) {
    const double radians = angle * std::numbers::pi / 180;
    const auto [index, weight] = points.stencil(std::cos(radians) * forward + std::sin(radians) * aside);
    section.push_back(weight[0] * value[index[0]] + weight[1] * value[index[1]] + weight[2] * value[index[2]]);
  }
  return section;
}

}  // namespace cloudbow
