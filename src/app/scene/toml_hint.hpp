// What to do about a line that is not TOML.
#pragma once

#include <string>
#include <string_view>

namespace cloudbow {

/// The way out of the usual mistakes, as "text stands in quotes: file = \"cloud.vdb\""; empty where nothing is known.
/// @param problem as toml++ says it
/// @param line of the file, in which the parser met its first fault
/// @param column from 1, of that fault
std::string toml_hint(std::string_view problem, std::string_view line, std::size_t column);

}  // namespace cloudbow
