// Files that another program has locked.
#pragma once

#include <filesystem>

namespace cloudbow {

/// Whether another process holds a lock on the file that forbids reading, as HDF5 takes one while it writes. False if
/// the file cannot be opened.
bool is_locked(const std::filesystem::path& path);

inline constexpr const char* kLockedFile = "the file is locked: another program has it open for writing";

}  // namespace cloudbow
