// Fields of a result file as OpenVDB grids, for viewers and renderers.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/sphere/direction.hpp"

namespace cloudbow {

/// At least one field must be requested.
struct FieldExportOptions {
  std::filesystem::path result_file;
  std::filesystem::path vdb_file;
  /// Grid "radiance": light that travels so, interpolated between the control points (theory.md, Eq. 9). Any length.
  std::optional<Direction> travel;
  bool all_directions = false;  ///< grids "radiance_000" ...: one for each control point
  bool actinic = false;         ///< grid "actinic_flux"
  bool absorption = false;      ///< grid "absorbed_power", in scenes that emit "net_absorbed_power"
  bool heating_rate = false;    ///< grid "heating_rate"
  /// Limit of the radiances that are in memory at once with all_directions; at least one direction is.
  std::size_t batch_bytes = std::size_t{256} << 20;
};

/// Summary of the written file, for lines on the terminal.
struct FieldExportReport {
  std::vector<std::string> grids;
  std::array<int, 3> voxels{};
  std::array<double, 3> voxel_size_m{};
  std::array<double, 3> min_m{};
  std::array<double, 3> max_m{};
  bool whole_domain = true;  ///< false: the levels of the result are uneven, and the cloud's box alone was exported
};

/// Writes each requested field as a float grid in the result's axes (metres, z up). Its voxels are those of the cloud.
/// Cells without a value (no matter in them) are inactive. Levels of one height are exported whole. If layers make them
/// uneven, only the planes of voxels from the cloud's lowest to its highest are exported. A voxel that a layer's edge
/// cuts gets the mean of its parts by height.
/// @throws InputError if the file is missing, no result, or lacks a field (the message explains how to get it); if
/// `travel` has no length; if the levels are uneven and there is no cloud; if the VDB file cannot be written. No file
/// is left then.
FieldExportReport export_fields(const FieldExportOptions& options);

}  // namespace cloudbow
