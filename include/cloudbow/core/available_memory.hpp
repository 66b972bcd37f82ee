// Memory that the process may use.
#pragma once

#include <cstdint>
#include <filesystem>

namespace cloudbow {

/// Bytes that the process may hold in all, with what it holds now. This is the least of the machine's memory, the
/// memory that the system reports as available, and all limits. Limits are those of its control groups (version 1 and
/// 2, with all groups above), `ulimit -v` and `ulimit -d`.
/// @param root folder that replaces / for the files of the kernel.
std::uint64_t available_memory_bytes(const std::filesystem::path& root = "/");

}  // namespace cloudbow
