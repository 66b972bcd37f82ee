// Anderson mixing of a fixed point x = g(x) (Anderson 1965; Walker & Ni 2011).
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace cloudbow {

/// Data of earlier iterates, the oldest first.
template <class Real>
struct AndersonHistory {
  std::vector<Real> last_residual;
  std::vector<Real> last_g;
  std::deque<std::vector<Real>> residual_change;
  std::deque<std::vector<Real>> g_change;

  /// Arrays of `size` for a history of `changes`.
  void make_room(std::size_t size, std::size_t changes) {
    last_residual.resize(size);
    last_g.resize(size);
    residual_change.assign(changes, std::vector<Real>(size));
    g_change.assign(changes, std::vector<Real>(size));
  }
};

template <class Real>
class AndersonMixer {
 public:
  explicit AndersonMixer(int depth) : depth_(depth) {}

  /// Replaces x (the argument) by the next iterate, given g(x).
  void advance(std::span<Real> x, std::span<const Real> g);

  int depth() const { return depth_; }
  AndersonHistory<Real>& history() { return history_; }

 private:
  int depth_;
  AndersonHistory<Real> history_;
};

/// Sum of a[i] b[i] in double, in a fixed order whatever the number of threads.
template <class Real>
double ordered_dot(std::span<const Real> a, std::span<const Real> b);

}  // namespace cloudbow
