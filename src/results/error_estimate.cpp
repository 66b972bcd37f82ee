#include "cloudbow/results/error_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

namespace cloudbow {
namespace {

// Between the ends the error of columns is up to .94 times the distances there with the ends' weights: measured on ten
// fields of thick voxels (docs/accuracy.md).
constexpr double between_ends_factor = 1.5;

// Fraction of the power. Errors of columns whose mean is less are not relative to that mean. Under a dark sky, the flux
// down at the top is rounding of emitted light.
constexpr double least_mean = 1e-6, least_mean_of_emission = 1e-3;

/// W m-2 through the horizontal top, and emitted.
double power_of(const Solution& solution) {
  if (solution.emits) return solution.ledger.power;
  return solution.profile_downwelling_diffuse_flux.back() + solution.profile_direct_flux.back();
}

/// W m-2, below which the mean of a plane is no light to speak of.
double least_flux(const Solution& solution) {
  return (solution.emits ? least_mean_of_emission : least_mean) * power_of(solution);
}

std::size_t planes(const Solution& solution) { return solution.flux_level.size(); }

/// Fluxes up through one of the levels that the solution holds.
std::vector<double> up(const Solution& solution, std::size_t plane) {
  const auto columns = static_cast<std::ptrdiff_t>(solution.box.columns());
  const auto begin = solution.upwelling_flux.begin() + static_cast<std::ptrdiff_t>(plane) * columns;
  return {begin, begin + columns};
}

/// Direct and diffuse.
std::vector<double> down(const Solution& solution, std::size_t plane) {
  std::vector<double> total(solution.box.columns());
  for (std::size_t c = 0; c < total.size(); ++c) {
    const std::size_t n = plane * total.size() + c;
    total[c] = static_cast<double>(solution.downwelling_diffuse_flux[n]) + static_cast<double>(solution.direct_flux[n]);
  }
  return total;
}

std::vector<double> up_at_top(const Solution& solution) { return up(solution, planes(solution) - 1); }
std::vector<double> down_at_bottom(const Solution& solution) { return down(solution, 0); }

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

/// Means over the square of columns next to each: the difference of one column alone is mostly chance.
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

/// Error of each column, with the RMS of the parts.
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
  const double power = power_of(solution);
  if (power > 0) {
    distance.domain = std::max(
        {largest_difference(solution.profile_upwelling_flux, other.profile_upwelling_flux) / power,
         largest_difference(solution.profile_downwelling_diffuse_flux, other.profile_downwelling_diffuse_flux) / power,
         std::abs(solution.ledger.reflectance - other.ledger.reflectance),
         std::abs(solution.ledger.transmittance - other.ledger.transmittance)});
  }
  distance.up = rms_over_mean(up_at_top(solution), up_at_top(other), least_flux(solution));
  distance.down = rms_over_mean(down_at_bottom(solution), down_at_bottom(other), least_flux(solution));
  return distance;
}

ByFlux flux_distance_between_ends(const Solution& solution, const Solution& other) {
  const double least = least_flux(solution);
  ByFlux distance;
  for (std::size_t there = 0; there < planes(other); ++there) {
    const auto found = std::find(solution.flux_level.begin(), solution.flux_level.end(), other.flux_level[there]);
    assert(found != solution.flux_level.end());
    const auto here = static_cast<std::size_t>(found - solution.flux_level.begin());
    if (there + 1 < planes(other))
      distance.up = std::max(distance.up, rms_over_mean(up(solution, here), up(other, there), least));
    if (there > 0)
      distance.down = std::max(distance.down, rms_over_mean(down(solution, here), down(other, there), least));
  }
  return distance;
}

double ErrorParts::total() const { return std::hypot(std::hypot(angular, spatial, iteration), spectral); }

double ErrorEstimate::columns() const { return std::max(up.total(), down.total()); }

ErrorEstimate estimate_error(const Solution& solution, const CoarseSolves& coarse_solves, const ErrorWeights& weights,
                             bool fields) {
  ErrorEstimate estimate;
  estimate.angular_distance = flux_distance(solution, coarse_solves.linear);
  estimate.spatial_distance = flux_distance(coarse_solves.linear, coarse_solves.constant);
  // Coarse solves on the same cells do not include the error of thick cells. With few directions they miss that of thin
  // air under a low sun.
  if (const auto& probe = coarse_solves.probe)
    estimate.probe_distance = flux_distance(probe->by_ordinates, probe->exact);
  // All solves have the same blocks of air.
  const auto of_air = [&solution](double ByFlux::*flux) {
    return (flux == &ByFlux::domain ? air_error_of_domain : 1.) * solution.report.air_error;
  };
  const auto parts = [&](double ByFlux::*flux, const ByFlux& angular, const ByFlux& spatial, const ByFlux& probe) {
    const double of_cells = std::max(weights.spatial.*flux * (spatial.*flux), probe.*flux);
    return ErrorParts{std::max(weights.least.*flux, weights.angular.*flux * (angular.*flux)),
                      std::hypot(of_cells, of_air(flux)), solution.report.estimated_error};
  };
  const auto at_ends = [&](double ByFlux::*flux) {
    return parts(flux, estimate.angular_distance, estimate.spatial_distance, estimate.probe_distance);
  };
  estimate.domain = at_ends(&ByFlux::domain);
  estimate.up = at_ends(&ByFlux::up);
  estimate.down = at_ends(&ByFlux::down);
  if (planes(solution) > 2) {
    const ByFlux angular = flux_distance_between_ends(solution, coarse_solves.linear);
    const ByFlux spatial = flux_distance_between_ends(coarse_solves.linear, coarse_solves.constant);
    ByFlux probe;
    if (coarse_solves.probe)
      probe = flux_distance_between_ends(coarse_solves.probe->by_ordinates, coarse_solves.probe->exact);
    estimate.between_ends = between_ends_factor * std::max(parts(&ByFlux::up, angular, spatial, probe).total(),
                                                           parts(&ByFlux::down, angular, spatial, probe).total());
  }
  const auto count = [&estimate](const SolverReport& report) {
    estimate.cpu_seconds += report.cpu_seconds;
    estimate.table_seconds += report.seconds_tables;
  };
  count(coarse_solves.linear.report);
  count(coarse_solves.constant.report);
  if (const auto& probe = coarse_solves.probe) {
    count(probe->by_ordinates.report);
    count(probe->exact.report);
  }
  if (fields) {
    estimate.upwelling_flux_error =
        error_field({up_at_top(solution), up_at_top(coarse_solves.linear), up_at_top(coarse_solves.constant)},
                    estimate.up, solution.box);
    estimate.downwelling_flux_error = error_field(
        {down_at_bottom(solution), down_at_bottom(coarse_solves.linear), down_at_bottom(coarse_solves.constant)},
        estimate.down, solution.box);
  }
  return estimate;
}

std::string error_line(const ErrorEstimate& estimate) {
  const auto percent = [](double fraction) { return fmt::format("{:.2g} %", 100 * fraction); };
  const std::string between =
      estimate.between_ends > 0 ? fmt::format(", at levels between {}", percent(estimate.between_ends)) : "";
  return fmt::format("{:<21} domain {}, columns up {}, down {}{}\n", "flux errors, about",
                     percent(estimate.domain.total()), percent(estimate.up.total()), percent(estimate.down.total()),
                     between);
}

}  // namespace cloudbow
