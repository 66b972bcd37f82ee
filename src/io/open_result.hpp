// Opening the result of one run.
#pragma once

#include <filesystem>

#include "io/hdf5_handle.hpp"

namespace cloudbow {

/// Opens the result of one run.
/// @throws InputError if the file is missing or is that of `cloudbow sweep`; hdf5::Error if it is damaged.
hdf5::Handle open_result(const std::filesystem::path& path);

}  // namespace cloudbow
