// Remedies for a line that is not TOML.
#pragma once

#include <string>
#include <string_view>

namespace cloudbow {

/// The remedy for common mistakes, as "text stands in quotes: file = \"cloud.vdb\""; empty if there is none.
/// @param problem as toml++ says it
/// @param line with the first fault that the parser met
/// @param column from 1, of that fault
std::string toml_hint(std::string_view problem, std::string_view line, std::size_t column);

}  // namespace cloudbow
