// Signals that end a run. Truth: sigaction(2).
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/process/interrupt.hpp"

namespace cloudbow {
namespace {

/// Handler of SIGINT.
auto handler() {
  struct sigaction found {};
  sigaction(SIGINT, nullptr, &found);
  return found.sa_handler;
}

TEST(InterruptGuard, NotesASignalAndThrowsItWhenAsked) {
  const auto before = handler();
  {
    const InterruptGuard guard;
    EXPECT_FALSE(InterruptGuard::noted());
    EXPECT_NO_THROW(InterruptGuard::check());
    raise(SIGTERM);
    EXPECT_TRUE(InterruptGuard::noted());
    try {
      InterruptGuard::check();
      ADD_FAILURE() << "nothing thrown";
    } catch (const Interrupted& interrupted) {
      EXPECT_EQ(interrupted.signal, SIGTERM);
    }
  }
  EXPECT_EQ(handler(), before);
  const InterruptGuard next;
  EXPECT_FALSE(InterruptGuard::noted()) << "of an earlier guard";
}

TEST(InterruptGuard, TheSecondSignalEndsTheProcess) {
  const pid_t child = fork();
  if (child == 0) {
    signal(SIGINT, SIG_DFL);
    const InterruptGuard guard;
    raise(SIGINT);
    raise(SIGINT);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT);
}

TEST(InterruptGuard, LeavesIgnoredSignalsIgnored) {
  const auto before = signal(SIGINT, SIG_IGN);
  {
    const InterruptGuard guard;
    raise(SIGINT);
    EXPECT_FALSE(InterruptGuard::noted());
  }
  signal(SIGINT, before);
}

}  // namespace
}  // namespace cloudbow
