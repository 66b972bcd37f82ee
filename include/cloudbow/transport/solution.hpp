// The output of a solve, in plain arrays. Conventions: z up, k and z_edge ascend; light is given by its direction of
// travel.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "cloudbow/transport/options.hpp"
#include "cloudbow/transport/problem.hpp"
#include "cloudbow/transport/report.hpp"

namespace cloudbow {

struct RadianceImage {
  View view;
  std::vector<float> radiance;  ///< [height][width] of the view, else [ny][nx]; y ascending; W m-2 sr-1, mean over the
                                ///< pixel at which the line of sight crosses that plane
};

struct RadianceField {
  std::vector<Direction> direction;                   ///< M control points: directions of travel of light
  std::vector<std::array<std::int32_t, 3>> triangle;  ///< of control points, counter-clockwise seen from outside
  std::vector<std::array<std::int32_t, 3>> voxel;     ///< n active voxels: i, j, k
  std::vector<float> radiance;                        ///< n x M, W m-2 sr-1, voxel mean, diffuse
};

struct Solution {
  BoxGrid box;
  std::optional<Sun> sun;                       ///< that of the problem
  std::vector<int> flux_level;                  ///< indices of z_edge at which the fields below are given, ascending
  std::vector<float> upwelling_flux;            ///< [level][ny][nx] W m-2, diffuse
  std::vector<float> downwelling_diffuse_flux;  ///< as above
  std::vector<float> direct_flux;               ///< as above, true extinction, through a horizontal surface
  /// As above, diffuse light from the cone about the sun through a plane that faces the sun; empty unless requested.
  std::vector<float> circumsolar_flux;
  std::vector<double> profile_upwelling_flux;  ///< [nz+1] domain means
  std::vector<double> profile_downwelling_diffuse_flux;
  std::vector<double> profile_direct_flux;
  bool emits = false;  ///< whether the problem has thermal emission
  /// [nz][ny][nx] W m-3, less what the voxel emits; empty unless requested
  std::vector<float> absorbed_power;
  std::vector<float> actinic_flux;    ///< [nz][ny][nx] W m-2, empty unless requested; NaN in empty cells, for which no
                                      ///< light was computed
  std::vector<RadianceImage> images;  ///< one for each of SolverOptions::views
  std::vector<CameraImage> camera_images;  ///< one for each of SolverOptions::cameras
  std::optional<RadianceField> radiance_field;
  EnergyLedger ledger;
  SolverReport report;
};

}  // namespace cloudbow
