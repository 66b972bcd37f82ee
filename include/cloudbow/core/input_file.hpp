// Inputs are regular files. A pipe, a device or a directory is refused before anything waits for it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace cloudbow {

/// Why an input cannot be read, as "no such file", "a directory" or "a named pipe"; empty if it can be read. Returns at
/// once for every kind of file.
std::string unreadable_reason(const std::filesystem::path& file);

/// @param allowed as the message names it, as "an OpenVDB file"
/// @param most_bytes 0: any size
/// @throws InputError "FILE: can't be read (found REASON, allowed ALLOWED)"
void check_input(const std::filesystem::path& file, std::string_view allowed, std::uintmax_t most_bytes = 0);

/// The input, opened after these checks. @throws InputError as above.
std::ifstream open_input(const std::filesystem::path& file, std::string_view allowed, std::uintmax_t most_bytes = 0);

}  // namespace cloudbow
