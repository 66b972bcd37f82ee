// Tables of droplets by Mie theory.
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "cloudbow/optics/bulk_optics.hpp"
#include "cloudbow/optics/droplet_distribution.hpp"
#include "cloudbow/optics/droplet_table.hpp"

namespace cloudbow {

/// Material of droplets and distribution of their sizes.
struct DropletRecipe {
  double wavelength_um = 0.55;                     ///< in the medium around the droplets
  std::complex<double> refractive_index{1.33, 0};  ///< n + i k relative to that medium
  double density_g_cm3 = 1;
  DistributionKind distribution = DistributionKind::gamma;
  double effective_variance = 0.1;
};

struct MieTableOptions {
  /// Largest step between sizes at which phase functions are computed, in size parameters; a fifth of it for extinction
  /// and albedo. The remaining error from narrow resonances of single spheres is in docs/droplets.md.
  double size_step = 0.05;
  int threads = 0;                                  ///< 0: all. The table has the same bits for any number
  std::function<void(double fraction)> progress{};  ///< called now and then from the calling thread; may throw to stop
};

/// Largest size parameter of any droplet that is computed: beyond it a table takes hours.
inline constexpr double largest_size_parameter = 12000;
/// Smallest: an atom in light of a kilometre's wavelength; powers of it must be numbers.
inline constexpr double smallest_size_parameter = 1e-12;

/// Computes all radii at once, over one set of sizes, by the trapezoidal rule. Its variable gives steps of size_step
/// for large and of constant ratio for small droplets. Phase functions are exact polynomials: enough Gauss-Legendre
/// cosines make the norm and every moment exact. Moments are kept down to (2l+1) |chi_l| = 1e-8.
/// @param effective_radius_um ascending.
/// @throws InputError for radii that do not ascend or are out of range; n outside .001 to 1000 or k outside 0 to 1000;
/// distribution as DropletDistribution says; wavelength <= 0, density outside .001 to 100; droplets larger than
/// largest_size_parameter or smaller than smallest_size_parameter.
DropletTable make_mie_table(const DropletRecipe& recipe, std::span<const double> effective_radius_um,
                            const MieTableOptions& options = {});

/// Extinction, albedo and asymmetry alone: no phase functions, and so far less time.
/// @param size_step as in MieTableOptions, but of all sums. @returns [radius] @throws InputError as make_mie_table().
std::vector<BulkOptics> mie_bulk_optics(const DropletRecipe& recipe, std::span<const double> effective_radius_um,
                                        double size_step, int threads = 0);

}  // namespace cloudbow
