// All constituents of a scene's clouds, on their common voxels.
#pragma once

#include <optional>
#include <vector>

#include "app/assembly/open_cloud.hpp"
#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

struct OpenedClouds {
  std::vector<OpenedCloud> constituents;  ///< in the order of Scene::clouds, their fields in one box
  CloudField joined;                      ///< voxels of several constituents; unused if there is one
  /// [voxel of field()] empty: all have that of the air.
  VoxelTemperatures temperature_k;
  std::optional<PhaseClassReport> phase_classes;  ///< of all constituents that have classes

  /// The voxels that any constituent has; null without clouds.
  const CloudField* field() const;
  /// Refers to the members of this.
  CloudMatter matter() const;
};

/// @throws InputError as open_cloud(), and for constituents with other voxels or other temperatures than another.
OpenedClouds open_clouds(const Scene& scene, CloudFiles& files);

}  // namespace cloudbow
