// The program's version and those of the libraries it was built with.
#pragma once

#include <string>

namespace cloudbow {

std::string version();

/// "cloudbow 0.1.0", then one line a library.
std::string version_text();

}  // namespace cloudbow
