#include "cloudbow/optics/mie_bulk.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/mie_table.hpp"
#include "table_cache.hpp"

namespace cloudbow {
namespace {

constexpr double cm1_um = 1e4;  // wavenumber [cm-1] times wavelength [um]

/// Step of size parameters. Narrow resonances that it misses average out over wavelengths: docs/formats.md.
constexpr double size_step = 1;

/// Density of wavelengths from one on, up to the next.
struct Spacing {
  double from_um;
  int per_decade;
};
constexpr std::array<Spacing, 3> spacings{{{shortest_index_wavelength, 24}, {.7, 200}, {5, 60}}};

constexpr Eigen::Index quantities = 3;  // columns of a cached table per radius

/// Everything that the table is made from, and a number that rises when its numerics change.
std::string key_of(const MieBulkRecipe& recipe, std::span<const double> wavelengths, std::span<const double> radii) {
  std::string key = fmt::format("mie bulk 1 step {} density {} {} {}", size_step, density_g_cm3(recipe.substance),
                                distribution_name(recipe.distribution), recipe.effective_variance);
  for (const double radius : radii) key += fmt::format(" r {}", radius);
  for (const double wavelength : wavelengths) {
    const auto index = refractive_index(recipe.substance, wavelength);
    key += fmt::format(" w {} {} {}", wavelength, index.real(), index.imag());
  }
  return key;
}

BulkTable empty_table(const MieBulkRecipe& recipe, std::span<const double> wavelengths, std::span<const double> radii) {
  BulkTable table;
  table.name = fmt::format("Mie table of {}", recipe.substance == Substance::water ? "water droplets" : "ice spheres");
  table.effective_radius_um.assign(radii.begin(), radii.end());
  for (auto wavelength = wavelengths.rbegin(); wavelength != wavelengths.rend(); ++wavelength) {
    table.wavenumber_cm1.push_back(cm1_um / *wavelength);
  }
  table.value.assign(wavelengths.size(), std::vector<BulkOptics>(radii.size()));
  return table;
}

FittedColumns as_columns(const BulkTable& table) {
  const auto radii = static_cast<Eigen::Index>(table.effective_radius_um.size());
  FittedColumns columns;
  columns.value.resize(static_cast<Eigen::Index>(table.value.size()), quantities * radii);
  for (Eigen::Index n = 0; n < columns.value.rows(); ++n) {
    for (Eigen::Index r = 0; r < radii; ++r) {
      const BulkOptics& optics = table.value[static_cast<std::size_t>(n)][static_cast<std::size_t>(r)];
      columns.value(n, quantities * r) = optics.extinction_m2_per_g;
      columns.value(n, quantities * r + 1) = optics.single_scattering_albedo;
      columns.value(n, quantities * r + 2) = optics.asymmetry;
    }
  }
  return columns;
}

/// False if the columns are those of another table.
bool take_columns(const FittedColumns& columns, BulkTable& table) {
  const auto radii = static_cast<Eigen::Index>(table.effective_radius_um.size());
  if (columns.value.rows() != static_cast<Eigen::Index>(table.value.size()) ||
      columns.value.cols() != quantities * radii) {
    return false;
  }
  for (Eigen::Index n = 0; n < columns.value.rows(); ++n) {
    for (Eigen::Index r = 0; r < radii; ++r) {
      table.value[static_cast<std::size_t>(n)][static_cast<std::size_t>(r)] = {
          columns.value(n, quantities * r), columns.value(n, quantities * r + 1), columns.value(n, quantities * r + 2)};
    }
  }
  return true;
}

}  // namespace

std::vector<double> mie_wavelengths(double shortest_um, double longest_um) {
  const double first = std::max(shortest_um, shortest_index_wavelength);
  const double last = std::min(longest_um, longest_index_wavelength);
  if (!(last > first)) {
    throw InputError(
        fmt::format("Mie table: no wavelengths (found {:.6g} to {:.6g} um, allowed a range in {} to {} um)",
                    shortest_um, longest_um, shortest_index_wavelength, longest_index_wavelength));
  }
  std::vector<double> wavelengths;
  for (std::size_t n = 0; n < spacings.size(); ++n) {
    const double begin = std::max(first, spacings[n].from_um);
    const double end = n + 1 < spacings.size() ? std::min(last, spacings[n + 1].from_um) : last;
    if (!(end > begin)) continue;
    // Rounding must not add a step to a whole number of them.
    const int steps = static_cast<int>(std::ceil(spacings[n].per_decade * std::log10(end / begin) - 1e-9));
    for (int step = 0; step < steps; ++step)
      wavelengths.push_back(begin * std::pow(end / begin, static_cast<double>(step) / steps));
  }
  wavelengths.push_back(last);
  return wavelengths;
}

BulkTable make_mie_bulk_table(const MieBulkRecipe& recipe, std::span<const double> wavelengths,
                              std::span<const double> radii, const MieBulkOptions& options) {
  if (wavelengths.empty()) throw InputError("Mie table: no wavelengths (found 0, allowed at least one)");
  BulkTable table = empty_table(recipe, wavelengths, radii);
  const TableCache cache(options.cache_directory, key_of(recipe, wavelengths, radii));
  if (const std::optional<FittedColumns> cached = cache.load(); cached && take_columns(*cached, table)) {
    check_bulk_table(table);
    return table;
  }
  for (std::size_t n = 0; n < wavelengths.size(); ++n) {
    DropletRecipe droplets;
    droplets.wavelength_um = wavelengths[n];
    droplets.refractive_index = refractive_index(recipe.substance, wavelengths[n]);
    droplets.density_g_cm3 = density_g_cm3(recipe.substance);
    droplets.distribution = recipe.distribution;
    droplets.effective_variance = recipe.effective_variance;
    table.value[wavelengths.size() - 1 - n] = mie_bulk_optics(droplets, radii, size_step, options.threads);
  }
  check_bulk_table(table);
  cache.store(as_columns(table));
  return table;
}

}  // namespace cloudbow
