// When threads are worth waking: results do not depend on it.
#pragma once

#include <cstddef>

namespace cloudbow {

/// Fewer cells are swept sooner than threads have met at their barriers.
inline constexpr std::size_t worth_threads = 5000;

/// One thread in this scope where there are few cells.
class ThreadsFor {
 public:
  explicit ThreadsFor(std::size_t cells);
  ~ThreadsFor();
  ThreadsFor(const ThreadsFor&) = delete;
  ThreadsFor& operator=(const ThreadsFor&) = delete;

 private:
  int before_;
};

}  // namespace cloudbow
