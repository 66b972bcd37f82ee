// Diffusion synthetic acceleration: the error after a sweep is nearly isotropic and obeys a diffusion equation. It is
// solved here for the correction of the scalar flux (docs/theory.md, "Acceleration"; Alcouffe 1977, Larsen 1982).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Coefficients by dense cell (k*ny + j)*nx + i, all >= 0.
struct DiffusionCoefficients {
  std::vector<float> extinction;  ///< sigma' 1/m
  std::vector<float> transport;   ///< sigma' - sum_p scattering'_p chi'_1p, 1/m
  std::vector<float> absorption;  ///< 1/m
  double surface_albedo = 0;
  bool independent_columns = false;  ///< independent columns: no coupling across
};

/// Limit of the free path in (23) for cells of level k, m: 4 h, or .05 of the depth of the medium if that is more.
double longest_free_path(const BoxGrid& box, int k, double depth_m);

/// Seven-point finite volumes with harmonic face coefficients, and Marshak conditions at top and bottom (and open
/// sides). They are solved by conjugate gradients with one multigrid V-cycle (z-line smoothing, coarsening across) as
/// preconditioner. The result is deterministic.
class DiffusionOperator {
 public:
  DiffusionOperator(const BoxGrid& box, const DiffusionCoefficients& coefficients);
  ~DiffusionOperator();
  DiffusionOperator(DiffusionOperator&&) noexcept;
  DiffusionOperator& operator=(DiffusionOperator&&) noexcept;

  /// Solves A e = source to relative residual `tolerance`.
  /// @param source [cells] power released in each cell; @param correction [cells] out: scalar flux e.
  void solve(std::span<const double> source, std::span<double> correction, double tolerance = .02) const;

  /// Diffusivity of a dense cell [m]: all of (23), or its first term alone.
  double diffusivity(std::size_t cell) const { return diffusivity_[cell]; }
  double free_diffusivity(std::size_t cell) const { return free_diffusivity_[cell]; }

 private:
  struct Level;
  std::vector<float> diffusivity_;
  std::vector<float> free_diffusivity_;
  std::vector<std::unique_ptr<Level>> levels_;
};

}  // namespace cloudbow
