// Messages. Truth: the text, and that a log which cannot be written loses no result.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>

#include "app/process/messages.hpp"

namespace cloudbow {
namespace {

TEST(Messages, GoToStderrAsTheyAre) {
  testing::internal::CaptureStderr();
  tell("{} of {}\n", 2, "three");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "2 of three\n");
}

TEST(Messages, ToADiskThatIsFullThrowNothing) {
  const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
  ASSERT_GE(full, 0);
  std::fflush(stderr);
  const int before = dup(STDERR_FILENO);
  dup2(full, STDERR_FILENO);
  EXPECT_NO_THROW(tell("lost\n"));
  dup2(before, STDERR_FILENO);
  std::clearerr(stderr);
  close(before);
  close(full);
}

}  // namespace
}  // namespace cloudbow
