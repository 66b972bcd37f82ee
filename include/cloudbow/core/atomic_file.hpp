// A file that appears under its name only when it is complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace cloudbow {

/// Ends as "FILE: can't be written (REASON)".
[[noreturn]] void throw_unwritable(const std::filesystem::path& file, const std::string& reason);

/// The file that writing to a path makes or replaces: links are followed, also to a file that is not there yet.
std::filesystem::path written_file(const std::filesystem::path& path);

/// Whether a name is that of a temporary file that AtomicFile makes for this target.
bool is_temporary_of(const std::filesystem::path& file, const std::filesystem::path& target);

/// Reports whether a file could be written, without making one: for dry runs.
/// @throws InputError naming the file: there is no such folder, it may not be written, or links lead nowhere. Also if
/// the target is a directory or another kind of special file.
void check_target(const std::filesystem::path& target);

/// An empty temporary file beside the target from construction on; removed by the destructor unless committed. Those
/// that killed processes have left behind for the same target are removed first.
class AtomicFile {
 public:
  /// @throws InputError if the folder is missing or not writable, or the target is not a regular file.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// To be opened, filled and closed by the writer, who checks each of these.
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Brings the temporary file to the disk and gives it the target's name; permissions of an older target are kept.
  /// @throws InputError if the system refuses.
  void commit();

 private:
  std::filesystem::path name_;    ///< as the caller gave it
  std::filesystem::path target_;  ///< links followed
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// All of a file at once. @throws InputError as above.
void write_file_atomically(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);
void write_file_atomically(const std::filesystem::path& file, std::string_view text);

}  // namespace cloudbow
