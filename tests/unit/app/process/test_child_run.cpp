// This program as a child of itself: of this test, that is the test program. Truth: its exit codes.
#include <gtest/gtest.h>
#include <signal.h>

#include "app/process/child_run.hpp"
#include "app/process/interrupt.hpp"

namespace cloudbow {
namespace {

// As a child, the program runs one of the tests below.
std::vector<std::string> only(const std::string& test) {
  return {"--gtest_also_run_disabled_tests", "--gtest_filter=ChildRun.DISABLED_" + test};
}

TEST(ChildRun, DISABLED_Passes) {}
TEST(ChildRun, DISABLED_Fails) { std::exit(7); }
TEST(ChildRun, DISABLED_Dies) {
  signal(SIGTERM, SIG_DFL);
  raise(SIGTERM);
}
TEST(ChildRun, DISABLED_Waits) { pause(); }

TEST(ChildRun, ReturnsTheExitCode) {
  testing::internal::CaptureStdout();
  EXPECT_EQ(run_child(only("Passes")), 0);
  EXPECT_EQ(run_child(only("Fails")), 7);
  EXPECT_EQ(run_child(only("Dies")), 128 + SIGTERM);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "") << "what a child prints is discarded";
}

TEST(ChildRun, ASignalEndsTheChildToo) {
  const InterruptGuard guard;
  raise(SIGTERM);
  EXPECT_THROW(run_child(only("Waits")), Interrupted);
}

}  // namespace
}  // namespace cloudbow
