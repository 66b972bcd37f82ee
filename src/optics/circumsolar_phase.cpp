#include "cloudbow/optics/circumsolar_phase.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>

#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

// Nodes are densest near 0, because most light is there: lambda = scale (exp(step node) - 1), the last at 60.
constexpr double scale = .05;
constexpr double deepest = 60;
const double step = std::log1p(deepest / scale) / (CircumsolarPhase::nodes - 1);

double depth_at(int node) { return scale * std::expm1(step * node); }

constexpr std::size_t most_moments = 4096;
constexpr double least_moment = 1e-9;
constexpr int angles_of_ring = 64;

// Integral over the cosine from that of `outer` to that of `inner`, weighted with the cosine itself.
double norm(const ConeRing& ring) {
  return .5 * (std::cos(ring.inner) + std::cos(ring.outer)) * 2 * std::sin(.5 * (ring.outer - ring.inner)) *
         std::sin(.5 * (ring.outer + ring.inner));
}

double mean_over(const ConeRing& ring, const std::function<double(double)>& function) {
  static const GaussLegendre rule = make_gauss_legendre(angles_of_ring);
  double sum = 0, weights = 0;
  for (int n = 0; n < angles_of_ring; ++n) {
    const double angle = ring.inner + .5 * (1 + rule.node[n]) * (ring.outer - ring.inner);
    const double weight = rule.weight[n] * std::cos(angle) * std::sin(angle);
    sum += weight * function(std::cos(angle));
    weights += weight;
  }
  return sum / weights;
}

// Integrals of P_l from x to 1, l < count.
std::vector<double> integrals_to_1(double x, std::size_t count) {
  std::vector<double> integral(count);
  double before = 1, current = x;  // P_{l-1}, P_l
  if (count > 0) integral[0] = 1 - x;
  for (std::size_t l = 1; l < count; ++l) {
    const double degree = static_cast<double>(l);
    const double next = ((2 * degree + 1) * x * current - degree * before) / (degree + 1);
    integral[l] = (before - next) / (2 * degree + 1);
    before = current;
    current = next;
  }
  return integral;
}

// (2l+1) times the mean of P_l over a ring, l < count.
std::vector<double> legendre_means(const ConeRing& ring, std::size_t count) {
  const std::vector<double> wide = integrals_to_1(std::cos(ring.outer), count + 1);
  const std::vector<double> narrow = integrals_to_1(std::cos(ring.inner), count + 1);
  const double whole = norm(ring);
  std::vector<double> mean(count);
  for (std::size_t l = 0; l < count; ++l) {
    // (2l+1) x P_l = (l+1) P_{l+1} + l P_{l-1}
    const double degree = static_cast<double>(l);
    mean[l] = (degree + 1) * (wide[l + 1] - narrow[l + 1]);
    if (l > 0) mean[l] += degree * (wide[l - 1] - narrow[l - 1]);
    mean[l] /= whole;
  }
  return mean;
}

std::size_t moments_in_use(const PhaseFunction& phase) {
  std::size_t count = std::min(phase.moments().size(), most_moments);
  while (count > 0 && std::abs(phase.moments()[count - 1]) < least_moment) --count;
  return count;
}

}  // namespace

double ConeRing::power() const { return 2 * std::numbers::pi * norm(*this); }

double ConeRing::mean_cosine() const {
  const double a = std::cos(outer), b = std::cos(inner);
  return 2. / 3 * (a * a + a * b + b * b) / (a + b);
}

std::vector<ConeRing> cone_rings(double half_angle, int count) {
  assert(half_angle > 0 && half_angle < std::numbers::pi / 2 && count >= 1);
  std::vector<ConeRing> rings;
  for (int n = 0; n < count; ++n) rings.push_back({half_angle * n / count, half_angle * (n + 1) / count});
  return rings;
}

double CircumsolarPhase::place(double lambda) {
  return std::clamp(std::log1p(std::max(0., lambda) / scale) / step, 0., nodes - 1.);
}

std::span<const double> CircumsolarPhase::peak(std::size_t p, std::size_t ring) const {
  return of_phase_[p].peak.empty() ? std::span<const double>{} : std::span<const double>(of_phase_[p].peak[ring]);
}

std::span<const double> CircumsolarPhase::carried(std::size_t ring) const { return carried_[ring]; }

CircumsolarPhase::CircumsolarPhase(std::span<const PhaseFunction> phase, std::span<const DeltaM> truncation,
                                   std::span<const double> weight, std::span<const ConeRing> rings) {
  std::size_t order = 0, count = 0;
  double peaks = 0;
  for (std::size_t p = 0; p < phase.size(); ++p) {
    if (truncation[p].forward_fraction == 0) continue;
    has_peak_ = true;
    order = truncation[p].truncated.moments().size();
    count = std::max(count, moments_in_use(phase[p]));
    peaks += weight[p] * truncation[p].forward_fraction;
  }
  count = has_peak_ ? std::max(count, order + 1) : 0;
  // r_l of the mean peak
  std::vector<double> ratio(count, 1.);
  for (std::size_t l = order; l < count; ++l) {
    double sum = 0;
    for (std::size_t p = 0; p < phase.size(); ++p)
      sum += truncation[p].forward_fraction > 0 ? weight[p] * phase[p].moment(static_cast<int>(l)) : 0;
    ratio[l] = peaks > 0 ? sum / peaks : 0;
  }

  of_phase_.resize(phase.size());
  for (const ConeRing& ring : rings) {
    const std::vector<double> legendre = legendre_means(ring, count);
    std::vector<double>& carried = carried_.emplace_back(nodes, 0.);
    for (int n = 0; n < nodes; ++n) {
      const double lambda = depth_at(n);
      for (std::size_t l = 0; l < count; ++l)
        carried[n] += legendre[l] * (std::exp(-lambda * (1 - ratio[l])) - std::exp(-lambda));
    }
    for (std::size_t p = 0; p < phase.size(); ++p) {
      const double f = truncation[p].forward_fraction;
      const double rest = (1 - f) * mean_over(ring, truncation[p].truncated);
      of_phase_[p].rest.push_back(rest);
      if (f == 0) continue;
      std::vector<double>& peak = of_phase_[p].peak.emplace_back(nodes, mean_over(ring, phase[p]) - rest);
      for (int n = 0; n < nodes; ++n) {
        const double lambda = depth_at(n);
        const double never = std::exp(-lambda);
        for (std::size_t l = 0; l < count; ++l) {
          const double moment = l < order ? f : phase[p].moment(static_cast<int>(l));
          const double kept = std::exp(-lambda * (1 - ratio[l]));
          peak[n] += legendre[l] * (f * (never - kept) + moment * (kept - 1));
        }
      }
    }
  }
}

}  // namespace cloudbow
