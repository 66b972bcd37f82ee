// Light at the ground: from light that arrives along the ordinates to light that leaves (docs/theory.md, "Surfaces").
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "cloudbow/core/digest.hpp"
#include "cloudbow/medium/surface.hpp"
#include "transport/scattering/scattering.hpp"

namespace cloudbow {

/// Light that leaves the ground, in any upward direction.
template <class Real>
struct GroundRadiance {
  std::optional<ControlPoints> points;      ///< without: the same in all directions
  AngularField<Real> at_points;             ///< one row a control point, or a single row; [columns]
  std::vector<double> flux;                 ///< [columns] upward
  std::optional<BeamReflection> beam = {};  ///< if direct light is not in at_points: reflected exactly
  std::vector<Real> direct_flux = {};       ///< [columns] of it, through the horizontal

  /// Radiance [columns] along a direction of travel. @param scratch holds it if it must be computed.
  const Real* along(const Direction& travel, std::vector<Real>& scratch) const;
  /// The same for one column.
  Real at(const Direction& travel, std::size_t column) const;
};

/// Light that arrives along one ordinate: rays by the columns they were launched from.
template <class Real>
struct ArrivingRays {
  std::vector<Real> radiance;  ///< [columns], at least
  int shift_x = 0;             ///< columns from a ray's launch to the one it arrives in, modulo the box
  int shift_y = 0;

  /// [columns] by the column they arrive in.
  std::vector<Real> by_column(const BoxGrid& box) const;
};

/// Adds light that arrives along an ordinate to the diffuse flux through the ground.
/// @param flux [4][columns] by octant of light that travels down
template <class Real>
void add_arriving(const ArrivingRays<Real>& rays, const OrdinateSet& ordinates, int ordinate, const BoxGrid& box,
                  std::span<double> flux);

template <class Real>
class Ground {
 public:
  Ground() = default;  ///< black
  Ground(const Surface& surface, const OrdinateSet& ordinates, const std::optional<Direction>& sun_travel);

  /// Effect of the light that arrives in one sweep.
  struct Reflection {
    std::vector<double> flux;    ///< [columns] that arrived, direct and diffuse
    AngularField<Real> leaving;  ///< radiance: one row an upward ordinate, or a single row for all; [columns]
    double absorbed = 0;         ///< W m-2, mean over the columns
  };
  /// @param arriving [D] along the ordinates; those that travel up are not used, and none over a Lambertian ground.
  /// @param diffuse_flux of add_arriving(). @param direct_flux [columns] through the horizontal; empty: none.
  Reflection reflect(const std::vector<ArrivingRays<Real>>& arriving, std::span<const double> diffuse_flux,
                     std::span<const double> direct_flux, const OrdinateSet& ordinates, const BoxGrid& box) const;
  /// Row of Reflection::leaving for an ordinate.
  int leaving_row(int ordinate) const { return row_.empty() ? 0 : row_[ordinate]; }

  /// The same in all directions, for other fluxes than the ordinates'. Light that arrived keeps its distribution over
  /// the ordinates, column by column, and is scaled to the diffuse flux given.
  GroundRadiance<Real> radiance(const std::vector<std::vector<Real>>& arriving, std::span<const double> diffuse_flux,
                                std::span<const double> direct_flux, const OrdinateSet& ordinates) const;
  /// With direct light reflected by the surface's own function instead of its control points.
  GroundRadiance<Real> radiance_seen(const std::vector<std::vector<Real>>& arriving,
                                     std::span<const double> diffuse_flux, std::span<const double> direct_flux,
                                     const OrdinateSet& ordinates) const;

  /// The same surface with so much less Planck radiance: for differences of light.
  Ground with_planck_less(double reference) const;
  Ground without_emission() const;
  /// Flux that it emits, W m-2, mean over the columns.
  double mean_emission() const;

  bool is_lambertian() const { return !table_; }
  /// Share of evenly arriving light that leaves.
  double mean_albedo() const;
  double mean_planck() const;
  double largest_albedo() const;  ///< over directions and columns
  const std::optional<ReflectionTable>& table() const { return table_; }
  /// Input of its reflections.
  void add_to(Digest& digest) const;

 private:
  double albedo(std::size_t column) const { return albedo_map_.empty() ? albedo_ : albedo_map_[column]; }

  void add_emission(const Eigen::VectorXd& emissivity, AngularField<Real>& leaving) const;
  bool emits() const { return planck_ != 0 || !planck_map_.empty(); }
  double planck(std::size_t column) const { return planck_map_.empty() ? planck_ : planck_map_[column]; }

  double albedo_ = 0;
  std::vector<float> albedo_map_;
  double planck_ = 0;
  std::vector<float> planck_map_;
  std::optional<ReflectionTable> table_;
  std::vector<int> row_;  // [D] place of an ordinate among those that travel up
  // By Kirchhoff's law, from the table's own reflection of equal light from everywhere: radiance in an enclosure of one
  // temperature is then the same in all directions.
  Eigen::VectorXd emissivity_up_;      // [D_u] along the ordinates; empty: Lambertian, or no emission
  Eigen::VectorXd emissivity_points_;  // [M] at the control points
  double mean_emissivity_ = 0;         // of the emitted flux, as the ordinates sum it; not Lambertian
};

}  // namespace cloudbow
