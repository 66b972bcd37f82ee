// Clouds from parameters and a seed: slab, step, sphere, cumulus, stratocumulus. Extinction [1/m]; the clouds wrap
// around horizontally.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

struct CloudMakerOptions {
  std::string kind;            ///< slab, step, sphere, cumulus or stratocumulus
  std::array<int, 3> cells{};  ///< of the whole domain, clear air included; its lower corner is the origin
  std::array<double, 3> voxel_size_m{};
  /// Mean over the columns with any cloud (sphere: through the centre). Default: slab and step 10, sphere 20, cumulus
  /// and stratocumulus what the adiabatic liquid water gives.
  std::optional<double> optical_depth;
  /// Fraction of columns with any cloud, 0 to 1; cumulus (default 0.2) and stratocumulus (default 1) only.
  std::optional<double> cover;
  std::uint64_t seed = 1;  ///< cumulus and stratocumulus
  /// Height of the cloud base, a level of the cells' faces after rounding. Default: slab and step 0; cumulus and
  /// stratocumulus 0.4 of the domain's height. A sphere stands in the middle of the domain and takes none.
  std::optional<double> base_m;
};

/// The kinds that make_cloud accepts.
const std::vector<std::string>& cloud_maker_kinds();

/// - slab: uniform from base_m to the top of the domain.
/// - step: like a slab, with 0.2 times the optical depth in the left half (small x) and 1.8 times in the right half. An
///   optical depth of 10 is the I3RC step cloud (Cahalan et al. 2005, doi 10.1175/BAMS-86-9-1275).
/// - sphere: uniform, as large as the domain allows with half a cell of clear air; cells on its surface have their
///   share.
/// - cumulus: a population of clouds with a power-law distribution of sizes and a common flat base. Liquid water grows
///   with height as in a diluted adiabatic parcel; tops are cauliflower-like and edges thin and turbulent.
/// - stratocumulus: a layer with a flat base, whose optical depth is lognormal with a -5/3 spectrum, adiabatic in the
///   vertical.
///
/// The same options give the same field, whatever the compiler and its library: random numbers and distributions are
/// this program's own. Values of the random kinds are rounded to 11 significant bits, coarser than any difference of a
/// math library.
/// @throws InputError if an option is missing, out of range or does not belong to the kind.
CloudField make_cloud(const CloudMakerOptions& options);

}  // namespace cloudbow
