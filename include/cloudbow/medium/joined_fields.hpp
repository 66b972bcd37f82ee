// Fields on the same voxels: constituents of clouds, such as liquid and ice, and grids that are added up.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// A sentence about fields whose voxels do not coincide: their sizes differ, or their faces are shifted by more than
/// 1e-3 of a voxel. None if they coincide. Their boxes may differ.
std::optional<std::string> difference_of_voxels(const CloudField& field, const CloudField& other);

/// Gives fields whose voxels coincide one box, which contains those of all. Values and their order stay.
/// @throws InputError if the rows of this box do not fit into memory.
void share_box(std::span<CloudField* const> fields);

/// The voxels that any of the fields has; values that meet in one are added.
/// @param fields in one box; at least one. Of the first are cell sizes and quantity.
CloudField sum_of(std::span<const CloudField* const> fields);

/// [voxel of `field`] index of the same voxel in `all`, which has them all, in the same box.
std::vector<std::size_t> places_in(const CloudField& all, const CloudField& field);

}  // namespace cloudbow
