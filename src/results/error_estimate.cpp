#include "cloudbow/results/error_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

namespace cloudbow {
namespace {

// Of incident: errors of columns whose mean is less are not in terms of it.
constexpr double kLeastMean = 1e-6;

/// W m-2 through the horizontal top.
double incident(const Solution& solution) {
  return solution.profile_downwelling_diffuse_flux.back() + solution.profile_direct_flux.back();
}

std::vector<double> up_at_top(const Solution& solution) {
  const auto columns = static_cast<std::ptrdiff_t>(solution.box.columns());
  return {solution.upwelling_flux.end() - columns, solution.upwelling_flux.end()};
}

std::vector<double> down_at_bottom(const Solution& solution) {
  std::vector<double> down(solution.box.columns());
  for (std::size_t c = 0; c < down.size(); ++c) {
    down[c] = static_cast<double>(solution.downwelling_diffuse_flux[c]) + static_cast<double>(solution.direct_flux[c]);
  }
  return down;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// @param least of the mean: less is no light to speak of.
double rms_over_mean(const std::vector<double>& one, const std::vector<double>& other, double least) {
  assert(one.size() == other.size());
  double square = 0;
  for (std::size_t n = 0; n < one.size(); ++n) square += (one[n] - other[n]) * (one[n] - other[n]);
  return square == 0 ? 0 : std::sqrt(square / static_cast<double>(one.size())) / std::max(mean(one), least);
}

double largest_difference(const std::vector<double>& one, const std::vector<double>& other) {
  double largest = 0;
  for (std::size_t n = 0; n < one.size(); ++n) largest = std::max(largest, std::abs(one[n] - other[n]));
  return largest;
}

/// Means over the square of columns next to each: what one column's difference happens to be says little.
std::vector<double> smoothed(const std::vector<double>& square, const BoxGrid& box) {
  const auto pass = [&](const std::vector<double>& from, std::ptrdiff_t stride, int length) {
    if (length < 3) return from;
    std::vector<double> to(from.size());
    for (std::size_t c = 0; c < from.size(); ++c) {
      const auto place = static_cast<int>(c / static_cast<std::size_t>(stride)) % length;
      const auto neighbour = [&](int step) {
        const int there = (place + step + length) % length;
        return from[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(c) + (there - place) * stride)];
      };
      to[c] = (neighbour(-1) + neighbour(0) + neighbour(1)) / 3;
    }
    return to;
  };
  return pass(pass(square, 1, box.nx), box.nx, box.ny);
}

struct Planes {
  std::vector<double> solution, linear, constant;
};

/// Of each column, with the RMS that the parts have.
std::vector<float> error_field(const Planes& planes, const ErrorParts& parts, const BoxGrid& box) {
  const double of = mean(planes.solution);
  const auto shares = [&](const std::vector<double>& one, const std::vector<double>& other) {
    std::vector<double> square(one.size());
    for (std::size_t c = 0; c < one.size(); ++c) square[c] = (one[c] - other[c]) * (one[c] - other[c]);
    square = smoothed(square, box);
    const double all = mean(square);
    for (double& share : square) share = all > 0 ? share / all : 1;
    return square;
  };
  const std::vector<double> angular = shares(planes.solution, planes.linear);
  const std::vector<double> spatial = shares(planes.linear, planes.constant);
  std::vector<float> field;
  for (std::size_t c = 0; c < angular.size(); ++c) {
    field.push_back(static_cast<float>(of * std::sqrt(parts.angular * parts.angular * angular[c] +
                                                      parts.spatial * parts.spatial * spatial[c] +
                                                      parts.iteration * parts.iteration)));
  }
  return field;
}

}  // namespace

ByFlux flux_distance(const Solution& solution, const Solution& other) {
  ByFlux distance;
  const double power = incident(solution);
  if (power > 0) {
    distance.domain = std::max(
        {largest_difference(solution.profile_upwelling_flux, other.profile_upwelling_flux) / power,
         largest_difference(solution.profile_downwelling_diffuse_flux, other.profile_downwelling_diffuse_flux) / power,
         std::abs(solution.ledger.reflectance - other.ledger.reflectance),
         std::abs(solution.ledger.transmittance - other.ledger.transmittance)});
  }
  distance.up = rms_over_mean(up_at_top(solution), up_at_top(other), kLeastMean * power);
  distance.down = rms_over_mean(down_at_bottom(solution), down_at_bottom(other), kLeastMean * power);
  return distance;
}

double ErrorParts::total() const { return std::hypot(angular, spatial, iteration); }

double ErrorEstimate::columns() const { return std::max(up.total(), down.total()); }

ErrorEstimate estimate_error(const Solution& solution, const Companions& companions, const ErrorWeights& weights,
                             bool fields) {
  ErrorEstimate estimate;
  estimate.angular_distance = flux_distance(solution, companions.linear);
  estimate.spatial_distance = flux_distance(companions.linear, companions.constant);
  // Companions on the same cells do not know what thick cells cost, nor, with few directions, what thin air under a low
  // sun does.
  if (const auto& probe = companions.probe) estimate.probe_distance = flux_distance(probe->by_ordinates, probe->exact);
  const auto parts = [&](double ByFlux::*flux) {
    return ErrorParts{
        std::max(weights.least.*flux, weights.angular.*flux * (estimate.angular_distance.*flux)),
        std::max(weights.spatial.*flux * (estimate.spatial_distance.*flux), estimate.probe_distance.*flux),
        solution.report.estimated_error};
  };
  estimate.domain = parts(&ByFlux::domain);
  estimate.up = parts(&ByFlux::up);
  estimate.down = parts(&ByFlux::down);
  const auto count = [&estimate](const SolverReport& report) {
    estimate.cpu_seconds += report.cpu_seconds;
    estimate.table_seconds += report.seconds_tables;
  };
  count(companions.linear.report);
  count(companions.constant.report);
  if (const auto& probe = companions.probe) {
    count(probe->by_ordinates.report);
    count(probe->exact.report);
  }
  if (fields) {
    estimate.upwelling_flux_error = error_field(
        {up_at_top(solution), up_at_top(companions.linear), up_at_top(companions.constant)}, estimate.up, solution.box);
    estimate.downwelling_flux_error =
        error_field({down_at_bottom(solution), down_at_bottom(companions.linear), down_at_bottom(companions.constant)},
                    estimate.down, solution.box);
  }
  return estimate;
}

std::string error_line(const ErrorEstimate& estimate) {
  const auto percent = [](double fraction) { return fmt::format("{:.2g} %", 100 * fraction); };
  return fmt::format("{:<21} domain {}, columns up {}, down {}\n", "flux errors, about",
                     percent(estimate.domain.total()), percent(estimate.up.total()), percent(estimate.down.total()));
}

}  // namespace cloudbow
