#include "rehearsal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
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

#include "cloudbow/core/error.hpp"

namespace cloudbow {

namespace {

constexpr int found_an_error = 1;
constexpr int out_of_memory = 2;

struct Limits {
  rlim_t cpu_seconds;
  rlim_t memory_bytes;  ///< beyond what the process has
};

/// Parsing takes less than 0.1 s and, of a grid of constant leaves, 30 MB for each megabyte of the file; then something
/// to spare.
Limits limits_for(const std::filesystem::path& path) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  const auto size = error ? rlim_t{0} : static_cast<rlim_t>(bytes);
  return {5 + size / 1000000, 64 * size + 512000000};
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
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they reserve terabytes of addresses
  const rlim_t bytes = address_space_in_use() + limits.memory_bytes;
  const rlimit memory{bytes, bytes};
  setrlimit(RLIMIT_AS, &memory);
#endif
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

[[noreturn]] void perform(const Limits& limits, const std::function<void()>& parse, int answer) {
  impose(limits);
  // What the library says, it will say again.
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
  }
  int status = 0;
  try {
    parse();
  } catch (const std::bad_alloc&) {
    status = out_of_memory;
  } catch (const std::exception& error) {
    status = found_an_error;
    write_all(answer, error.what());
  }
  _exit(status);
}

}  // namespace

void rehearse(const std::filesystem::path& path, const std::function<void()>& parse) {
  const Limits limits = limits_for(path);
  std::array<int, 2> answer{};
  if (pipe2(answer.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe2");
  const pid_t child = fork();
  if (child == 0) perform(limits, parse, answer[1]);
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
  if (WIFSIGNALED(status)) {
    if (WTERMSIG(status) != SIGXCPU && WTERMSIG(status) != SIGKILL) throw damaged("OpenVDB crashes on it");
    throw damaged(fmt::format("OpenVDB needs more than {} s for it", limits.cpu_seconds));
  }
  if (WEXITSTATUS(status) == found_an_error) throw InputError(message);
  if (WEXITSTATUS(status) == out_of_memory) {
    throw damaged(fmt::format("OpenVDB needs more than {} MB for it", limits.memory_bytes / 1000000));
  }
}

}  // namespace cloudbow
