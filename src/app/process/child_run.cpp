#include "app/process/child_run.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "app/process/interrupt.hpp"

namespace cloudbow {
namespace {

constexpr const char* this_program = "/proc/self/exe";
constexpr std::chrono::milliseconds between_looks{10};

pid_t start(const std::vector<std::string>& arguments) {
  std::string name = "cloudbow";
  std::vector<std::string> words = arguments;
  std::vector<char*> argv{name.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = posix_spawn(&child, this_program, &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::system_error(error, std::generic_category(), "start a process");
  return child;
}

/// @param options of waitpid. @returns whether it has ended.
bool ended(pid_t child, int options, int& status) {
  pid_t found = 0;
  do found = waitpid(child, &status, options);
  while (found < 0 && errno == EINTR);
  if (found < 0) throw std::system_error(errno, std::generic_category(), "wait for a process");
  return found == child;
}

}  // namespace

int run_child(const std::vector<std::string>& arguments) {
  const pid_t child = start(arguments);
  int status = 0;
  try {
    // A signal may reach this process alone, so it looks instead of sleeping until the child's end.
    while (!ended(child, WNOHANG, status)) {
      InterruptGuard::check();
      std::this_thread::sleep_for(between_looks);
    }
  } catch (const Interrupted&) {
    kill(child, SIGTERM);
    ended(child, 0, status);
    throw;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace cloudbow
