#include "cloudbow/transport/threads.hpp"

#include <omp.h>

namespace cloudbow {

ThreadsFor::ThreadsFor(std::size_t cells) : before_(omp_get_max_threads()) {
  if (cells < worth_threads) omp_set_num_threads(1);
}

ThreadsFor::~ThreadsFor() { omp_set_num_threads(before_); }

}  // namespace cloudbow
