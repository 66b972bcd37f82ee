// Messages about unknown words.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cloudbow {

/// "a, b, c; did you mean b?": the candidates, and the one that is so near that the word may be a slip of it.
std::string candidates_for(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace cloudbow
