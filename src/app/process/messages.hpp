// Messages of the program on stderr. A log that cannot be written (a full disk) must not lose a result, so it is
// written unchecked; fmt::print would throw.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace cloudbow {

template <class... Args>
void tell(fmt::format_string<Args...> text, Args&&... args) {
  std::fputs(fmt::format(text, std::forward<Args>(args)...).c_str(), stderr);
}

}  // namespace cloudbow
