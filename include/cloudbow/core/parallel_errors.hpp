// Errors in OpenMP regions: an exception that left one would end the process.
#pragma once

#include <atomic>
#include <exception>

namespace cloudbow {

/// Carries the first exception out of a parallel region. Everything in the region that may throw, allocations too, is
/// run through it. After an error the rest is skipped, and all threads still meet at their barriers.
class ParallelErrors {
 public:
  template <class Work>
  void run(const Work& work) noexcept {
    if (failed_.load(std::memory_order_relaxed)) return;
    try {
      work();
    } catch (...) {
      if (!failed_.exchange(true)) first_ = std::current_exception();
    }
  }

  /// Called after the region. @throws the exception that was caught first, if any.
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::atomic<bool> failed_ = false;
  std::exception_ptr first_;
};

}  // namespace cloudbow
