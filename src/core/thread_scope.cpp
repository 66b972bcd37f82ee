#include "cloudbow/core/thread_scope.hpp"

#include <omp.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace cloudbow {
namespace {

// OpenMP ends the process if it cannot start a thread. So they are tried before: as many in addition to the caller's as
// it will start, all existing at the same time.
int startable(int wanted) {
  std::mutex mutex;
  std::condition_variable all_tried;
  bool tried = false;
  std::vector<std::thread> started;
  try {
    started.reserve(static_cast<std::size_t>(wanted));
    while (static_cast<int>(started.size()) + 1 < wanted) {
      started.emplace_back([&] {
        std::unique_lock lock(mutex);
        all_tried.wait(lock, [&] { return tried; });
      });
    }
  } catch (const std::system_error&) {
  } catch (const std::bad_alloc&) {
  }
  {
    const std::scoped_lock lock(mutex);
    tried = true;
  }
  all_tried.notify_all();
  for (std::thread& thread : started) thread.join();
  return static_cast<int>(started.size()) + 1;
}

// OpenMP keeps threads once they are started.
thread_local int started_so_far = 1;

}  // namespace

ThreadScope::ThreadScope(int threads) : before_(omp_get_max_threads()) {
  int count = threads > 0 ? threads : before_;
  if (count > started_so_far) {
    count = std::max(started_so_far, startable(count));
    omp_set_num_threads(count);
    // Nothing throws here.
#pragma omp parallel
    static_cast<void>(omp_get_thread_num());
    started_so_far = count;
  }
  omp_set_num_threads(count);
}

ThreadScope::~ThreadScope() { omp_set_num_threads(before_); }

}  // namespace cloudbow
