#include <gtest/gtest.h>
#include <omp.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "cloudbow/core/thread_scope.hpp"

namespace cloudbow {
namespace {

int threads_of_a_region() {
  int count = 0;
#pragma omp parallel
  {
#pragma omp single
    count = omp_get_num_threads();
  }
  return count;
}

TEST(ThreadScope, EndsWithAsManyThreadsAsBefore) {
  omp_set_num_threads(3);
  {
    const ThreadScope one(1);
    EXPECT_EQ(threads_of_a_region(), 1);
    {
      const ThreadScope four(4);
      EXPECT_EQ(threads_of_a_region(), 4);
      const ThreadScope same(0);
      EXPECT_EQ(threads_of_a_region(), 4);
    }
    EXPECT_EQ(threads_of_a_region(), 1);
  }
  EXPECT_EQ(omp_get_max_threads(), 3);
}

// In a child, which has no earlier threads: ctest runs each case in a separate process. The stack per thread takes 8 MB
// of addresses or more; OpenMP would end the process if there is no room for it.
TEST(ThreadScope, HasFewerThreadsIfNoMoreCanBeStarted) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "no limit of memory can be set under a sanitizer";
#endif
  const pid_t child = fork();
  if (child == 0) {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t room = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + 100'000'000;
    const rlimit limit{room, room};
    setrlimit(RLIMIT_AS, &limit);
    const ThreadScope many(500);
    const int count = threads_of_a_region();
    _exit(count > 1 && count < 500 ? 0 : 1);
  }
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace cloudbow
