// The line of a file's `history` attribute.
#pragma once

#include <string>

namespace cloudbow {

/// Time (UTC) and command.
std::string history_line(const std::string& command);

}  // namespace cloudbow
