// HDF5 files as inputs: identifiers that close themselves, return codes that can't be overlooked, and a check that a
// file leads nowhere else. Identifiers are HDF5's hid_t, closers return its herr_t.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <utility>

namespace cloudbow::hdf5 {

/// Error text of HDF5: the system's message if there is one ("No space left on device"), else the innermost entry of
/// its error stack.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws Error with HDF5's own message, or `what`; std::bad_alloc if HDF5 had no memory.
[[noreturn]] void throw_error(const char* what);

/// Throws Error with HDF5's own message if a call returned a negative code; `what` names the call's purpose. Returns
/// the code.
template <typename Code>
Code check(Code code, const char* what) {
  if (code < 0) throw_error(what);
  return code;
}

class Handle {
 public:
  using Closer = int (*)(std::int64_t);
  /// Takes what an HDF5 call returned. @throws Error if the call failed.
  Handle(std::int64_t id, Closer closer, const char* what) : id_(check(id, what)), closer_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, none)), closer_(other.closer_) {}
  Handle& operator=(Handle&&) = delete;
  /// Only after a failure, or for what isn't written to a file: elsewhere close() reports what went wrong.
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }

  operator std::int64_t() const { return id_; }
  void close() { check(closer_(std::exchange(id_, none)), "close"); }

 private:
  static constexpr std::int64_t none = -1;
  std::int64_t id_;
  Closer closer_;
};

/// Must come before any other HDF5 call. Otherwise HDF5's own clean-up at exit would crash the program after a failed
/// close. Its error stack would also be printed to stderr.
void start_library();

/// An input, for reading. HDF5 does not read anything outside the file to which it refers: links to other files, links
/// and filters of plug-ins, virtual datasets and external storage are refused before they are followed.
/// @throws InputError naming the file if it is no regular file, is locked or has such a reference; Error if damaged.
Handle open_file(const std::filesystem::path& path);

/// The same check before another library opens the file; anything but HDF5 passes.
/// @throws InputError as above; also if damaged.
void check_file(const std::filesystem::path& path);

}  // namespace cloudbow::hdf5
