// Diffusion synthetic acceleration: the error after a sweep is nearly isotropic and obeys a diffusion equation. It is
// solved here for the correction of the scalar flux (docs/theory.md, "Acceleration"; Alcouffe 1977, Larsen 1982).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Columns of a grid of nx x ny columns, each with its neighbours among them.
struct ColumnSet {
  enum Side : std::uint8_t { east, west, north, south };
  static constexpr std::array<Side, 4> sides{east, west, north, south};

  int nx = 1, ny = 1;
  std::vector<std::uint32_t> place;  ///< [size()] j * nx + i, ascending
  /// [size()] the columns beside each. size() if there is none: beyond an open side, or along an axis with one column.
  std::vector<std::array<std::uint32_t, 4>> beside;

  /// @param place see above. @param periodic the sides of the grid.
  ColumnSet(int nx, int ny, bool periodic, std::vector<std::uint32_t> place);
  /// All columns of a box.
  static ColumnSet of(const BoxGrid& box);

  std::size_t size() const { return place.size(); }
  /// [nx * ny] the column at each place; size() if there is none.
  std::vector<std::uint32_t> by_place() const;
  int i(std::size_t column) const { return static_cast<int>(place[column]) % nx; }
  int j(std::size_t column) const { return static_cast<int>(place[column]) / nx; }
};

/// Coefficients of cells, all >= 0. Level k of a column is cell column * nz + k.
struct DiffusionCoefficients {
  std::vector<float> extinction;  ///< sigma' 1/m
  std::vector<float> transport;   ///< sigma' - sum_p scattering'_p chi'_1p, 1/m
  std::vector<float> absorption;  ///< 1/m
  double surface_albedo = 0;
  bool independent_columns = false;  ///< independent columns: no coupling across
};

/// Limit of the free path in (23) for cells of level k, m: 4 h, or .05 of the depth of the medium if that is more.
double longest_free_path(const BoxGrid& box, int k, double depth_m);

/// Seven-point finite volumes with harmonic face coefficients. Marshak conditions hold at top and bottom, at open sides
/// and beside columns that take no part. The equations are solved by conjugate gradients with one multigrid
/// V-cycle (z-line smoothing, coarsening across) as preconditioner. The result is deterministic.
class DiffusionOperator {
 public:
  /// @param columns of the box that take part.
  DiffusionOperator(const BoxGrid& box, ColumnSet columns, const DiffusionCoefficients& coefficients);
  ~DiffusionOperator();
  DiffusionOperator(DiffusionOperator&&) noexcept;
  DiffusionOperator& operator=(DiffusionOperator&&) noexcept;

  /// Arrays of solve(), to be kept between calls.
  struct Workspace {
    std::vector<std::vector<float>> x, right, work;  // of each grid of the multigrid
    std::vector<double> residual, direction, product;
  };

  /// Solves A e = source to relative residual `tolerance`.
  /// @param source [cells] power released in each cell; @param correction [cells] out: scalar flux e.
  void solve(std::span<const double> source, std::span<double> correction, double tolerance, Workspace& work) const;

  const ColumnSet& columns() const;
  /// Diffusivity of a cell [m]: all of (23), or its first term alone.
  double diffusivity(std::size_t cell) const { return diffusivity_[cell]; }
  double free_diffusivity(std::size_t cell) const { return free_diffusivity_[cell]; }

 private:
  struct Level;
  void cycle(Workspace& work) const;

  std::vector<float> diffusivity_;
  std::vector<float> free_diffusivity_;
  std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace cloudbow
