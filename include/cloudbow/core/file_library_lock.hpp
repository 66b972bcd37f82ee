// One thread at a time uses the libraries of file formats.
#pragma once

namespace cloudbow {

/// While an object exists, no other thread has one. Held around calls of HDF5, netCDF and OpenVDB. netCDF is not made
/// for several threads. A child process that is forked while another thread is within a library would never get that
/// library's lock. A thread may have several objects.
class FileLibraryLock {
 public:
  FileLibraryLock();
  ~FileLibraryLock();
  FileLibraryLock(const FileLibraryLock&) = delete;
  FileLibraryLock& operator=(const FileLibraryLock&) = delete;

  /// For a host that already has a lock around these libraries, such as Python: its functions are called in place of a
  /// mutex. They must be recursive. Both null: the mutex. Call it while no object exists.
  static void use(void (*lock)(), void (*unlock)());
};

}  // namespace cloudbow
