// The program survives any fault of a child process, with one message. Truth: the requirement, each fault made on
// purpose.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <stdexcept>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/sandbox.hpp"

namespace {

using cloudbow::InputError;
using cloudbow::read_in_sandbox;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::filesystem::path file = CLOUDBOW_SOURCE_DIR "/README.md";

std::string message_of(const std::function<void()>& read, const cloudbow::SandboxOptions& limits = {}) {
  cloudbow::SandboxOptions options = limits;
  options.library = "Papyrus";
  try {
    read_in_sandbox(file, options, read);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(Sandbox, PassesWhatGoesWell) {
  EXPECT_EQ(message_of([] {}), "nothing thrown");
}

TEST(Sandbox, ChangesNothingInThisProcess) {
  int reads = 0;
  read_in_sandbox(file, {}, [&] { ++reads; });
  EXPECT_EQ(reads, 0);
  EXPECT_EQ(cloudbow::after_sandbox(file, {}, [&] { return ++reads; }), 1);
}

/// Word of a child about a descriptor.
std::string message_about(int descriptor) {
  return message_of([descriptor] { throw InputError(fcntl(descriptor, F_GETFD) == -1 ? "closed" : "open"); });
}

// flock(2): a lock lasts until all descriptors of the open file are closed, in any process. This process may close the
// file while a child reads another one; whoever locks it next must find it free.
TEST(Sandbox, HoldsNoLockOfThisProcess) {
  const std::filesystem::path other = testing::TempDir() + "/cloudbow-locked-" + std::to_string(getpid());
  const int locked = open(other.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(flock(locked, LOCK_EX), 0);
  EXPECT_EQ(message_about(locked), "closed");
  // Closed in the child, it stays locked here.
  const int next = open(other.c_str(), O_RDWR | O_CLOEXEC);
  EXPECT_NE(flock(next, LOCK_EX | LOCK_NB), 0);
  close(locked);
  EXPECT_EQ(flock(next, LOCK_EX | LOCK_NB), 0);
  close(next);
  std::filesystem::remove(other);
}

// HDF5 takes a file that it has open already from the descriptor that it has.
TEST(Sandbox, KeepsFilesThatThisProcessReads) {
  const std::filesystem::path other = testing::TempDir() + "/cloudbow-read-" + std::to_string(getpid());
  std::ofstream(other) << "read";
  const int read_only = open(other.c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(message_about(read_only), "open");
  close(read_only);
  const int itself = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_EQ(message_about(itself), "open");
  close(itself);
  std::filesystem::remove(other);
}

TEST(Sandbox, HandsOnTheMessageOfAnError) {
  const std::string said(5000, 'x');  // more than one read of a pipe's buffer takes
  EXPECT_EQ(message_of([&] { throw InputError(said); }), said);
}

TEST(Sandbox, TellsACrash) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) {
    EXPECT_THAT(message_of([=] {
                  ::signal(signal, SIG_DFL);
                  raise(signal);
                }),
                AllOf(HasSubstr(file.string()), HasSubstr("Papyrus crashes on it")));
  }
}

TEST(Sandbox, TellsAnExit) {
  EXPECT_THAT(message_of([] { _exit(1); }), HasSubstr("Papyrus gives up on it"));
}

TEST(Sandbox, EndsAnEndlessComputation) {
  EXPECT_THAT(message_of(
                  [] {
                    for (volatile bool ends = false; !ends;) {
                    }
                  },
                  {.wall_seconds = 600, .cpu_seconds = 1}),
              HasSubstr("Papyrus computes more than 1 s on it"));
}

TEST(Sandbox, EndsAnEndlessWait) {
  EXPECT_THAT(message_of([] { pause(); }, {.wall_seconds = 1}), HasSubstr("Papyrus needs more than 1 s for it"));
}

TEST(Sandbox, RefusesMemoryBeyondTheLimit) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (pages > 200'000'000) GTEST_SKIP() << "a sanitizer has reserved terabytes of addresses";
  EXPECT_THAT(message_of(
                  [] {
                    const std::vector<char> large(500'000'000, 'x');
                    // Looked at, lest a compiler leave it out.
                    const volatile char* const last = &large.back();
                    if (*last != 'x') _exit(1);
                  },
                  {.memory_bytes = 100'000'000}),
              HasSubstr("Papyrus needs more than 100 MB for it"));
}

TEST(Sandbox, TellsAKilledProcess) {
  // As the system kills when memory runs out, at once: no time has been spent.
  EXPECT_THAT(message_of([] { raise(SIGKILL); }), AllOf(HasSubstr("was killed"), Not(HasSubstr("damaged"))));
}

TEST(Sandbox, EndsAnEndlessComputationThoughTheHostIgnoresItsSignal) {
  const auto before = signal(SIGXCPU, SIG_IGN);
  const std::string message = message_of(
      [] {
        for (volatile bool ends = false; !ends;) {
        }
      },
      {.wall_seconds = 600, .cpu_seconds = 1});
  signal(SIGXCPU, before);
  EXPECT_THAT(message, HasSubstr("Papyrus computes more than 1 s on it"));
}

TEST(Sandbox, HandsOnAMessageThoughStandardStreamsAreClosed) {
  // A process of its own, because the test's streams stay open.
  const pid_t child = fork();
  if (child == 0) {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) close(stream);
    _exit(message_of([] { throw InputError("said"); }) == "said" ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/// In a process that may allocate this much more memory.
void expect_within_limit(rlim_t bytes, const std::function<bool()>& check) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (pages > 200'000'000) GTEST_SKIP() << "a sanitizer has reserved terabytes of addresses";
  const pid_t child = fork();
  if (child == 0) {
    const rlim_t all = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + bytes;
    const rlimit limit{all, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
    _exit(check() ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

TEST(Sandbox, TellsTheHostsLimitOfMemoryFromADamagedFile) {
  expect_within_limit(100'000'000, [] {
    const std::string message = message_of([] { throw std::bad_alloc(); });
    return message.find("ulimit -v") != std::string::npos && message.find("damaged") == std::string::npos;
  });
  expect_within_limit(100'000'000, [] {
    const std::string message = message_of([] { abort(); });
    return message.find("ulimit -v") != std::string::npos && message.find("damaged") == std::string::npos;
  });
}

TEST(Sandbox, RaisesNoLimitOfTheHost) {
  expect_within_limit(100'000'000, [] {
    rlimit before{};
    getrlimit(RLIMIT_AS, &before);
    return message_of([before] {
             rlimit now{};
             getrlimit(RLIMIT_AS, &now);
             if (now.rlim_cur > before.rlim_cur) throw InputError("raised");
           }) == "nothing thrown";
  });
}

TEST(Sandbox, AGenerousLimitOfTheHostChangesNoMessage) {
  expect_within_limit(2'000'000'000, [] {
    return message_of([] { throw InputError("said"); }, {.memory_bytes = 1'000'000'000}) == "said";
  });
}

}  // namespace
