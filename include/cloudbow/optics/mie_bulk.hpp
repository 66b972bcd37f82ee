// Bulk optics of clouds of spheres at many wavelengths by Mie theory, for averages over spectra.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "cloudbow/optics/bulk_optics.hpp"
#include "cloudbow/optics/droplet_distribution.hpp"
#include "cloudbow/optics/refractive_index.hpp"

namespace cloudbow {

/// Substance of the spheres and distribution of their sizes.
struct MieBulkRecipe {
  Substance substance = Substance::water;
  DistributionKind distribution = DistributionKind::gamma;
  double effective_variance = 0.1;
};

struct MieBulkOptions {
  int threads = 0;                          ///< 0: all. The table has the same bits for any number
  std::filesystem::path cache_directory{};  ///< empty: no cache
};

/// Wavelengths [um], as many as averages over g-points need, both ends among them. Their ratios are equal: 24 per
/// decade below .7 um, 200 from there to 5 um, 60 beyond. Absorption bands of water and ice are narrow in the middle
/// range. All are within the range of refractive_index(). The error is in docs/formats.md, "Tables of bulk optics".
/// @throws InputError if nothing is left of the range, or its ends do not ascend.
std::vector<double> mie_wavelengths(double shortest_um, double longest_um);

/// Extinction, albedo and asymmetry of the distributions: no phase functions.
/// @param wavelength_um ascending. @param effective_radius_um ascending.
/// @throws InputError as make_mie_table() and refractive_index().
BulkTable make_mie_bulk_table(const MieBulkRecipe& recipe, std::span<const double> wavelength_um,
                              std::span<const double> effective_radius_um, const MieBulkOptions& options = {});

}  // namespace cloudbow
