// What a child process may do to itself, the program survives with one message. Truth: the requirement, each fault made
// on purpose.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/rehearsal.hpp"

namespace {

using cloudbow::InputError;
using cloudbow::rehearse;
using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kFile = CLOUDBOW_SOURCE_DIR "/README.md";

std::string message_of(const std::function<void()>& read, const cloudbow::RehearsalOptions& limits = {}) {
  cloudbow::RehearsalOptions options = limits;
  options.library = "Papyrus";
  try {
    rehearse(kFile, options, read);
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(Rehearsal, PassesWhatGoesWell) {
  EXPECT_EQ(message_of([] {}), "nothing thrown");
}

TEST(Rehearsal, ChangesNothingInThisProcess) {
  int reads = 0;
  rehearse(kFile, {}, [&] { ++reads; });
  EXPECT_EQ(reads, 0);
  EXPECT_EQ(cloudbow::after_rehearsal(kFile, {}, [&] { return ++reads; }), 1);
}

TEST(Rehearsal, HandsOnTheMessageOfAnError) {
  const std::string said(5000, 'x');  // more than one read of a pipe's buffer takes
  EXPECT_EQ(message_of([&] { throw InputError(said); }), said);
}

TEST(Rehearsal, TellsACrash) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) {
    EXPECT_THAT(message_of([=] {
                  ::signal(signal, SIG_DFL);
                  raise(signal);
                }),
                AllOf(HasSubstr(kFile.string()), HasSubstr("Papyrus crashes on it")));
  }
}

TEST(Rehearsal, TellsAnExit) {
  EXPECT_THAT(message_of([] { _exit(1); }), HasSubstr("Papyrus gives up on it"));
}

TEST(Rehearsal, EndsAnEndlessComputation) {
  EXPECT_THAT(message_of(
                  [] {
                    for (volatile bool ends = false; !ends;) {
                    }
                  },
                  {.wall_seconds = 600, .cpu_seconds = 1}),
              HasSubstr("Papyrus computes more than 1 s on it"));
}

TEST(Rehearsal, EndsAnEndlessWait) {
  EXPECT_THAT(message_of([] { pause(); }, {.wall_seconds = 1}), HasSubstr("Papyrus needs more than 1 s for it"));
}

TEST(Rehearsal, RefusesMemoryBeyondTheLimit) {
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

}  // namespace
