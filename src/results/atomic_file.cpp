#include "atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "cloudbow/core/error.hpp"
#include "cloudbow/results/result_file.hpp"

namespace cloudbow {

namespace fs = std::filesystem;

namespace {

std::string system_message(int error) { return std::generic_category().message(error); }

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

void check_target(const fs::path& target) {
  if (target.filename().empty()) throw_unwritable(target, "the name of a file is missing");
  std::error_code error;
  const fs::file_status folder = fs::status(folder_of(target), error);
  if (!fs::exists(folder)) throw_unwritable(target, fmt::format("there is no folder {}", folder_of(target).string()));
  if (!fs::is_directory(folder))
    throw_unwritable(target, fmt::format("{} is not a folder", folder_of(target).string()));

  const fs::file_status status = fs::status(target, error);
  if (fs::is_directory(status)) throw_unwritable(target, "it is a directory, name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw_unwritable(target, "it is a device, pipe or socket, name a file");
  // rename() would replace a write-protected file without asking.
  if (fs::exists(status) && access(target.c_str(), W_OK) != 0) throw_unwritable(target, system_message(errno));
}

/// fsync of a file or folder by name; returns errno.
int sync_to_disk(const fs::path& path, int flags) {
  const int descriptor = open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int sync_error = fsync(descriptor) == 0 ? 0 : errno;
  const int close_error = close(descriptor) == 0 ? 0 : errno;
  return sync_error != 0 ? sync_error : close_error;
}

/// Returns errno.
int write_bytes(const std::filesystem::path& file, std::span<const std::uint8_t> bytes) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  int error = 0;
  for (std::size_t done = 0; done < bytes.size() && error == 0;) {
    const ssize_t written = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (written > 0) {
      done += static_cast<std::size_t>(written);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  const int close_error = close(descriptor) == 0 ? 0 : errno;
  return error != 0 ? error : close_error;
}

}  // namespace

void throw_unwritable(const fs::path& file, const std::string& reason) {
  throw InputError(fmt::format("{}: can't be written ({})", file.string(), reason));
}

AtomicFile::AtomicFile(const fs::path& target) : target_(target) {
  check_target(target);
  // What a link points to is replaced, not the link.
  std::error_code error;
  if (const fs::path resolved = fs::canonical(target, error); !error) target_ = resolved;

  for (int attempt = 0;; ++attempt) {
    temporary_ = folder_of(target_) / fmt::format(".{}.{}-{}.tmp", target_.filename().string(), getpid(), attempt);
    const int descriptor = open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (descriptor >= 0) {
      close(descriptor);
      return;
    }
    if (errno != EEXIST) throw_unwritable(target, system_message(errno));
  }
}

AtomicFile::~AtomicFile() {
  if (!committed_) unlink(temporary_.c_str());
}

void AtomicFile::commit() {
  if (const int error = sync_to_disk(temporary_, O_RDWR)) throw_unwritable(target_, system_message(error));
  if (rename(temporary_.c_str(), target_.c_str()) != 0) throw_unwritable(target_, system_message(errno));
  committed_ = true;
  // Some network file systems can't sync a folder (EINVAL), and a folder that may be written need not be readable
  // (EACCES).
  const int error = sync_to_disk(folder_of(target_), O_RDONLY | O_DIRECTORY);
  if (error != 0 && error != EINVAL && error != EACCES) throw_unwritable(target_, system_message(error));
}

void check_writable(const fs::path& file) { const AtomicFile probe(file); }

void write_file_atomically(const fs::path& file, std::span<const std::uint8_t> bytes) {
  AtomicFile target(file);
  if (const int error = write_bytes(target.temporary(), bytes)) throw_unwritable(file, system_message(error));
  target.commit();
}

}  // namespace cloudbow
