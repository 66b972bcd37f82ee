#include "cloudbow/core/sandbox.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

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
  rlim_t memory_bytes;     ///< beyond what the process has
  bool memory_is_of_host;  ///< ulimit leaves less than the sandbox would
  bool memory_is_short;    ///< and so little that a sound file may fail in any way
};

struct MemoryInUse {
  rlim_t addresses;
  rlim_t data;
};

MemoryInUse memory_in_use() {
  // All pages, resident, shared, text, libraries, data (proc(5)).
  std::array<rlim_t, 6> pages{};
  std::ifstream status("/proc/self/statm");
  for (rlim_t& count : pages) status >> count;
  const auto page = static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
  return {pages[0] * page, pages[5] * page};
}

/// Amount that a limit leaves beyond what is in use.
rlim_t room_below(auto resource, rlim_t in_use) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return RLIM_INFINITY;
  return limit.rlim_cur - std::min(limit.rlim_cur, in_use);
}

/// Parsing takes less than 0.1 s and 0.1 s per megabyte; a network disk delivers at least one megabyte per second.
Limits limits_for(const std::filesystem::path& path, const SandboxOptions& options) {
  std::error_code error;
  const auto bytes = std::filesystem::file_size(path, error);
  const rlim_t megabytes = error ? 0 : static_cast<rlim_t>(bytes) / megabyte;
  const rlim_t left = memory_left_by_limits();
  // The available memory is within these limits too.
  const rlim_t half = available_memory_bytes() / 2;
  const rlim_t memory = options.memory_bytes > 0 ? options.memory_bytes : half;
  const bool of_host = left < (options.memory_bytes > 0 ? memory : 2 * half);
  // Libraries need some 30 MB for themselves, and buffers of about the file's size.
  const rlim_t comfortable = (128 + 2 * megabytes) * megabyte;
  return {options.cpu_seconds > 0 ? options.cpu_seconds : 5 + megabytes,
          options.wall_seconds > 0 ? options.wall_seconds : 60 + megabytes, of_host ? left : memory, of_host,
          of_host && left < comfortable};
}

/// Lowers a limit, never raises one that the host has set.
void lower_limit(auto resource, rlim_t soft, rlim_t hard) {
  rlimit limit{};
  if (getrlimit(resource, &limit) != 0) return;
  limit.rlim_max = std::min(limit.rlim_max, hard);
  limit.rlim_cur = std::min({limit.rlim_cur, soft, limit.rlim_max});
  setrlimit(resource, &limit);
}

void impose(const Limits& limits) {
  // The kernel ends a process by SIGXCPU at the soft limit and by SIGKILL at the hard one.
  lower_limit(RLIMIT_CPU, limits.cpu_seconds, limits.cpu_seconds + 1);
  lower_limit(RLIMIT_CORE, 0, 0);
  sigset_t deadlines;
  sigemptyset(&deadlines);
  for (const int deadline : {SIGXCPU, SIGALRM}) {
    signal(deadline, SIG_DFL);
    sigaddset(&deadlines, deadline);
  }
  sigprocmask(SIG_UNBLOCK, &deadlines, nullptr);
  alarm(static_cast<unsigned>(limits.wall_seconds));
  // Sanitizers reserve terabytes of addresses, and no limit of memory can be set by them.
  constexpr rlim_t terabyte = 1000000 * megabyte;
  const rlim_t in_use = memory_in_use().addresses;
  if (in_use > terabyte) return;
  lower_limit(RLIMIT_AS, in_use + limits.memory_bytes, in_use + limits.memory_bytes);
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

/// Closes the descriptors of the host, so that its locks on files do not last until the child ends. Regular files that
/// are open for reading stay, and the file that is read: HDF5 opens no file a second time if its host has it open.
void close_files_of_host(const std::filesystem::path& path, int answer) {
  struct stat read {};
  const bool exists = stat(path.c_str(), &read) == 0;
  std::vector<int> open_files;
  std::error_code error;
  for (std::filesystem::directory_iterator entry("/proc/self/fd", error), end; !error && entry != end;
       entry.increment(error)) {
    open_files.push_back(std::atoi(entry->path().filename().c_str()));
  }
  for (const int file : open_files) {
    struct stat found {};
    if (file <= STDERR_FILENO || file == answer || fstat(file, &found) != 0) continue;
    const bool is_read = exists && found.st_dev == read.st_dev && found.st_ino == read.st_ino;
    const bool is_read_only = (fcntl(file, F_GETFL) & O_ACCMODE) == O_RDONLY;
    if (!S_ISREG(found.st_mode) || !(is_read || is_read_only)) close(file);
  }
}

[[noreturn]] void perform(const std::filesystem::path& path, const Limits& limits,
                          const std::function<void()>& read_file, int answer) {
  close_files_of_host(path, answer);
  impose(limits);
  // The parent's read prints the messages of the library again, so the child's are discarded.
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) {
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    if (nowhere > STDERR_FILENO) close(nowhere);
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

/// A pipe none of whose ends is a standard stream, which the child turns elsewhere: its parent may have closed them.
std::array<int, 2> open_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe2");
  for (int& end : ends) {
    if (end > STDERR_FILENO) continue;
    const int moved = fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (moved < 0) throw std::system_error(errno, std::generic_category(), "fcntl");
    close(end);
    end = moved;
  }
  return ends;
}

struct Ending {
  int signal;  ///< 0: exited by itself
  int code;
  double cpu_seconds;
};

Ending wait_for(pid_t child) {
  int status = 0;
  rusage use{};
  while (wait4(child, &status, 0, &use) < 0) {
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "wait4");
  }
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return {WIFSIGNALED(status) ? WTERMSIG(status) : 0, WIFEXITED(status) ? WEXITSTATUS(status) : 0,
          seconds(use.ru_utime) + seconds(use.ru_stime)};
}

/// Throws the error that the child's exit status implies for the file, if any.
void judge(const std::string& path, const std::string& library, const Limits& limits, const Ending& end,
           const std::string& message) {
  const auto short_of_memory = [&](const std::string& found) {
    return InputError(fmt::format(
        "{}: can't be read with so little memory (found {}, allowed by the limits of this process {} MB more than it "
        "has); raise `ulimit -v` and `ulimit -d`",
        path, found, limits.memory_bytes / megabyte));
  };
  const auto damaged = [&](const std::string& found) {
    return InputError(fmt::format("{}: the file is damaged ({}); get a complete copy", path, found));
  };
  if (end.signal == SIGXCPU || (end.signal == SIGKILL && end.cpu_seconds >= static_cast<double>(limits.cpu_seconds))) {
    throw damaged(fmt::format("{} computes more than {} s on it", library, limits.cpu_seconds));
  }
  if (end.signal == SIGKILL) {
    throw InputError(fmt::format(
        "{}: can't be read (the process that tried it first, with {}, was killed: by the system, which does "
        "so if memory runs out, or by a user); try again with more memory",
        path, library));
  }
  if (end.signal == SIGALRM) throw damaged(fmt::format("{} needs more than {} s for it", library, limits.wall_seconds));
  if (end.code == out_of_memory && limits.memory_is_of_host)
    throw short_of_memory(fmt::format("{} needs more", library));
  if (end.code == out_of_memory)
    throw damaged(fmt::format("{} needs more than {} MB for it", library, limits.memory_bytes / megabyte));
  if (end.code == found_an_error && limits.memory_is_short) {
    throw InputError(
        fmt::format("{} (memory may be the reason: the limits of this process leave {} MB; raise `ulimit "
                    "-v` and `ulimit -d`)",
                    message, limits.memory_bytes / megabyte));
  }
  if (end.code == found_an_error) throw InputError(message);
  if (end.signal == 0 && end.code == 0) return;
  const std::string found = fmt::format("{} {} on it", library, end.signal != 0 ? "crashes" : "gives up");
  throw limits.memory_is_short ? short_of_memory(found) : damaged(found);
}

}  // namespace

std::uint64_t memory_left_by_limits() {
  const MemoryInUse in_use = memory_in_use();
  return std::min(room_below(RLIMIT_AS, in_use.addresses), room_below(RLIMIT_DATA, in_use.data));
}

void read_in_sandbox(const std::filesystem::path& path, const SandboxOptions& options,
                     const std::function<void()>& read) {
  const FileLibraryLock lock;
  const Limits limits = limits_for(path, options);
  const std::array<int, 2> answer = open_pipe();
  const pid_t child = fork();
  if (child == 0) perform(path, limits, read, answer[1]);
  const int fork_error = errno;
  close(answer[1]);
  const std::string message = child > 0 ? read_all(answer[0]) : "";
  close(answer[0]);
  if (child < 0) throw std::system_error(fork_error, std::generic_category(), "fork");
  judge(path.string(), options.library, limits, wait_for(child), message);
}

}  // namespace cloudbow
