// Text out of files, made fit for a terminal.
#pragma once

#include <string>
#include <string_view>

namespace cloudbow {

/// Control characters (C0, DEL, C1 in UTF-8) and bytes that are no UTF-8 become \xNN; the rest is unchanged. Otherwise
/// a name in a file could move the cursor, hide text or set the title of the window.
std::string printable(std::string_view text);

}  // namespace cloudbow
