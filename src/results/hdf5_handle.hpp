// HDF5 identifiers that close themselves, and return codes that can't be overlooked.
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

namespace cloudbow::hdf5 {

/// What HDF5 said: the system's message where there is one ("No space left on device"), else the innermost entry of its
/// error stack.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

[[noreturn]] void throw_error(const char* what);

/// Throws Error with HDF5's own message where a call returned a negative code; `what` names the call's purpose. Returns
/// the code.
template <typename Code>
Code check(Code code, const char* what) {
  if (code < 0) throw_error(what);
  return code;
}

class Handle {
 public:
  using Closer = herr_t (*)(hid_t);
  /// Takes what an HDF5 call returned. @throws Error where the call failed.
  Handle(hid_t id, Closer closer, const char* what) : id_(check(id, what)), closer_(closer) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), closer_(other.closer_) {}
  Handle& operator=(Handle&&) = delete;
  /// Only after a failure, or for what isn't written to a file: elsewhere close() reports what went wrong.
  ~Handle() {
    if (id_ >= 0) closer_(id_);
  }

  operator hid_t() const { return id_; }
  void close() { check(closer_(std::exchange(id_, H5I_INVALID_HID)), "close"); }

 private:
  hid_t id_;
  Closer closer_;
};

/// Must come before any other HDF5 call: after a failed close HDF5's own clean-up at exit would crash the program, and
/// its error stack would be printed to stderr.
void start_library();

Handle create_file(const std::filesystem::path& path);
Handle open_file(const std::filesystem::path& path);
Handle open_dataset(hid_t location, const char* name);
Handle property_list(hid_t type);

}  // namespace cloudbow::hdf5
