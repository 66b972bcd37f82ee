// Where what is worked out once is kept for later runs.
#pragma once

#include <filesystem>

namespace cloudbow {

/// `cloudbow` in XDG_CACHE_HOME, else in ~/.cache; made where it is missing. Empty: there is no such place.
std::filesystem::path cache_directory();

}  // namespace cloudbow
