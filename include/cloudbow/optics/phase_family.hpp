// Phase functions that vary from voxel to voxel: as members of a family of functions, and as few classes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cloudbow/optics/droplet_table.hpp"
#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

/// The phase function of a voxel: a member of a family, of which the next member has a share of the scattering.
struct FamilyMember {
  std::size_t member = 0;
  double next_share = 0;  ///< 0 to 1
};

/// Phase functions in the order of one parameter, and the one that each voxel has.
struct PhaseFamily {
  std::vector<PhaseFunction> function;
  std::vector<FamilyMember> voxel;  ///< [voxel]
};

/// Optics of droplets whose effective radius varies.
struct VoxelDroplets {
  std::vector<double> extinction_m2_per_g;       ///< [voxel] extinction coefficient [1/m] of 1 g/m3 of water
  std::vector<double> single_scattering_albedo;  ///< [voxel]
  PhaseFamily phase;                             ///< rows of the table, from the first to the last in use
};

/// Each voxel is the mixture of two neighbouring rows that has its effective radius, as droplet_optics() mixes them.
/// @throws InputError if a radius is outside the table.
VoxelDroplets droplets_of_voxels(const DropletTable& table, std::span<const float> effective_radius_um);

/// The functions of a set, ordered by asymmetry parameter, so that neighbours differ little.
/// @param number [voxel] index into `set`
PhaseFamily family_of_set(std::span<const PhaseFunction> set, std::span<const std::size_t> number);

/// Few phase functions in place of a family: each voxel is a mixture of two neighbouring classes.
struct VoxelClasses {
  std::vector<PhaseFunction> function;
  std::vector<std::uint16_t> lower;  ///< [voxel] the first of its two classes
  std::vector<float> next_share;     ///< [voxel] share of the scattering that follows class `lower` + 1
  int functions = 0;                 ///< members of the family that scatter
  double estimated_error = 0;        ///< of mixing, fraction of the incident light (docs/theory.md, (17c))
};

/// Classes by PhaseClasses. A voxel that scatters nothing is of class 0 if no scattering voxel shares its function.
/// @param scattering [voxel] weight of its phase function, >= 0
/// @param tolerance fraction of the incident light
VoxelClasses classes_of_voxels(const PhaseFamily& family, std::span<const double> scattering, double tolerance);

}  // namespace cloudbow
