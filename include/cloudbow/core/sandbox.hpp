// Reads an untrusted file in a child process first, so that a crash in a library becomes an error message.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "cloudbow/core/file_library_lock.hpp"

namespace cloudbow {

struct SandboxOptions {
  std::string library{};           ///< that reads the file, as messages name it
  std::uint64_t memory_bytes = 0;  ///< beyond what the process has; 0: half of what is available
  std::uint64_t wall_seconds = 0;  ///< 0: one minute, and one second per megabyte of the file
  std::uint64_t cpu_seconds = 0;   ///< 0: 5 s, and one second per megabyte of the file
};

/// Runs `read` in a child process with limits on memory, CPU seconds and seconds on the clock. The child has one
/// thread: `read` must not wait for others, which OpenMP's loops do.
/// @throws InputError with the message of what `read` throws there. It then never begins in this process: libraries
/// leak what they have half read. Also if the child crashes, is killed, runs out of memory or out of time. Limits that
/// the process has itself are kept; if they leave little memory, the message says so.
void read_in_sandbox(const std::filesystem::path& path, const SandboxOptions& options,
                     const std::function<void()>& read);

/// Bytes that `ulimit -v` and `ulimit -d` leave beyond what this process has; the largest number if there is no limit.
std::uint64_t memory_left_by_limits();

/// Result of `read` in this process, after it succeeded in a child.
template <class Read>
auto after_sandbox(const std::filesystem::path& path, const SandboxOptions& options, const Read& read) {
  const FileLibraryLock lock;
  read_in_sandbox(path, options, [&read] { static_cast<void>(read()); });
  return read();
}

}  // namespace cloudbow
