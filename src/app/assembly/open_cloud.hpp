// A constituent of a scene's clouds, read and given its optics.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/medium/cloud_files.hpp"
#include "cloudbow/medium/emission.hpp"

namespace cloudbow {

/// Vertical optical depths of the columns of a field, before others share its box.
struct ColumnDepths {
  std::array<double, 2> min_m{};
  std::array<int, 2> columns{};
  std::vector<double> value{};  ///< [j][i]; empty: not asked for
};

struct OpenedCloud {
  VdbCloud field;
  CloudOptics optics;
  std::vector<PhaseFunction> varying_phase;  ///< of droplets that vary from voxel to voxel
  std::optional<PhaseClassReport> phase_classes;
  CloudFigures figures;
  /// If the scene asks for it. With a gas model and bulk optics it is that at SceneCloud::visible_um.
  ColumnDepths column_optical_depth;
  std::vector<float> extinction;    ///< [voxel of field] 1/m, at the wavelength of the depths; empty: not asked for
  VoxelTemperatures temperature_k;  ///< empty: that of the air
};

/// Corners of the domain this close to a voxel face are taken to lie on it, in voxels.
inline constexpr double face_tolerance = 1e-3;

/// Whether a coordinate [m] lies on a voxel face, in the cloud's box or beyond.
bool lies_on_face(const CloudField& field, int axis, double value_m);

/// The coordinate of the face that it lies on; itself if it lies on none.
double onto_face(const CloudField& field, int axis, double value_m);

/// @param cloud of the scene.
/// @param first_varying index that the problem gives to the first of varying_phase.
/// @throws InputError if the files cannot be read, contradict the scene, or lack data.
OpenedCloud open_cloud(const Scene& scene, const SceneCloud& cloud, std::size_t first_varying, CloudFiles& files);

}  // namespace cloudbow
