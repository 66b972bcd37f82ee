// When threads are worth waking: results do not depend on it.
#pragma once

#include <cstddef>

namespace cloudbow {

/// Fewer cells are swept sooner than threads have met at their barriers.
inline constexpr std::size_t worth_threads = 5000;

/// One if there are few cells, else as many as are given.
inline int threads_for(std::size_t cells, int threads) { return cells < worth_threads ? 1 : threads; }

}  // namespace cloudbow
