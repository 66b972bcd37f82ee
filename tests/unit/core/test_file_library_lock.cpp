// Truth: a lock is held by one thread at a time, and by that thread as often as it likes.
#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "cloudbow/core/file_library_lock.hpp"

namespace cloudbow {
namespace {

TEST(FileLibraryLock, IsHeldByOneThreadAtATime) {
  int inside = 0, most = 0, rounds = 0;
  std::vector<std::thread> threads;
  for (int n = 0; n < 4; ++n) {
    threads.emplace_back([&] {
      for (int round = 0; round < 1000; ++round) {
        const FileLibraryLock lock;
        const FileLibraryLock again;
        most = std::max(most, ++inside);
        ++rounds;
        --inside;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(most, 1);
  EXPECT_EQ(rounds, 4000);
}

TEST(FileLibraryLock, CallsTheLockOfItsHost) {
  static int depth = 0, most = 0;
  FileLibraryLock::use([] { most = std::max(most, ++depth); }, [] { --depth; });
  {
    const FileLibraryLock lock;
    EXPECT_EQ(depth, 1);
    const FileLibraryLock again;
    EXPECT_EQ(depth, 2);
  }
  FileLibraryLock::use(nullptr, nullptr);
  EXPECT_EQ(depth, 0);
  { const FileLibraryLock own; }
  EXPECT_EQ(most, 2);
}

}  // namespace
}  // namespace cloudbow
