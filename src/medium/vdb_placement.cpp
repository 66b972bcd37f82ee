#include "vdb_placement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cloudbow {

namespace {

/// The largest coefficient by which an index moves the voxel along an axis other than its own. It is relative to the
/// largest voxel size: over a thousand voxels, the displacement by a slope of 1e-6 is face_tolerance.
constexpr double largest_slope = 1e-6;

using Matrix = std::array<std::array<double, 4>, 4>;

const Matrix& affine_matrix(const VdbGridHeader& grid, const Place& where) {
  if (!grid.is_linear) {
    where.fail(
        "the transform is not linear ({} found, boxes along the axes are allowed); resample the grid to boxes "
        "along the axes",
        grid.map_type);
  }
  if (grid.is_singular) {
    where.fail("the transform is singular (voxel sizes other than 0 are allowed); write the grid with its voxel size");
  }
  return grid.matrix;
}

/// For each axis of the world the index that runs along it: a permutation. Rows of the matrix belong to indices,
/// columns to the world.
std::array<int, 3> index_axes(const Matrix& matrix, const Place& where) {
  std::array<int, 3> index_of{-1, -1, -1};
  double largest = 0;
  for (int row = 0; row < 3; ++row) {
    int own = 0;
    for (int column = 1; column < 3; ++column) {
      if (std::abs(matrix[row][column]) > std::abs(matrix[row][own])) own = column;
    }
    index_of[own] = row;
    largest = std::max(largest, std::abs(matrix[row][own]));
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (index_of[column] == row) continue;
      if (index_of[column] < 0 || !(std::abs(matrix[row][column]) <= largest_slope * largest)) {
        where.fail(
            "the transform rotates or shears (rows of its matrix: {:.6g} {:.6g} {:.6g}; {:.6g} {:.6g} {:.6g}; {:.6g} "
            "{:.6g} {:.6g}; one number per row and column is allowed, which exchanges and mirrors axes); resample the "
            "grid to boxes along the axes",
            matrix[0][0], matrix[0][1], matrix[0][2], matrix[1][0], matrix[1][1], matrix[1][2], matrix[2][0],
            matrix[2][1], matrix[2][2]);
      }
    }
  }
  return index_of;
}

const std::array<double, 3>* vector_metadata(const std::optional<VdbVector>& item, const char* name,
                                             const Place& where) {
  if (!item) return nullptr;
  if (!item->wrong_type.empty()) {
    where.fail("metadata {} has the wrong type ({} found, vec3d, vec3s and vec3i are allowed)", name, item->wrong_type);
  }
  const auto& value = item->value;
  if (!std::all_of(value.begin(), value.end(), [](double number) { return std::isfinite(number); })) {
    where.fail("metadata {} is not finite ({}, {}, {})", name, value[0], value[1], value[2]);
  }
  return &value;
}

}  // namespace

Placement place(const VdbGridHeader& grid, const VdbReadOptions& options, const Place& where) {
  const Matrix& matrix = affine_matrix(grid, where);
  const std::array<int, 3> index_of = index_axes(matrix, where);
  Placement result{.axis = {},
                   .sign = {},
                   .size = {},
                   .centre = {},
                   .world_axis = {0, 1, 2},
                   .world_sign = {1, 1, 1},
                   .stretch = {1, 1, 1}};
  if (options.up_axis == "y") {
    result.world_axis = {0, 2, 1};
    result.world_sign = {1, -1, 1};
  } else if (options.up_axis == "x") {
    result.world_axis = {1, 2, 0};
  }
  for (int a = 0; a < 3; ++a) {
    const int world = result.world_axis[a];
    const double step = matrix[index_of[world]][world];
    if (!std::isnormal(step) || !std::isfinite(matrix[3][world])) {
      where.fail(
          "the transform has no usable voxel size (found {:.6g} m along {} from {:.6g} m, allowed a size other "
          "than 0 and a finite place); write the grid with its voxel size",
          step, "xyz"[world], matrix[3][world]);
    }
    result.axis[a] = index_of[world];
    result.sign[a] = result.world_sign[a] * (step > 0 ? 1 : -1);
    result.size[a] = std::abs(step);
    if (options.voxel_size_m) {
      result.stretch[a] = (*options.voxel_size_m)[a] / result.size[a];
      result.size[a] = (*options.voxel_size_m)[a];
    }
    result.centre[a] = result.world_sign[a] * matrix[3][world] * result.stretch[a];
  }
  return result;
}

std::optional<VdbDomain> metadata_domain(const VdbGridHeader& grid, const Placement& placement, const Place& where) {
  const auto* const low = vector_metadata(grid.domain_min_m, "domain_min_m", where);
  const auto* const high = vector_metadata(grid.domain_max_m, "domain_max_m", where);
  if ((low == nullptr) != (high == nullptr)) {
    where.fail("metadata {} is missing ({} is there; both or none are allowed)",
               low != nullptr ? "domain_max_m" : "domain_min_m", low != nullptr ? "domain_min_m" : "domain_max_m");
  }
  if (low == nullptr) return std::nullopt;
  VdbDomain domain{};
  for (int a = 0; a < 3; ++a) {
    const int axis = placement.world_axis[a];
    const auto [first, last] =
        placement.world_sign[a] > 0 ? std::pair((*low)[axis], (*high)[axis]) : std::pair(-(*high)[axis], -(*low)[axis]);
    domain.min_m[a] = first * placement.stretch[a];
    domain.max_m[a] = last * placement.stretch[a];
  }
  return domain;
}

std::int64_t nearest_face(const Placement& placement, int a, double position, const char* whose, const Place& where) {
  const double faces = placement.faces(a, position);
  const double nearest = std::nearbyint(faces);
  if (!(std::abs(faces - nearest) <= face_tolerance)) {
    where.fail("the domain of the {} does not end on voxel faces ({} = {:.10g} m found, {:.10g} m is the nearest face)",
               whose, "xyz"[a], position, placement.lower_face(a, 0) + nearest * placement.size[a]);
  }
  if (std::abs(nearest) > std::numeric_limits<std::int32_t>::max()) {
    where.fail("the domain of the {} is too large ({} = {:.10g} m found)", whose, "xyz"[a], position);
  }
  return static_cast<std::int64_t>(nearest);
}

}  // namespace cloudbow
