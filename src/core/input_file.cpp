#include "cloudbow/core/input_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "cloudbow/core/error.hpp"

namespace cloudbow {

namespace {

std::string why_not(int error) {
  return error == ENOENT || error == ENOTDIR
             ? "no such file"
             : fmt::format("a file that may not be read: {}", std::generic_category().message(error));
}

/// Empty for a regular file.
std::string special_kind(mode_t mode) {
  if (S_ISREG(mode)) return {};
  if (S_ISDIR(mode)) return "a directory";
  if (S_ISFIFO(mode)) return "a named pipe";
  if (S_ISSOCK(mode)) return "a socket";
  return "a device";
}

}  // namespace

std::string unreadable_reason(const std::filesystem::path& file) {
  struct stat found {};
  if (stat(file.c_str(), &found) != 0) return why_not(errno);
  // Opening a device may do something, as rewinding a tape.
  if (const std::string kind = special_kind(found.st_mode); !kind.empty()) return kind;
  // O_NONBLOCK: a pipe may have taken the name since.
  const int descriptor = open(file.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (descriptor < 0) return why_not(errno);
  const int error = fstat(descriptor, &found) == 0 ? 0 : errno;
  close(descriptor);
  return error != 0 ? why_not(error) : special_kind(found.st_mode);
}

void check_input(const std::filesystem::path& file, std::string_view allowed, std::uintmax_t most_bytes) {
  std::string found = unreadable_reason(file);
  if (found.empty() && most_bytes > 0) {
    const std::uintmax_t bytes = std::filesystem::file_size(file);
    if (bytes > most_bytes) found = fmt::format("a larger file, of {} bytes", bytes);
  }
  if (found.empty()) return;
  const std::string most = most_bytes > 0 ? fmt::format(" of at most {} MB", most_bytes >> 20) : "";
  throw InputError(fmt::format("{}: can't be read (found {}, allowed {}{})", file.string(), found, allowed, most));
}

std::ifstream open_input(const std::filesystem::path& file, std::string_view allowed, std::uintmax_t most_bytes) {
  check_input(file, allowed, most_bytes);
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError(fmt::format("{}: can't be opened (allowed: {})", file.string(), allowed));
  return stream;
}

}  // namespace cloudbow
