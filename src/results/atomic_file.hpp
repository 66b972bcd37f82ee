// A file that appears under its name only when it is complete.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace cloudbow {

/// Ends as "FILE: can't be written (REASON)".
[[noreturn]] void throw_unwritable(const std::filesystem::path& file, const std::string& reason);

/// An empty temporary file beside the target from construction on; removed by the destructor unless committed.
class AtomicFile {
 public:
  /// @throws InputError where the folder is missing or may not be written, or the target is anything but a regular
  /// file.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// To be opened, filled and closed by the writer, who checks each of these.
  const std::filesystem::path& temporary() const { return temporary_; }

  /// Brings the temporary file to the disk and gives it the target's name. @throws InputError where the system refuses.
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  bool committed_ = false;
};

/// All of a file at once. @throws InputError as above.
void write_file_atomically(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

}  // namespace cloudbow
