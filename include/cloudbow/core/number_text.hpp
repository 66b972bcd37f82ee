// Numbers as programs write them into text: the one parser of all text inputs.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace cloudbow {

/// Words between blanks, tabs and commas.
std::vector<std::string_view> split_words(std::string_view line);

/// The number that the whole word is; none if it is something else. "nan" and "inf" are numbers here, so are a leading
/// "+" and Fortran's exponents of double precision: "1.0D-1".
std::optional<double> number_in(std::string_view word);

}  // namespace cloudbow
