// Work within a host: its functions are called, and its signals stay its own. Truth: what a program that loads a
// library may rely on.
#include <gtest/gtest.h>
#include <signal.h>

#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "app/process/host.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/process/progress.hpp"

namespace cloudbow {
namespace {

HostCalls silent() {
  return {[] {}, [](const std::string&) {}};
}

TEST(HostScope, MessagesAreThoseOfItsThread) {
  std::vector<std::string> here, inner;
  {
    const HostScope scope({[] {}, [&](const std::string& text) { here.push_back(text); }});
    tell("{} cells\n", 3);
    {
      const HostScope within({[] {}, [&](const std::string& text) { inner.push_back(text); }});
      tell("within\n");
    }
    tell("after\n");
    std::thread([] { EXPECT_EQ(HostScope::calls(), nullptr); }).join();
  }
  EXPECT_EQ(HostScope::calls(), nullptr);
  EXPECT_EQ(here, (std::vector<std::string>{"3 cells\n", "after\n"}));
  EXPECT_EQ(inner, std::vector<std::string>{"within\n"});
}

TEST(HostScope, InterruptsAreThoseOfTheHost) {
  struct Stop {};
  bool wanted = false;
  HostCalls calls = silent();
  calls.check_interrupt = [&] {
    if (wanted) throw Stop();
  };
  const HostScope scope(calls);
  const InterruptGuard guard;
  EXPECT_NO_THROW(InterruptGuard::check());
  wanted = true;
  EXPECT_THROW(InterruptGuard::check(), Stop);
  EXPECT_FALSE(InterruptGuard::noted());
}

TEST(HostScope, LeavesSignalHandlersAlone) {
  struct sigaction own {
  }, found{};
  own.sa_handler = [](int) {};
  sigemptyset(&own.sa_mask);
  struct sigaction before {};
  sigaction(SIGINT, &own, &before);
  {
    const HostScope scope(silent());
    const InterruptGuard guard;
    sigaction(SIGINT, nullptr, &found);
    EXPECT_EQ(found.sa_handler, own.sa_handler);
  }
  sigaction(SIGINT, nullptr, &found);
  EXPECT_EQ(found.sa_handler, own.sa_handler);
  {
    const InterruptGuard guard;  // in the program itself
    sigaction(SIGINT, nullptr, &found);
    EXPECT_NE(found.sa_handler, own.sa_handler);
  }
  sigaction(SIGINT, &before, nullptr);
}

TEST(HostScope, ProgressGoesToTheHost) {
  std::vector<int> sweeps;
  HostCalls calls = silent();
  calls.progress = [&](const SolverProgress& progress) { sweeps.push_back(progress.sweep); };
  SolverProgress progress;
  progress.sweep = 7;
  testing::internal::CaptureStderr();
  {
    const HostScope scope(calls);
    ProgressDisplay(/*quiet=*/true, 1e-3).show(progress);
    ProgressDisplay(/*quiet=*/false, 1e-3).show(progress);
  }
  {
    const HostScope scope(silent());
    ProgressDisplay(/*quiet=*/false, 1e-3).show(progress);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(sweeps, (std::vector<int>{7, 7}));
}

}  // namespace
}  // namespace cloudbow
