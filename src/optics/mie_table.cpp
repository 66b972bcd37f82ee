#include "cloudbow/optics/mie_table.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "cloudbow/core/thread_scope.hpp"
#include "cloudbow/optics/mie_sphere.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int sizes_per_block = 48;
constexpr int angles_per_tile = 64;
constexpr double last_moment = 1e-8;  // of (2l+1) chi_l
/// Steps of efficiencies per step of intensities. Efficiencies take little time and contain the narrow resonances of
/// spheres.
constexpr int efficiency_steps = 5;

void check_recipe(const DropletRecipe& recipe, std::span<const double> radii) {
  const auto reject = [](const char* what, double found, const char* allowed) {
    throw InputError(fmt::format("{}: out of range (found {}, allowed {})", what, found, allowed));
  };
  const std::complex<double> m = recipe.refractive_index;
  if (!(recipe.wavelength_um > 0) || std::isinf(recipe.wavelength_um))
    reject("wavelength", recipe.wavelength_um, "> 0 um");
  // Recurrences take |m| x steps. No matter that light enters has an index outside these.
  if (!(m.real() >= 1e-3 && m.real() <= 1e3)) reject("refractive index", m.real(), "0.001 <= n <= 1000");
  if (!(m.imag() >= 0 && m.imag() <= 1e3)) reject("refractive index", m.imag(), "0 <= k <= 1000");
  if (m == 1.0) reject("refractive index", 1, "one that differs from 1");
  if (!(recipe.density_g_cm3 >= 1e-3 && recipe.density_g_cm3 <= 100))
    reject("density", recipe.density_g_cm3, "0.001 to 100 g/cm3");
  if (radii.empty()) throw InputError("effective radius: none given (allowed at least one)");
  for (const double radius : radii) check_tabulated_radius(radius);
  for (std::size_t n = 1; n < radii.size(); ++n) {
    if (!(radii[n] > radii[n - 1])) reject("effective radius", radii[n], "radii that ascend");
  }
}

/// The sizes at which spheres are computed, and what each counts in each of the distributions.
struct Sizes {
  std::vector<double> radius_um;
  Matrix weight;  // [distribution][size] n(r) dr, largest n of each distribution 1
};

Sizes choose_sizes(const DropletRecipe& recipe, std::span<const double> radii, double size_step) {
  std::vector<DropletDistribution> distributions;
  for (const double radius : radii) {
    distributions.emplace_back(recipe.distribution, radius, recipe.effective_variance);
  }
  const double wave_number = 2 * std::numbers::pi / recipe.wavelength_um;
  const double smallest = distributions.front().smallest_radius_um() * wave_number;
  const double largest = distributions.back().largest_radius_um() * wave_number;
  if (!(largest <= largest_size_parameter)) {
    throw InputError(
        fmt::format("effective radius: droplets too large for this wavelength (found {} um, of which the largest "
                    "droplets have a size parameter of {:.5g}, allowed {:.0f})",
                    radii.back(), largest, largest_size_parameter));
  }
  if (!(smallest >= smallest_size_parameter)) {
    throw InputError(
        fmt::format("effective radius: droplets too small for this wavelength (found {} um, of which the smallest "
                    "droplets have a size parameter of {:.3g}, allowed {:.0e})",
                    radii.front(), smallest, smallest_size_parameter));
  }
  // u(x) = x / step + per_e_fold ln x: steps of 1 in u. A width of the distribution (its relative width is about sqrt
  // v) contains at least four. The trapezoidal rule is then exact to 1e-16 for a bell-shaped function.
  const double per_e_fold = std::max(60.0, 4 / std::sqrt(recipe.effective_variance));
  const auto u = [&](double x) { return x / size_step + per_e_fold * std::log(x); };
  const double u_first = u(smallest);
  const int count = 2 + static_cast<int>(u(largest) - u_first);
  Sizes sizes;
  double x = smallest;
  std::vector<double> width_um;
  for (int n = 0; n < count; ++n) {
    for (int step = 0; step < 8; ++step) x -= (u(x) - (u_first + n)) / (1 / size_step + per_e_fold / x);
    sizes.radius_um.push_back(x / wave_number);
    width_um.push_back(1 / (1 / size_step + per_e_fold / x) / wave_number);
  }
  sizes.weight.resize(static_cast<Eigen::Index>(radii.size()), count);
  for (std::size_t d = 0; d < radii.size(); ++d) {
    const double highest = distributions[d].log_density(distributions[d].mode(2));
    for (int n = 0; n < count; ++n) {
      sizes.weight(static_cast<Eigen::Index>(d), n) =
          std::exp(distributions[d].log_density(sizes.radius_um[n]) - highest) * width_um[n];
    }
  }
  return sizes;
}

/// A few spheres of neighbouring sizes: what the tiles of angles need of them.
struct Block {
  int first = 0;
  int count = 0;
  int terms = 0;
  Matrix sum;         // [2 sphere + (0: real, 1: imaginary)][n-1] a_n + b_n
  Matrix difference;  // a_n - b_n
};

Block make_block(const Sizes& sizes, int first, const DropletRecipe& recipe) {
  const double wave_number = 2 * std::numbers::pi / recipe.wavelength_um;
  Block block;
  block.first = first;
  block.count = std::min(sizes_per_block, static_cast<int>(sizes.radius_um.size()) - first);
  block.terms = mie_term_count(sizes.radius_um[first + block.count - 1] * wave_number);
  block.sum = Matrix::Zero(Eigen::Index{2} * block.count, block.terms);
  block.difference = Matrix::Zero(Eigen::Index{2} * block.count, block.terms);
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic)
  for (int i = 0; i < block.count; ++i) {
    errors.run([&] {
      const MieCoefficients sphere =
          mie_coefficients(sizes.radius_um[first + i] * wave_number, recipe.refractive_index);
      for (std::size_t n = 0; n < sphere.a.size(); ++n) {
        const std::complex<double> sum = sphere.a[n] + sphere.b[n], difference = sphere.a[n] - sphere.b[n];
        const auto column = static_cast<Eigen::Index>(n), row = Eigen::Index{2} * i;
        block.sum(row, column) = sum.real();
        block.sum(row + 1, column) = sum.imag();
        block.difference(row, column) = difference.real();
        block.difference(row + 1, column) = difference.imag();
      }
    });
  }
  errors.rethrow();
  return block;
}

/// Adds the block's intensities (|S_1|^2 + |S_2|^2) / 2 at the cosines of one tile to every distribution's.
void add_intensity(const Block& block, const Sizes& sizes, std::span<const double> cosine,
                   Eigen::Ref<Matrix> intensity) {
  const auto angles = static_cast<Eigen::Index>(cosine.size());
  Eigen::MatrixXd plus(block.terms, angles), minus(block.terms, angles);
  for (Eigen::Index j = 0; j < angles; ++j) {
    mie_angular_functions(cosine[static_cast<std::size_t>(j)],
                          {plus.col(j).data(), static_cast<std::size_t>(block.terms)},
                          {minus.col(j).data(), static_cast<std::size_t>(block.terms)});
  }
  // S_1 + S_2 and S_1 - S_2: the sum of their squares is twice that of S_1 and S_2.
  const Matrix sum = block.sum * plus;
  const Matrix difference = block.difference * minus;
  Matrix sphere(block.count, angles);
  for (Eigen::Index i = 0; i < block.count; ++i) {
    sphere.row(i) = (sum.row(2 * i).array().square() + sum.row(2 * i + 1).array().square() +
                     difference.row(2 * i).array().square() + difference.row(2 * i + 1).array().square()) /
                    4;
  }
  intensity += sizes.weight.middleCols(block.first, block.count) * sphere;
}

/// Extinction, single-scattering albedo and asymmetry of each distribution.
std::vector<BulkOptics> average_efficiencies(const Sizes& sizes, const DropletRecipe& recipe) {
  const double wave_number = 2 * std::numbers::pi / recipe.wavelength_um;
  const auto count = static_cast<int>(sizes.radius_um.size());
  std::vector<MieEfficiencies> efficiencies(sizes.radius_um.size());
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 16)
  for (int n = 0; n < count; ++n) {
    errors.run([&] {
      efficiencies[n] = mie_efficiencies(mie_coefficients(sizes.radius_um[n] * wave_number, recipe.refractive_index));
    });
  }
  errors.rethrow();
  std::vector<BulkOptics> averages;
  for (Eigen::Index d = 0; d < sizes.weight.rows(); ++d) {
    double mass = 0, scattering = 0, absorption = 0, forward = 0;
    for (int n = 0; n < count; ++n) {
      const double radius = sizes.radius_um[n], weighted = sizes.weight(d, n) * radius * radius;
      mass += weighted * radius;
      scattering += weighted * efficiencies[n].scattering;
      absorption += weighted * efficiencies[n].absorption;
      forward += weighted * efficiencies[n].scattering * efficiencies[n].asymmetry_parameter;
    }
    const double extinction = scattering + absorption;
    // pi r^2 Q over (4/3) pi r^3 rho: 1/um per g/cm3 is m2/g.
    averages.push_back(
        {0.75 / recipe.density_g_cm3 * extinction / mass, scattering / extinction, forward / scattering});
  }
  return averages;
}

/// chi_l of values at Gauss-Legendre cosines, with the trailing ones that do not matter left out.
std::vector<double> legendre_moments(const GaussLegendre& rule, const Eigen::Ref<const Eigen::RowVectorXd>& value,
                                     int count) {
  const auto nodes = static_cast<int>(rule.node.size());
  std::vector<double> legendre(rule.node.size(), 1.0), next(rule.node.begin(), rule.node.end());
  std::vector<double> weighted(rule.node.size());
  for (int j = 0; j < nodes; ++j) weighted[j] = rule.weight[j] * value(j) / 2;
  std::vector<double> moments(count);
  for (int l = 0; l < count; ++l) {
    double sum = 0;
    for (int j = 0; j < nodes; ++j) {
      sum += weighted[j] * legendre[j];
      const double after = ((2 * l + 3) * rule.node[j] * next[j] - (l + 1) * legendre[j]) / (l + 2);
      legendre[j] = next[j];
      next[j] = after;
    }
    moments[l] = sum;
  }
  const double norm = moments[0];
  for (double& chi : moments) chi /= norm;
  int kept = count;
  while (kept > 2 && (2 * kept - 1) * std::abs(moments[kept - 1]) < last_moment) --kept;
  moments.resize(static_cast<std::size_t>(kept));
  return moments;
}

}  // namespace

DropletTable make_mie_table(const DropletRecipe& recipe, std::span<const double> radii,
                            const MieTableOptions& options) {
  check_recipe(recipe, radii);
  const ThreadScope threads(options.threads);
  const Sizes sizes = choose_sizes(recipe, radii, options.size_step);
  const auto count = static_cast<int>(sizes.radius_um.size());
  const double wave_number = 2 * std::numbers::pi / recipe.wavelength_um;
  // Intensities are polynomials of degree 2 terms; times P_l of as many degrees they are integrated exactly.
  const int degree = 2 * mie_term_count(sizes.radius_um.back() * wave_number);
  const GaussLegendre rule = make_gauss_legendre(degree + 1);
  const int tiles = (degree + angles_per_tile) / angles_per_tile;

  // Work grows as terms times angles a sphere.
  std::vector<double> work_before(static_cast<std::size_t>(count) + 1, 0.0);
  for (int n = 0; n < count; ++n)
    work_before[n + 1] = work_before[n] + mie_term_count(sizes.radius_um[n] * wave_number);

  Matrix intensity = Matrix::Zero(static_cast<Eigen::Index>(radii.size()), degree + 1);
  for (int first = 0; first < count; first += sizes_per_block) {
    const Block block = make_block(sizes, first, recipe);
    // A tile's sums do not depend on which thread makes them: the same bits for any number.
    ParallelErrors errors;
#pragma omp parallel for schedule(dynamic)
    for (int tile = 0; tile < tiles; ++tile) {
      errors.run([&] {
        const int begin = tile * angles_per_tile, angles = std::min(angles_per_tile, degree + 1 - begin);
        add_intensity(block, sizes, std::span(rule.node).subspan(begin, angles), intensity.middleCols(begin, angles));
      });
    }
    errors.rethrow();
    if (options.progress) options.progress(work_before[first + block.count] / work_before.back());
  }

  DropletTable table;
  table.wavelength_um = recipe.wavelength_um;
  table.effective_radius_um.assign(radii.begin(), radii.end());
  for (const BulkOptics& bulk :
       average_efficiencies(choose_sizes(recipe, radii, options.size_step / efficiency_steps), recipe)) {
    table.extinction_m2_per_g.push_back(bulk.extinction_m2_per_g);
    table.single_scattering_albedo.push_back(bulk.single_scattering_albedo);
  }
  for (Eigen::Index d = 0; d < intensity.rows(); ++d) {
    table.moments.push_back(legendre_moments(rule, intensity.row(d), degree + 1));
  }
  return table;
}

std::vector<BulkOptics> mie_bulk_optics(const DropletRecipe& recipe, std::span<const double> radii, double size_step,
                                        int threads) {
  check_recipe(recipe, radii);
  const ThreadScope scope(threads);
  return average_efficiencies(choose_sizes(recipe, radii, size_step), recipe);
}

}  // namespace cloudbow
