#include "cloudbow/core/rehearsal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <exception>
#include <fstream>
#include <new>
#include <string>
#include <system_error>

#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {

namespace {

// Not 1, with which sanitizers end a process.
constexpr int found_an_error = 70;
constexpr int out_of_memory = 71;

constexpr rlim_t megabyte = 1000000;

struct Limits {
  rlim_t cpu_seconds;
  rlim_t wall_seconds;
  rlim_t memory_bytes;  ///< beyond what the process has
};

/// Parsing takes less than 0.1 s and 0.1 s for each megabyte; a disk of the network gives at least a megabyte a second.
Limits limits_for(const std::filesystem::path& path, const RehearsalOptions& options) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  const rlim_t megabytes = error ? 0 : static_cast<rlim_t>(bytes) / megabyte;
  return {options.cpu_seconds > 0 ? options.cpu_seconds : 5 + megabytes,
          options.wall_seconds > 0 ? options.wall_seconds : 60 + megabytes,
          options.memory_bytes > 0 ? options.memory_bytes : available_memory_bytes() / 2};
}

rlim_t address_space_in_use() {
  rlim_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

void impose(const Limits& limits) {
  const rlimit cpu{limits.cpu_seconds, limits.cpu_seconds};
  const rlimit no_core_file{0, 0};
  setrlimit(RLIMIT_CPU, &cpu);
  setrlimit(RLIMIT_CORE, &no_core_file);
  signal(SIGALRM, SIG_DFL);
  alarm(static_cast<unsigned>(limits.wall_seconds));
  // Sanitizers reserve terabytes of addresses, and no limit of memory can be set by them.
  constexpr rlim_t terabyte = 1000000 * megabyte;
  const rlim_t in_use = address_space_in_use();
  if (in_use > terabyte) return;
  const rlimit memory{in_use + limits.memory_bytes, in_use + limits.memory_bytes};
  setrlimit(RLIMIT_AS, &memory);
}

void write_all(int file, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const auto written = write(file, text.data() + done, text.size() - done);
    if (written < 0 && errno != EINTR) return;
    if (written > 0) done += static_cast<std::size_t>(written);
  }
}

std::string read_all(int file) {
  std::string text;
  std::array<char, 512> buffer{};
  while (true) {
    const auto bytes = read(file, buffer.data(), buffer.size());
    if (bytes == 0 || (bytes < 0 && errno != EINTR)) return text;
    if (bytes > 0) text.append(buffer.data(), static_cast<std::size_t>(bytes));
  }
}

[[noreturn]] void perform(const Limits& limits, const std::function<void()>& read_file, int answer) {
  impose(limits);
  // What the library says, it will say again.
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  int status = 0;
  try {
    read_file();
  } catch (const std::bad_alloc&) {
    status = out_of_memory;
  } catch (const std::exception& error) {
    status = found_an_error;
    write_all(answer, error.what());
  }
  _exit(status);
}

}  // namespace

void rehearse(const std::filesystem::path& path, const RehearsalOptions& options, const std::function<void()>& read) {
  const Limits limits = limits_for(path, options);
  std::array<int, 2> answer{};
  if (pipe2(answer.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe2");
  const pid_t child = fork();
  if (child == 0) perform(limits, read, answer[1]);
  const int fork_error = errno;
  close(answer[1]);
  const std::string message = child > 0 ? read_all(answer[0]) : "";
  close(answer[0]);
  if (child < 0) throw std::system_error(fork_error, std::generic_category(), "fork");

  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  }
  const auto damaged = [&](const std::string& found) {
    return InputError(fmt::format("{}: the file is damaged ({}) get a complete copy", path.string(), found));
  };
  const std::string& library = options.library;
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal == SIGXCPU || signal == SIGKILL) {
    throw damaged(fmt::format("{} computes more than {} s on it", library, limits.cpu_seconds));
  }
  if (signal == SIGALRM) throw damaged(fmt::format("{} needs more than {} s for it", library, limits.wall_seconds));
  if (signal != 0) throw damaged(fmt::format("{} crashes on it", library));
  if (WEXITSTATUS(status) == found_an_error) throw InputError(message);
  if (WEXITSTATUS(status) == out_of_memory) {
    throw damaged(fmt::format("{} needs more than {} MB for it", library, limits.memory_bytes / megabyte));
  }
  if (WEXITSTATUS(status) != 0) throw damaged(fmt::format("{} gives up on it", library));
}

}  // namespace cloudbow
