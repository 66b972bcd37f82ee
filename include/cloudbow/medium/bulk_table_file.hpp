// Tables of bulk optics from files.
#pragma once

#include <filesystem>

#include "cloudbow/optics/bulk_optics.hpp"

namespace cloudbow {

/// Reads a table in the layout of ecRad's scattering files (netCDF): docs/formats.md, "Tables of bulk optics".
/// @throws InputError that names the file and the variable, what was found, what is allowed and what to do.
BulkTable read_bulk_table(const std::filesystem::path& file);

}  // namespace cloudbow
