// The cloud of a scene, read and given its optics.
#pragma once

#include <optional>
#include <vector>

#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/medium/cloud_files.hpp"
#include "cloudbow/medium/emission.hpp"

namespace cloudbow {

struct OpenedCloud {
  VdbCloud field;
  CloudOptics optics;
  std::vector<PhaseFunction>
      varying_phase;  ///< of droplets that vary from voxel to voxel: optics.phase_function counts here
  std::optional<PhaseClassReport> phase_classes;
  CloudFigures figures;
  VoxelTemperatures temperature_k;  ///< empty: that of the air
};

/// @throws InputError if the files cannot be read, contradict the scene, or lack data.
OpenedCloud open_cloud(const Scene& scene, CloudFiles& files);

}  // namespace cloudbow
