#include "cloudbow/core/file_library_lock.hpp"

#include <mutex>

namespace cloudbow {
namespace {

std::recursive_mutex mutex;
void (*lock_of_host)() = nullptr;
void (*unlock_of_host)() = nullptr;

}  // namespace

FileLibraryLock::FileLibraryLock() {
  if (lock_of_host != nullptr) {
    lock_of_host();
  } else {
    mutex.lock();
  }
}

FileLibraryLock::~FileLibraryLock() {
  if (unlock_of_host != nullptr) {
    unlock_of_host();
  } else {
    mutex.unlock();
  }
}

void FileLibraryLock::use(void (*lock)(), void (*unlock)()) {
  lock_of_host = lock;
  unlock_of_host = unlock;
}

}  // namespace cloudbow
