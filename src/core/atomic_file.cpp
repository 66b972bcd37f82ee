#include "cloudbow/core/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <optional>
#include <system_error>

#include "cloudbow/core/digest.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {

namespace fs = std::filesystem;

namespace {

std::string system_message(int error) { return std::generic_category().message(error); }

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// Names by which processes of this host and PID namespace identify each other; a file system may be shared with
/// others.
std::string host_tag() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  std::error_code error;
  const std::string name = host.data() + fs::read_symlink("/proc/self/ns/pid", error).string();
  Digest digest;
  digest.add_bytes(name.data(), name.size());
  return fmt::format("{:08x}", static_cast<std::uint32_t>(digest.value()));
}

/// ".NAME." of ".NAME.HOST.PID-N.tmp", the names of temporary files. It leaves room for the rest within the 255 bytes
/// of a name.
std::string temporary_prefix(const fs::path& target) {
  constexpr std::size_t longest = 200;
  return fmt::format(".{}.", target.filename().string().substr(0, longest));
}

struct Maker {
  std::string_view host;
  pid_t process;
};

/// The process that has made a temporary file of this name; none if the name is another.
std::optional<Maker> maker_of(std::string_view name, std::string_view prefix) {
  constexpr std::size_t tag_length = 8;
  constexpr std::string_view ending = ".tmp";
  if (!name.starts_with(prefix) || !name.ends_with(ending)) return std::nullopt;
  name.remove_prefix(prefix.size());
  name.remove_suffix(std::min(name.size(), ending.size()));
  if (name.size() <= tag_length || name[tag_length] != '.') return std::nullopt;
  Maker maker{name.substr(0, tag_length), 0};
  if (maker.host.find_first_not_of("0123456789abcdef") != std::string_view::npos) return std::nullopt;
  int attempt = 0;
  const char* const end = name.data() + name.size();
  const auto process = std::from_chars(name.data() + tag_length + 1, end, maker.process);
  if (process.ec != std::errc() || process.ptr == end || *process.ptr != '-') return std::nullopt;
  const auto number = std::from_chars(process.ptr + 1, end, attempt);
  return number.ec == std::errc() && number.ptr == end ? std::optional(maker) : std::nullopt;
}

/// Processes of other hosts cannot be queried: a file is no longer theirs if it has not been written to for one day.
bool is_left_behind(const fs::directory_entry& entry, const Maker& maker, const std::string& host) {
  if (maker.host == host) return kill(maker.process, 0) != 0 && errno == ESRCH;
  std::error_code error;
  const auto written = entry.last_write_time(error);
  return !error && fs::file_time_type::clock::now() - written > std::chrono::hours(24);
}

void remove_left_behind(const fs::path& target, const std::string& host) {
  const std::string prefix = temporary_prefix(target);
  std::error_code error, ignored;
  for (fs::directory_iterator entry(folder_of(target), error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const std::optional<Maker> maker = maker_of(name, prefix);
    if (!maker || !fs::is_regular_file(entry->symlink_status(ignored))) continue;
    if (is_left_behind(*entry, *maker, host)) fs::remove(entry->path(), ignored);
  }
}

/// Owner, if this user may give files away, and permissions.
void take_over_access(const fs::path& file, const struct stat& older) {
  if (chown(file.c_str(), older.st_uid, older.st_gid) != 0) errno = 0;  // the file stays this user's
  chmod(file.c_str(), older.st_mode & 0777);
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

fs::path written_file(const fs::path& path) {
  constexpr int most_links = 40;  // as Linux follows
  fs::path file = path;
  std::error_code error;
  for (int links = 0; links < most_links; ++links) {
    const fs::path target = fs::read_symlink(file, error);
    if (error) break;  // not a link
    file = folder_of(file) / target;
  }
  const fs::path folder = fs::canonical(folder_of(file), error);
  return error ? fs::absolute(file).lexically_normal() : folder / file.filename();
}

bool is_temporary_of(const fs::path& file, const fs::path& target) {
  if (file.extension() != ".tmp") return false;
  const fs::path a = written_file(file), b = written_file(target);
  return a.parent_path() == b.parent_path() && maker_of(a.filename().string(), temporary_prefix(b)).has_value();
}

void check_target(const fs::path& target) {
  if (target.filename().empty()) throw_unwritable(target, "the name of a file is missing");
  std::error_code error;
  const fs::file_status folder = fs::status(folder_of(target), error);
  if (!fs::exists(folder)) throw_unwritable(target, fmt::format("there is no folder {}", folder_of(target).string()));
  if (!fs::is_directory(folder))
    throw_unwritable(target, fmt::format("{} is not a folder", folder_of(target).string()));

  const fs::file_status status = fs::status(target, error);
  // A name that leads nowhere, as that of links in a circle, is not free.
  if (status.type() == fs::file_type::none) throw_unwritable(target, error.message());
  if (fs::is_directory(status)) throw_unwritable(target, "it is a directory, name a file");
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw_unwritable(target, "it is a device, pipe or socket, name a file");
  // rename() would replace a write-protected file without asking.
  if (fs::exists(status) && access(target.c_str(), W_OK) != 0) throw_unwritable(target, system_message(errno));
  if (access(folder_of(written_file(target)).c_str(), W_OK | X_OK) != 0)
    throw_unwritable(target, system_message(errno));
}

AtomicFile::AtomicFile(const fs::path& target) : name_(target) {
  check_target(target);
  target_ = written_file(target);
  const std::string host = host_tag();
  remove_left_behind(target_, host);

  // Users who may not read the older file may not read the new one either.
  struct stat older {};
  const mode_t mode = stat(target_.c_str(), &older) == 0 ? (older.st_mode & 0666) | S_IRUSR | S_IWUSR : 0666;
  for (int attempt = 0;; ++attempt) {
    temporary_ = folder_of(target_) / fmt::format("{}{}.{}-{}.tmp", temporary_prefix(target_), host, getpid(), attempt);
    const int descriptor = open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, mode);
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
  if (const int error = sync_to_disk(temporary_, O_RDWR)) throw_unwritable(name_, system_message(error));
  struct stat older {};
  if (stat(target_.c_str(), &older) == 0) take_over_access(temporary_, older);
  if (rename(temporary_.c_str(), target_.c_str()) != 0) throw_unwritable(name_, system_message(errno));
  committed_ = true;
  // Some network file systems can't sync a folder (EINVAL). A folder that may be written need not be readable (EACCES).
  const int error = sync_to_disk(folder_of(target_), O_RDONLY | O_DIRECTORY);
  if (error != 0 && error != EINVAL && error != EACCES) throw_unwritable(name_, system_message(error));
}

void write_file_atomically(const fs::path& file, std::span<const std::uint8_t> bytes) {
  AtomicFile target(file);
  if (const int error = write_bytes(target.temporary(), bytes)) throw_unwritable(file, system_message(error));
  target.commit();
}

void write_file_atomically(const fs::path& file, std::string_view text) {
  write_file_atomically(file, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

}  // namespace cloudbow
