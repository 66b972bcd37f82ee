// Anderson mixing of a fixed point x = g(x) (Anderson 1965; Walker & Ni 2011).
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

namespace cloudbow {

class OrdinateShare;

/// Data of earlier iterates, the oldest first.
template <class Real>
struct AndersonHistory {
  bool has_last = false;  ///< there is an earlier iterate; a rank without cells has empty arrays all the same
  std::vector<Real> last_residual;
  std::vector<Real> last_g;
  std::deque<std::vector<Real>> residual_change;
  std::deque<std::vector<Real>> g_change;

  /// Arrays of `size` for a history of `changes`.
  void make_room(std::size_t size, std::size_t changes) {
    has_last = true;
    last_residual.resize(size);
    last_g.resize(size);
    residual_change.assign(changes, std::vector<Real>(size));
    g_change.assign(changes, std::vector<Real>(size));
  }
};

template <class Real>
class AndersonMixer {
 public:
  /// @param sets of values by cell that an iterate consists of. @param share whose cells these are; null: all.
  explicit AndersonMixer(int depth, std::size_t sets = 1, const OrdinateShare* share = nullptr)
      : depth_(depth), sets_(sets), share_(share) {}

  /// Replaces x (the argument) by the next iterate, given g(x). Both [sets][cells].
  void advance(std::span<Real> x, std::span<const Real> g);

  int depth() const { return depth_; }
  AndersonHistory<Real>& history() { return history_; }

 private:
  int depth_;
  std::size_t sets_;
  const OrdinateShare* share_;
  AndersonHistory<Real> history_;
};

/// Sum of a[i] b[i] in double, in a fixed order whatever the number of threads and ranks. Both [sets][cells].
/// @param share whose cells these are: the sum is over those of all ranks. Null: there is one rank.
template <class Real>
double ordered_dot(std::span<const Real> a, std::span<const Real> b, std::size_t sets = 1,
                   const OrdinateShare* share = nullptr);

}  // namespace cloudbow
