// Messages of the program on stderr, or to the host that has loaded it. A log that cannot be written (a full disk) must
// not lose a result, so it is written unchecked; fmt::print would throw.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

namespace cloudbow {

void tell_text(const std::string& text);

/// From now on messages are dropped, or no longer: of several processes that do the same, one speaks.
void mute_messages(bool mute);

/// A fraction with two digits: "0.25 %".
std::string percent(double fraction);

template <class... Args>
void tell(fmt::format_string<Args...> text, Args&&... args) {
  tell_text(fmt::format(text, std::forward<Args>(args)...));
}

}  // namespace cloudbow
