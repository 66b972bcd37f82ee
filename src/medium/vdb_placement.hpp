// Positions of the voxels of a VDB grid in a scene: the grid's transform, the axis that points up, the grid's own
// domain.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "vdb_grid.hpp"

namespace cloudbow {

/// Of a voxel: far below what matters, far above the rounding of 32-bit metadata.
inline constexpr double face_tolerance = 1e-3;

/// A grid of a file, as messages name it.
struct Place {
  const std::filesystem::path& path;
  const std::string& grid;

  template <class... Args>
  std::string text(fmt::format_string<Args...> text, Args&&... args) const {
    return fmt::format("{}: grid \"{}\": {}", path.string(), grid, fmt::format(text, std::forward<Args>(args)...));
  }
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> problem, Args&&... args) const {
    throw InputError(text(problem, std::forward<Args>(args)...));
  }
};

/// Maps voxel indices of the file to cells of the scene. Along axis a of the scene, n = sign[a] * index[axis[a]] is the
/// index of a voxel. Its centre is centre[a] + n * size[a].
struct Placement {
  std::array<int, 3> axis;  ///< of the indices
  std::array<int, 3> sign;
  std::array<double, 3> size;
  std::array<double, 3> centre;
  std::array<int, 3> world_axis;  ///< of the file's world coordinates
  std::array<int, 3> world_sign;
  std::array<double, 3> stretch;  ///< scene metres per metre of the file

  std::array<std::int64_t, 3> cell(const VdbIndex& index) const {
    return {std::int64_t{sign[0]} * index[axis[0]], std::int64_t{sign[1]} * index[axis[1]],
            std::int64_t{sign[2]} * index[axis[2]]};
  }
  VdbIndex index(const std::array<std::int64_t, 3>& cell) const {
    VdbIndex result{};
    for (int a = 0; a < 3; ++a) result[axis[a]] = static_cast<std::int32_t>(sign[a] * cell[a]);
    return result;
  }
  double lower_face(int a, std::int64_t n) const { return centre[a] + (static_cast<double>(n) - 0.5) * size[a]; }
  /// Distance of a position along axis a from the lower face of voxel 0, in voxels.
  double faces(int a, double position) const { return (position - lower_face(a, 0)) / size[a]; }
};

/// @throws InputError unless the transform takes boxes along the axes to boxes along the axes.
Placement place(const VdbGridHeader& grid, const VdbReadOptions& options, const Place& where);

/// The domain of the grid's metadata in the scene's axes. @throws InputError if it is incomplete or not finite.
std::optional<VdbDomain> metadata_domain(const VdbGridHeader& grid, const Placement& placement, const Place& where);

/// The face on which a corner of the domain lies. @param whose domain it is, for the message
std::int64_t nearest_face(const Placement& placement, int a, double position, const char* whose, const Place& where);

}  // namespace cloudbow
