// Depth of nesting of a TOML text, found before a recursive parser reads it.
#pragma once

#include <optional>
#include <string_view>

namespace cloudbow {

/// Levels of dotted keys, headers, lists and inline tables, all counted together. No scene needs more than five.
inline constexpr int max_toml_depth = 32;

/// The first line (from 1) with more than max_toml_depth levels. Text that is not TOML is counted up to its first
/// fault, at which a parser of TOML's grammar stops.
std::optional<int> first_line_too_deep(std::string_view text);

}  // namespace cloudbow
