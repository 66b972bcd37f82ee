// When threads are worth waking: results do not depend on it.
#pragma once

#include <omp.h>

#include <cstddef>

namespace cloudbow {

/// Fewer cells are swept sooner than threads have met at their barriers.
inline constexpr std::size_t worth_threads = 5000;

/// One thread in this scope where there are few cells.
class ThreadsFor {
 public:
  explicit ThreadsFor(std::size_t cells) : before_(omp_get_max_threads()) {
    if (cells < worth_threads) omp_set_num_threads(1);
  }
  ~ThreadsFor() { omp_set_num_threads(before_); }
  ThreadsFor(const ThreadsFor&) = delete;
  ThreadsFor& operator=(const ThreadsFor&) = delete;

 private:
  int before_;
};

}  // namespace cloudbow
