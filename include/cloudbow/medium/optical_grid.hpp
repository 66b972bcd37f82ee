// Absorption and scattering coefficients of the active cells of a box with uniform columns and any levels.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// Planes of voxels, one above the other; the faces between them are levels of the box.
struct VoxelPlanes {
  int count = 0;
  double bottom_m = 0;
  double height_m = 0;  ///< of each
};

/// nx x ny columns of dx x dy metres, nz levels between ascending z_edge_m. Cell (i, j, k) has index (k*ny + j)*nx + i;
/// k = 0 at the bottom.
struct BoxGrid {
  int nx = 1;
  int ny = 1;
  double dx_m = 1;
  double dy_m = 1;
  double x_min_m = 0;
  double y_min_m = 0;
  std::vector<double> z_edge_m;
  bool periodic = true;  ///< horizontally; false: open sides
  VoxelPlanes cloud;     ///< from the cloud's lowest voxel to its highest; none without a cloud
  /// [nz] nonzero: nothing varies horizontally in the level, so all its columns are one to a ray; empty: none.
  std::vector<std::uint8_t> uniform = {};

  int nz() const { return static_cast<int>(z_edge_m.size()) - 1; }
  std::size_t columns() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  double thickness_m(int k) const { return z_edge_m[k + 1] - z_edge_m[k]; }
  /// Whether every ray of a direction crosses the same matter in level k, and never a side.
  bool is_uniform(int k) const { return periodic && !uniform.empty() && uniform[k] != 0; }
};

/// The layers of one level, in blocks of columns. The voxels of a block that hold no cloud share one cell, whose
/// radiance is their mean.
struct AirBlocks {
  std::uint32_t first_cell = 0;  ///< of the blocks, in the order y, x
  int x = 0;                     ///< blocks along x; 0: the level has no such matter
  int y = 0;
  int width_x = 1;  ///< columns of a block along x; the last block may be narrower
  int width_y = 1;

  int count() const { return x * y; }
  std::uint32_t cell(int i, int j) const {
    return first_cell + static_cast<std::uint32_t>(j / width_y * x + i / width_x);
  }
};

/// Active cells (those with any extinction) level by level. In a level those of single voxels come first, in the order
/// j, i. Those of blocks of air follow, if there are any. Coefficients per active cell in 1/m, unscaled (before
/// delta-M). Absorption is stored beside scattering, never as a difference: 1 - ssa = 1e-12 keeps its digits.
struct OpticalGrid {
  BoxGrid box;
  /// [nz] layers between the clouds; empty: layers are in the voxels' own cells, all of which are active then.
  std::vector<AirBlocks> air;
  double air_error = 0;                  ///< that the blocks leave in column fluxes, RMS over the columns / mean
  std::vector<std::uint32_t> row_begin;  ///< nz*ny + 1, as in CloudField
  std::vector<RowSpan> spans;
  std::vector<float> absorption;               ///< [n] 1/m, cloud and layers together
  std::vector<std::vector<float>> scattering;  ///< [phase function p][n] 1/m, cloud and layers together
  /// The horizontally uniform part alone (already contained in the above): what an open side shows.
  std::vector<double> layer_absorption;               ///< [nz] 1/m
  std::vector<std::vector<double>> layer_scattering;  ///< [p][nz] 1/m

  // Thermal emission: Planck radiance B, W m-2 sr-1, in the spectral unit of the sun's irradiance. All are empty if no
  // matter emits. In a cell B is linear in height.
  std::vector<float> planck;              ///< [n] mean of the cell
  std::vector<float> planck_step;         ///< [n] at the cell's top less at its bottom
  std::vector<double> layer_planck;       ///< [nz] of the layers alone, mean
  std::vector<double> layer_planck_step;  ///< [nz] at the level's top less at its bottom

  bool emits() const { return !planck.empty(); }

  std::size_t active_cells() const { return absorption.size(); }
  /// Spans of the row of cells (., j, k).
  std::span<const RowSpan> row(int k, int j) const {
    const std::size_t at = static_cast<std::size_t>(k) * box.ny + j;
    return {spans.data() + row_begin[at], spans.data() + row_begin[at + 1]};
  }
  /// Calls use(k, j, span) for each span, in the order of the cells.
  template <class Use>
  void for_each_span(const Use& use) const {
    for (int k = 0; k < box.nz(); ++k) {
      for (int j = 0; j < box.ny; ++j) {
        for (const RowSpan& span : row(k, j)) use(k, j, span);
      }
    }
  }
  /// The blocks of level k; none if layers are in the voxels' own cells.
  AirBlocks air_of(int k) const { return air.empty() ? AirBlocks{} : air[k]; }
  /// Calls use(j, i, n) for each run of n voxels without cloud, from (i, j) on. For grids with blocks of air.
  template <class Use>
  void for_each_gap(int k, const Use& use) const {
    for (int j = 0; j < box.ny; ++j) {
      std::int32_t i = 0;
      for (const RowSpan& span : row(k, j)) {
        if (span.i > i) use(j, i, span.i - i);
        i = span.i + span.n;
      }
      if (i < box.nx) use(j, i, box.nx - i);
    }
  }
  /// Calls use(column, cell) for every voxel of level k with matter; column = j*nx + i.
  template <class Use>
  void for_each_place_of(int k, const Use& use) const {
    for (int j = 0; j < box.ny; ++j) {
      for (const RowSpan& span : row(k, j)) {
        const std::size_t column = static_cast<std::size_t>(j) * box.nx + span.i;
        for (std::size_t n = 0; n < static_cast<std::size_t>(span.n); ++n) use(column + n, span.offset + n);
      }
    }
    const AirBlocks of_level = air_of(k);
    if (of_level.count() == 0) return;
    for_each_gap(k, [&](int j, int first, int n) {
      for (int i = first; i < first + n; ++i)
        use(static_cast<std::size_t>(j) * box.nx + i, static_cast<std::size_t>(of_level.cell(i, j)));
    });
  }
  /// Calls use(k, column, cell) for every voxel with matter, level by level.
  template <class Use>
  void for_each_place(const Use& use) const {
    for (int k = 0; k < box.nz(); ++k)
      for_each_place_of(k, [&](std::size_t column, std::size_t cell) { use(k, column, cell); });
  }
  /// Calls use(k, cell, n) for every cell, level by level, with the number of its voxels.
  template <class Use>
  void for_each_cell(const Use& use) const {
    std::vector<std::uint32_t> voxels;
    for (int k = 0; k < box.nz(); ++k) {
      for (int j = 0; j < box.ny; ++j) {
        for (const RowSpan& span : row(k, j))
          for (std::size_t n = 0; n < static_cast<std::size_t>(span.n); ++n) use(k, span.offset + n, 1U);
      }
      const AirBlocks of_level = air_of(k);
      if (of_level.count() == 0) continue;
      voxels.assign(static_cast<std::size_t>(of_level.count()), 0);
      for_each_gap(k, [&](int j, int first, int n) {
        for (int i = first, run = 0; i < first + n; i += run) {
          run = std::min(first + n - i, of_level.width_x - i % of_level.width_x);
          voxels[of_level.cell(i, j) - of_level.first_cell] += static_cast<std::uint32_t>(run);
        }
      });
      for (std::size_t b = 0; b < voxels.size(); ++b)
        if (voxels[b] > 0) use(k, of_level.first_cell + b, voxels[b]);
    }
  }
  /// The active cells of level k are [first_cell(k), first_cell(k + 1)), those of single voxels first; k <= nz.
  std::size_t first_cell(int k) const {
    for (; k < box.nz(); ++k) {
      const std::uint32_t span = row_begin[static_cast<std::size_t>(k) * box.ny];
      if (span < row_begin[static_cast<std::size_t>(k + 1) * box.ny]) return spans[span].offset;
      if (air_of(k).count() > 0) return air[k].first_cell;
    }
    return active_cells();
  }
  /// Absorption and scattering by all phase functions together, 1/m.
  double extinction(std::size_t cell) const {
    double sum = absorption[cell];
    for (const auto& of_phase : scattering) sum += static_cast<double>(of_phase[cell]);
    return sum;
  }
};

/// Finds the levels of a grid in which nothing varies: BoxGrid::uniform.
void mark_uniform_levels(OpticalGrid& grid);

/// The layers of `grid` as one periodic column with the same levels and phase functions.
OpticalGrid layers_only(const OpticalGrid& grid);

/// Optical properties of the cloud's droplets: the same everywhere, or by voxel.
struct CloudOptics {
  double extinction_per_value = 1;                     ///< multiplies CloudField::value to give extinction [1/m], > 0
  double single_scattering_albedo = 1;                 ///< used if voxel_single_scattering_albedo is empty
  std::vector<double> voxel_single_scattering_albedo;  ///< per active voxel, or empty
  int phase_function = 0;                              ///< index into the problem's phase functions
  /// If droplets vary, per active voxel: the first of two phase functions, phase_function + voxel_phase_function. The
  /// share is that of its scattering that follows the next one. Otherwise both are empty.
  std::vector<std::uint16_t> voxel_phase_function;
  std::vector<float> voxel_next_share;
};

/// Matter of one kind in voxels, such as liquid or ice.
struct CloudConstituent {
  const CloudField* field = nullptr;
  const CloudOptics* optics = nullptr;
};

/// The matter of a scene's voxels: constituents, which add up in a voxel by their coefficients.
struct CloudMatter {
  const CloudField* voxels = nullptr;            ///< all of them, as sum_of() joins fields; null: no cloud
  std::vector<CloudConstituent> constituents{};  ///< fields in the same box, of some of these voxels each
};

/// Horizontally uniform matter between two heights.
struct Layer {
  double bottom_m = 0;
  double top_m = 0;
  double optical_depth = 0;  ///< vertical, extinction
  double single_scattering_albedo = 1;
  int phase_function = 0;
};

/// The cells of layers beside clouds, in grids of more than one column.
enum class AirCells {
  of_voxels,  ///< each voxel has its own
  in_blocks,  ///< OpticalGrid::air, in blocks as wide as accuracy allows
  automatic   ///< in blocks, unless these would be too narrow to save anything
};

/// Blocks of air, and what they leave out.
struct AirBlockWidth {
  int columns = 0;   ///< along x and y; 0: one block for a level; 1: blocks do not pay
  double error = 0;  ///< of column fluxes, RMS over the columns / mean
};

/// Largest error of blocks, of column fluxes, RMS over the columns / mean.
constexpr double largest_air_error = .003;

/// The widest blocks that are accurate enough (docs/theory.md, "Layers in blocks").
/// @param depth scattering optical depth of the layers near the clouds, delta-M scaled.
/// @param distance_m mean distance of this scattering from the ground, or from the domain's top if that is less.
/// @param column_m width of a column. @param columns of the domain, the larger number along x and y.
/// @param largest_error that blocks may have.
AirBlockWidth air_block_width(double depth, double distance_m, double column_m, int columns,
                              double largest_error = largest_air_error);

/// Subdivision of levels without cloud. Optical depths are vertical and after delta-M. Interfaces are those between
/// different optics, and the domain's top and bottom. At the optical distance t from the nearest interface, the
/// thickness of a level is:
///   h(t) = min(edge_optical_depth + growth t, max(max_optical_depth, deep_growth t)).
/// Levels are thin near the interfaces, because radiance changes fast there, and at most max_optical_depth inside. Only
/// diffusion is left beyond t = max_optical_depth / deep_growth. There they grow again, so that optical depths of 1e4
/// take some hundreds of levels.
struct LevelOptions {
  double edge_optical_depth = 0.02;
  double growth = 0.2;
  double max_optical_depth = 1;
  double deep_growth = 0.02;
  int min_levels = 1;           ///< of each stretch of the same optics
  std::vector<double> edges_m;  ///< heights at which levels must end, beside those of cloud and layers
  int layer_cells = 0;          ///< > 0: this many equal levels between any two layer edges, whatever the optics
  /// If not empty, exactly these levels are used: those that another grid of the same cloud, layers and domain has, or
  /// finest_levels() of several.
  std::vector<double> levels_m;
  AirCells air = AirCells::of_voxels;
  double largest_air_error = cloudbow::largest_air_error;  ///< of its blocks
  /// Limit of the grid's coefficients; exceeding it is an error before memory is taken.
  std::uint64_t memory_limit_bytes = std::numeric_limits<std::uint64_t>::max();

  static LevelOptions layers_only() {
    LevelOptions options;
    options.min_levels = 12;
    return options;
  }
};

/// Levels for grids that differ in their optics only, from the levels of each (all ascending, with the same ends).
/// Between edges that all have, they are those of the grid with the finest levels there.
std::vector<double> finest_levels(const std::vector<std::vector<double>>& levels_m);

/// Joins clouds and layers on one grid. Horizontally the cloud's cells (layers only: one cell of 1 m); vertically the
/// faces of the voxel planes between the lowest and the highest active voxel, joined with the layers' edges; below and
/// above them the layers' edges, subdivided as the optics require. Stretches without matter stay single levels. Edges
/// closer than 1e-9 of the domain's height become one.
/// @param clouds their voxels may be null.
/// @param domain_min_m, domain_max_m the corners of the domain. They lie on voxel faces (horizontally) and contain the
/// active voxels and the layers.
/// @param delta_m_fraction [p] forward fraction f of each phase function, used to choose the subdivision.
/// @throws InputError if sizes exceed the range of indices or the memory limit; if an extinction is not finite; if a
/// layer reaches outside the domain or is thinner than the distance at which edges merge.
OpticalGrid make_optical_grid(const CloudMatter& clouds, const std::vector<Layer>& layers,
                              const std::array<double, 3>& domain_min_m, const std::array<double, 3>& domain_max_m,
                              bool periodic, int phase_functions, const std::vector<double>& delta_m_fraction,
                              const LevelOptions& options);

/// The same with one constituent. @param cloud may be null.
OpticalGrid make_optical_grid(const CloudField* cloud, const CloudOptics& cloud_optics,
                              const std::vector<Layer>& layers, const std::array<double, 3>& domain_min_m,
                              const std::array<double, 3>& domain_max_m, bool periodic, int phase_functions,
                              const std::vector<double>& delta_m_fraction, const LevelOptions& options);

}  // namespace cloudbow
