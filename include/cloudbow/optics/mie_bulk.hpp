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

/// Wavelengths per decade that averages over g-points need. The error is measured in docs/formats.md, "Tables of bulk
/// optics".
inline constexpr int mie_wavelengths_per_decade = 60;

/// Wavelengths [um] in equal ratios, at least so many per decade, both ends among them. The range is narrowed to that
/// of refractive_index(). @throws InputError if nothing of it is left, or the ends do not ascend.
std::vector<double> mie_wavelengths(double shortest_um, double longest_um, int per_decade = mie_wavelengths_per_decade);

/// Extinction, albedo and asymmetry of the distributions: no phase functions.
/// @param wavelength_um ascending. @param effective_radius_um ascending.
/// @throws InputError as make_mie_table() and refractive_index().
BulkTable make_mie_bulk_table(const MieBulkRecipe& recipe, std::span<const double> wavelength_um,
                              std::span<const double> effective_radius_um, const MieBulkOptions& options = {});

}  // namespace cloudbow
