#include "phase_classes.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

constexpr int directions = 8;
constexpr int last_degree = 31;  // the solver truncates forward peaks below this
/// Among more candidates than this only every n-th is tried as a class: finer steps than the family needs.
constexpr std::size_t most_candidates = 96;

/// The properties of a phase function that affect fluxes. All entries are linear in the function.
struct Signature {
  double asymmetry;
  std::array<double, directions> turned;  ///< share of the light that crosses the horizontal, by direction of travel
};

/// Integral of P_l from 0 to 1 for odd l: (-1)^((l-1)/2) (l-2)!! / (l+1)!!.
double half_integral(int l) {
  double integral = 0.5;
  for (int n = 3; n <= l; n += 2) integral *= -static_cast<double>(n - 2) / (n + 1);
  return integral;
}

class SignatureMaker {
 public:
  SignatureMaker() {
    const GaussLegendre rule = make_gauss_legendre(2 * directions);
    int m = 0;
    for (const double mu : rule.node) {
      if (mu > 0) cosine_[m++] = mu;
    }
  }

  /// Of light that travels at mu, a share changes hemisphere: 1/2 - 1/2 sum over odd l of (2l+1) chi_l P_l(mu) int_0^1
  /// P_l.
  Signature operator()(const PhaseFunction& phase) const {
    Signature signature{phase.asymmetry_parameter(), {}};
    for (int m = 0; m < directions; ++m) {
      double sum = 0, before = 1, here = cosine_[m];
      for (int l = 1; l <= last_degree; ++l) {
        if (l % 2 == 1) sum += (2 * l + 1) * phase.moment(l) * here * half_integral(l);
        const double next = ((2 * l + 1) * cosine_[m] * here - l * before) / (l + 1);
        before = here;
        here = next;
      }
      signature.turned[m] = 0.5 - 0.5 * sum;
    }
    return signature;
  }

 private:
  std::array<double, directions> cosine_{};
};

/// Share of `high` that keeps the asymmetry parameter, as far as a mixture can.
double share_of(const Signature& low, const Signature& high, const Signature& wanted) {
  const double step = high.asymmetry - low.asymmetry;
  if (step == 0) return 0;
  return std::clamp((wanted.asymmetry - low.asymmetry) / step, 0.0, 1.0);
}

double error_of(const Signature& low, const Signature& high, const Signature& wanted) {
  const double share = share_of(low, high, wanted);
  const double asymmetry = (1 - share) * low.asymmetry + share * high.asymmetry;
  double error = 0.25 * std::abs(asymmetry - wanted.asymmetry) / std::max(1 - wanted.asymmetry, 1e-3);
  for (int m = 0; m < directions; ++m) {
    error = std::max(error, std::abs((1 - share) * low.turned[m] + share * high.turned[m] - wanted.turned[m]));
  }
  return error;
}

/// The cheapest chains from the first candidate to the last, by number of steps (Bellman).
class ChainSearch {
 public:
  explicit ChainSearch(std::vector<std::vector<double>> cost) : cost_(std::move(cost)) {
    best_.push_back(std::vector<double>(cost_.size(), std::numeric_limits<double>::infinity()));
    best_[0][0] = 0;
    from_.emplace_back(cost_.size(), 0);
  }

  /// One step more. @returns the cost of the cheapest chain to the last candidate.
  double lengthen() {
    const std::vector<double>& before = best_.back();
    std::vector<double> best(cost_.size(), std::numeric_limits<double>::infinity());
    std::vector<std::size_t> from(cost_.size(), 0);
    for (std::size_t b = 1; b < cost_.size(); ++b) {
      for (std::size_t a = 0; a < b; ++a) {
        if (before[a] + cost_[a][b] < best[b]) {
          best[b] = before[a] + cost_[a][b];
          from[b] = a;
        }
      }
    }
    best_.push_back(std::move(best));
    from_.push_back(std::move(from));
    return best_.back().back();
  }

  std::vector<std::size_t> chain() const {
    std::vector<std::size_t> places{cost_.size() - 1};
    for (std::size_t step = from_.size() - 1; step > 0; --step) places.push_back(from_[step][places.back()]);
    std::reverse(places.begin(), places.end());
    return places;
  }

 private:
  std::vector<std::vector<double>> cost_;  // [a][b] of the step from a to b
  std::vector<std::vector<double>> best_;  // [steps][b]
  std::vector<std::vector<std::size_t>> from_;
};

}  // namespace

PhaseClasses::PhaseClasses(std::span<const PhaseFunction> family, std::span<const double> weight, double tolerance) {
  assert(!family.empty() && weight.size() == family.size() && tolerance >= 0);
  std::vector<double> share(weight.begin(), weight.end());
  double sum = 0;
  for (const double w : share) sum += w;
  if (sum > 0) {
    for (double& w : share) w /= sum;
  } else {
    share.assign(family.size(), 1.0 / static_cast<double>(family.size()));
  }
  std::vector<std::size_t> used;
  for (std::size_t n = 0; n < share.size(); ++n) {
    if (share[n] > 0) used.push_back(n);
  }

  const SignatureMaker signature_of;
  std::vector<Signature> signature(family.size());
  for (std::size_t n = used.front(); n <= used.back(); ++n) signature[n] = signature_of(family[n]);

  if (tolerance == 0 || used.size() == 1) {
    members_ = used;
  } else {
    const std::size_t stride = (used.size() + most_candidates - 1) / most_candidates;
    std::vector<std::size_t> candidate;
    for (std::size_t n = 0; n < used.size(); n += stride) candidate.push_back(used[n]);
    if (candidate.back() != used.back()) candidate.push_back(used.back());

    std::vector<std::vector<double>> cost(candidate.size(), std::vector<double>(candidate.size(), 0));
    for (std::size_t a = 0; a < candidate.size(); ++a) {
      for (std::size_t b = a + 1; b < candidate.size(); ++b) {
        for (std::size_t n = candidate[a] + 1; n < candidate[b]; ++n) {
          if (share[n] > 0) {
            cost[a][b] += share[n] * error_of(signature[candidate[a]], signature[candidate[b]], signature[n]);
          }
        }
      }
    }
    ChainSearch search(std::move(cost));
    for (std::size_t steps = 1; search.lengthen() > tolerance && steps + 1 < candidate.size(); ++steps) {
    }
    for (const std::size_t place : search.chain()) members_.push_back(candidate[place]);
  }

  position_.assign(family.size(), 0);
  for (std::size_t c = 0; c < members_.size(); ++c) {
    const std::size_t low = members_[c];
    position_[low] = static_cast<double>(c);
    if (c + 1 == members_.size()) break;
    const std::size_t high = members_[c + 1];
    for (std::size_t n = low + 1; n < high; ++n) {
      position_[n] = static_cast<double>(c) + share_of(signature[low], signature[high], signature[n]);
      if (share[n] > 0) error_ += share[n] * error_of(signature[low], signature[high], signature[n]);
    }
  }
}

ClassMixture PhaseClasses::mixture(std::size_t member, double next_share) const {
  assert(member >= members_.front() && member <= members_.back());
  const double next = member + 1 < position_.size() && next_share > 0 ? position_[member + 1] : position_[member];
  // Positions may be averaged: no class lies between a member and the next one.
  const double position = (1 - next_share) * position_[member] + next_share * next;
  const auto lower =
      static_cast<std::size_t>(std::clamp(std::floor(position), 0.0, static_cast<double>(members_.size() - 1)));
  return {lower, position - static_cast<double>(lower)};
}

}  // namespace cloudbow
