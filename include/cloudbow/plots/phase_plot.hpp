// The plots of `cloudbow phase`.
#pragma once

#include <filesystem>

#include "cloudbow/results/phase_report.hpp"

namespace cloudbow {

/// PNG: for each function one plot against the scattering angle and one around the direction of travel, along a great
/// circle. @throws InputError if the file can't be written.
void write_phase_plot(const std::filesystem::path& file, const PhaseReport& report);

}  // namespace cloudbow
