// Reading a file of a stranger: first in a child process, whose death is an answer and not the end of the program.
#pragma once

#include <filesystem>
#include <functional>

namespace cloudbow {

/// Runs `parse` in a child process with limits on CPU time and memory that grow with the file. The child has one
/// thread: `parse` must not wait for others.
/// @throws InputError with the message of what `parse` throws there (OpenVDB leaks what it has half read: here it never
/// begins), and where the child crashes, runs out of memory or out of time.
void rehearse(const std::filesystem::path& path, const std::function<void()>& parse);

}  // namespace cloudbow
