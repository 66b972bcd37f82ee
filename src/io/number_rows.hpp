// Text files of numbers, row by row.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cloudbow {

/// Limit for a file of numbers in text; larger ones are refused.
inline constexpr std::uintmax_t most_text_bytes = 256u << 20;

/// The numbers of a line up to a comment, which begins with "#" or "!". Blanks and commas separate them; Fortran's
/// exponents (1.5D+01) are read. Empty for a line without any, nothing if a word is no number.
std::optional<std::vector<double>> numbers_in(std::string_view line);

}  // namespace cloudbow
