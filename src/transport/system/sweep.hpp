// One sweep: light crosses the box along every ordinate, from the source at the ordinates to the voxel-mean radiance.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "transport/rays/ordinate_path.hpp"
#include "transport/scattering/ordinate_scattering.hpp"
#include "transport/system/ground.hpp"
#include "transport/system/ordinate_share.hpp"
#include "transport/system/source_slopes.hpp"

namespace cloudbow {

/// The direct beam of the iteration (order N_b). Without sun all arrays are empty.
template <class Real>
struct SystemBeam {
  std::vector<BeamSource<Real>> source;  ///< its first scattering at the ordinates, of each phase function that has any
  std::vector<Real> irradiance;          ///< [n]
  std::vector<double> surface_flux;      ///< [columns] at the surface
  std::vector<double> profile;           ///< [nz+1] domain means of its flux
  double side_gain = 0;                  ///< W m-2 of the top
  double side_loss = 0;
};

/// Data that do not change during the iteration.
template <class Real>
struct TransportSystem {
  BoxGrid box;
  bool independent_columns = false;
  std::shared_ptr<const Cells<Real>> cells;
  OrdinateSet ordinates;
  std::vector<OrdinatePath> paths;  ///< [D]
  bool linear_source = true;        ///< within a cell; false: constant, and no gradient of any source is made
  /// For slopes of the source from the light's own moments; empty: from differences between neighbours.
  std::optional<SlopeTables<Real>> slopes = {};
  bool keeps_radiance_slopes = true;  ///< after the iteration: views need them
  OrdinateScattering<Real> scattering;
  std::vector<double> truncated_asymmetry;  ///< [p] chi'_1
  std::vector<float> absorption;            ///< [n] 1/m
  SystemBeam<Real> beam;
  double sky_radiance = 0;
  Ground<Real> ground;
  double power = 1;     ///< unit of the energy ledger, W m-2 of the top: EnergyLedger::power
  double incident = 1;  ///< of it, sun and sky through the top
  /// Open sides: radiance coming in along ordinate d at each interface in marching order; empty: none.
  std::vector<std::vector<Real>> side_radiance;
  /// [1 to low_moments][n] moments of a source beside the beam's; empty: none.
  std::vector<Real> emission = {};
  bool thermal = false;            ///< that source is Cells::emitted
  std::vector<float> planck = {};  ///< [n] of thermal emission, as OpticalGrid's; empty: none
  /// Their mean by absorption: light is counted from it in the first guess and in the gather (docs/theory.md, "Thermal
  /// emission").
  double mean_planck = 0;

  bool has_independent_columns() const { return independent_columns || (box.periodic && box.columns() == 1); }
  /// Thermal emission in the source.
  CellEmission<Real> thermal_emission() const { return thermal ? cells->emission() : CellEmission<Real>{}; }

  /// Radiance, with this added to its moments (empty: nothing), becomes source.
  /// @param dark there is no radiance yet, whatever the field holds.
  void scatter(AngularField<Real>& field, std::span<const Real> correction, bool dark) const {
    scattering.scatter_in_place(field, *cells, {beam.source, correction, emission, dark});
  }
  /// [low_moments][n] of the radiance.
  void moments(const AngularField<Real>& radiance, std::span<Real> of) const { scattering.moments_of(radiance, of); }
};

/// Powers of the energy ledger, in W m-2 of the top, by the ordinates alone. Direct light is that of the solver's own
/// beam.
template <class Real>
struct SweepFluxes {
  double up_top = 0;
  double side_gain = 0;  ///< diffuse
  double side_loss = 0;
  double surface_absorbed = 0;
  std::vector<double> surface_flux;  ///< [columns] direct and diffuse, downward
  /// [D][columns] radiance that arrives at the surface, only from a recording sweep over one that is not Lambertian.
  std::vector<std::vector<Real>> surface_arriving;
  std::vector<double> profile_up;  ///< [nz+1] domain means, only from a recording sweep
  std::vector<double> profile_down;
  std::vector<double> column_up;  ///< [nz+1][columns], only from a recording sweep of columns that exchange no light
  std::vector<double> column_down;
};

/// Relative gradient of the mean source of some ordinates; empty if the source is constant in each cell.
template <class Real>
struct GroupGradient {
  std::vector<Real> source;                     ///< [n] their mean,
  std::vector<Real> rest;                       ///< [n] and that less thermal emission; empty: it has none
  std::array<std::vector<Real>, 3> axis;        ///< [n + lane_padding] along x, y, z
  std::array<std::vector<Real>, 3> transposed;  ///< the same in the order of a march along x; empty: not needed
};

/// Work arrays of sweeps apart from the field, kept from one to the next.
template <class Real>
struct SweepWorkspace {
  struct Thread {
    std::vector<Real> unpacked, mean, plane, transposed_source, transposed_mean, from_beam;
    std::vector<Real> rest;                 ///< [n] source less thermal emission
    Slope<Real> moment, transposed_moment;  ///< of one ordinate's radiance
    SidewaysWorkspace<Real> sideways;
    GroupGradient<Real> gradient;  ///< of one ordinate, if none is shared
    ArrivingRays<Real> rays;       ///< of one ordinate
  };
  std::vector<Thread> of_thread;
  std::vector<ArrivingRays<Real>> arriving;  ///< [D] at a ground that is not Lambertian; those that travel up are empty
  GroupGradient<Real> gradient;
  Slope<Real> moment;  ///< of an octant's radiance
};

/// One sweep: source at the ordinates becomes voxel-mean radiance.
/// @param slopes of the radiance that was scattered; they become those of the new radiance, unless they are frozen.
/// Null: slopes from differences between neighbours.
/// @param share the rows of the field and of other ranks, not of columns that exchange no light. New slopes are then
/// those of the radiance alone, until finish_slopes(). Null: all rows are here.
template <class Real>
SweepFluxes<Real> sweep(const TransportSystem<Real>& system, AngularField<Real>& field, bool record,
                        SweepWorkspace<Real>& work, LightSlopes<Real>* slopes = nullptr,
                        const OrdinateShare* share = nullptr);

/// The slopes of the source after a shared sweep that found new ones. @param radiance all rows of the rank's cells
template <class Real>
void finish_slopes(const TransportSystem<Real>& system, const OrdinateShare& share, const AngularField<Real>& radiance,
                   LightSlopes<Real>& slopes);

}  // namespace cloudbow
