// From a scene to the input of the solver: opens the cloud, joins it with the layers, applies the level of accuracy.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/app/scene.hpp"
#include "cloudbow/medium/cloud_amounts.hpp"
#include "cloudbow/medium/cloud_files.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Numbers of phase functions of droplet tables and sets: those that the scene's voxels use, and those in the solve.
struct PhaseClassReport {
  int functions = 0;
  int classes = 0;
  double estimated_error = 0;  ///< of the classes, fraction of the incident light
};

/// Summary of a constituent of the clouds, in which the user can notice a wrong unit.
struct CloudFigures {
  std::string name;  ///< as SceneCloud::name
  ColumnFigures optical_depth;
  std::optional<double> optical_depth_um;        ///< its wavelength, if that is not the scene's
  std::optional<ColumnFigures> water_path_g_m2;  ///< if the grid holds liquid water or ice
  double largest_water_content_g_m3 = 0;
  std::optional<std::array<double, 2>> effective_radius_um;  ///< smallest and largest, if the scene names one
  std::optional<std::array<double, 2>> temperature_k;        ///< lowest and highest, if voxels have their own
};

struct AssembledScene {
  Problem problem;
  SolverOptions options;
  bool one_column = false;                        ///< layers alone, or voxels of one column
  std::optional<PhaseClassReport> phase_classes;  ///< if droplets vary from voxel to voxel
  std::vector<CloudFigures> clouds;               ///< of each constituent
  std::vector<float> cloud_optical_depth;  ///< [y][x] of the problem's columns, without layers; empty: not asked for
  std::vector<float> cloud_extinction;     ///< [z][y][x] 1/m, mean of the cell, without layers; empty: not asked for
};

/// @param memory_limit_bytes of the optical grid; checked before it is allocated. @throws InputError if the cloud
/// cannot be read or does not fit the scene: domain off the voxel faces or too small; quantity or effective radius
/// missing; a camera below the ground.
AssembledScene assemble(const Scene& scene, std::uint64_t memory_limit_bytes);

/// The same for one wavelength of several.
/// @param files of the scene's cloud
/// @param levels_m as LevelOptions::levels_m
AssembledScene assemble(const Scene& scene, std::uint64_t memory_limit_bytes, CloudFiles& files,
                        const std::vector<double>& levels_m);

}  // namespace cloudbow
