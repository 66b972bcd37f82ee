// Anderson mixing of a fixed point x = g(x) (Anderson 1965; Walker & Ni 2011).
#pragma once

#include <deque>
#include <span>
#include <vector>

namespace cloudbow {

template <class Real>
class AndersonMixer {
 public:
  explicit AndersonMixer(int depth) : depth_(depth) {}

  /// Replaces x (the argument) by the next iterate, given g(x).
  void advance(std::span<Real> x, std::span<const Real> g);

 private:
  int depth_;
  std::vector<Real> last_residual_;
  std::vector<Real> last_g_;
  std::deque<std::vector<Real>> residual_change_;
  std::deque<std::vector<Real>> g_change_;
};

/// Sum of a[i] b[i] in double, in a fixed order whatever the number of threads.
template <class Real>
double ordered_dot(std::span<const Real> a, std::span<const Real> b);

}  // namespace cloudbow
