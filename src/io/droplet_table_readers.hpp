// Readers of single forms; their InputErrors do not name the file.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "cloudbow/optics/droplet_table.hpp"

namespace cloudbow {

/// @param relative_humidity_percent of a table by humidity, which becomes one row; no radius then chooses.
DropletTable read_libradtran_table(const std::filesystem::path& file, std::optional<double> wavelength_um,
                                   std::optional<double> relative_humidity_percent);
/// @throws InputError if a humidity is given to a table by radius.
void refuse_humidity(std::optional<double> relative_humidity_percent);
DropletTable read_shdom_table(const std::filesystem::path& file);
/// By the first bytes of the file.
bool is_shdom_table(std::string_view head);

/// Index of the requested wavelength; of the only one if none is requested. @throws InputError if it is not in the
/// file.
std::size_t choose_wavelength(std::span<const double> there_um, std::optional<double> wanted_um);

}  // namespace cloudbow
