// The flux of light that arrives at a Lambertian ground. It is added up in the order of the ordinates, whichever
// threads march them. Rays are kept only until it is their turn: those of all ordinates take much memory.
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "transport/system/ground.hpp"

namespace cloudbow {

template <class Real>
class ArrivingSum {
 public:
  /// @param flux as of add_arriving(). References last as long as this object.
  ArrivingSum(const OrdinateSet& ordinates, const BoxGrid& box, std::span<double> flux)
      : ordinates_(ordinates), box_(box), flux_(flux) {}

  /// Ordinates that arrive next, in the order in which they are added.
  void start(std::span<const int> group) {
    group_ = group;
    next_ = 0;
  }
  /// Adds the rays of group[place], or keeps them until those before have come. Called by any thread.
  /// @param rays room for other rays afterwards
  void add(std::size_t place, ArrivingRays<Real>& rays) {
    const std::lock_guard lock(mutex_);
    if (place != next_) {
      std::swap(waiting_[place], rays);
      if (!spare_.empty()) {
        rays = std::move(spare_.back());
        spare_.pop_back();
      }
      return;
    }
    add_next(rays);
    for (auto first = waiting_.begin(); first != waiting_.end() && first->first == next_;
         first = waiting_.erase(first)) {
      add_next(first->second);
      spare_.push_back(std::move(first->second));
    }
  }

 private:
  void add_next(const ArrivingRays<Real>& rays) { add_arriving(rays, ordinates_, group_[next_++], box_, flux_); }

  const OrdinateSet& ordinates_;
  const BoxGrid& box_;
  std::span<double> flux_;
  std::span<const int> group_;
  std::size_t next_ = 0;
  std::map<std::size_t, ArrivingRays<Real>> waiting_;
  std::vector<ArrivingRays<Real>> spare_;
  std::mutex mutex_;
};

}  // namespace cloudbow
