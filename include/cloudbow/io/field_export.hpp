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

/// At least one field must be asked for.
struct FieldExportOptions {
  std::filesystem::path result_file;
  std::filesystem::path vdb_file;
  /// Grid "radiance": light that travels so, interpolated between the control points (theory.md, Eq. 9). Any length.
  std::optional<Direction> travel;
  bool all_directions = false;  ///< grids "radiance_000" ...: one for each control point
  bool actinic = false;         ///< grid "actinic_flux"
  bool absorption = false;      ///< grid "absorbed_power"
  /// Of the radiances that are in memory at once with all_directions; at least one direction is.
  std::size_t batch_bytes = std::size_t{256} << 20;
};

/// What was written, for lines on the terminal.
struct FieldExportReport {
  std::vector<std::string> grids;
  std::array<int, 3> voxels{};
  std::array<double, 3> voxel_size_m{};
  std::array<double, 3> min_m{};
  std::array<double, 3> max_m{};
  bool whole_domain = true;  ///< false: the levels of the result are uneven, and the cloud's box alone was exported
};

/// Writes the fields asked for, each a float grid in the result's axes (metres, z up) with the voxels of the cloud;
/// cells without a value (no matter in them) are inactive. Levels of one height are exported whole. Where layers make
/// them uneven the planes of voxels from the cloud's lowest to its highest are: a voxel that a layer's edge cuts gets
/// the mean of its parts by height.
/// @throws InputError where the file is missing, no result, or lacks a field (the message says how to get it);
/// `travel` has no length; the levels are uneven and there is no cloud; the VDB file cannot be written.
/// No file is left then.
FieldExportReport export_fields(const FieldExportOptions& options);

}  // namespace cloudbow
