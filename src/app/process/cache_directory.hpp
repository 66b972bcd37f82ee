// The folder for data that are computed once and kept for later runs.
#pragma once

#include <filesystem>

namespace cloudbow {

/// `cloudbow` in XDG_CACHE_HOME, else in ~/.cache; created if it is missing. Empty: there is no such folder.
std::filesystem::path cache_directory();

}  // namespace cloudbow
