#include "cloudbow/app/mie_command.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "cloudbow/app/interrupt.hpp"
#include "cloudbow/app/progress.hpp"
#include "cloudbow/app/run.hpp"
#include "cloudbow/app/version.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/mie_table.hpp"
#include "cloudbow/optics/refractive_index.hpp"
#include "cloudbow/results/droplet_table_file.hpp"
#include "cloudbow/results/result_file.hpp"

namespace cloudbow {
namespace {

constexpr int kMaxRadii = 1000;

void print_table(const DropletTable& table) {
  fmt::print("{:>10} {:>14} {:>14} {:>10} {:>8}\n", "r_e [um]", "ext [m2/g]", "1 - albedo", "g", "moments");
  for (std::size_t n = 0; n < table.size(); ++n) {
    fmt::print("{:10.4g} {:14.6g} {:14.5g} {:10.6f} {:8}\n", table.effective_radius_um[n], table.extinction_m2_per_g[n],
               1 - table.single_scattering_albedo[n], table.moments[n][1], table.moments[n].size());
  }
}

}  // namespace

std::vector<double> parse_radii(const std::string& text) {
  const auto reject = [&text](const std::string& allowed) {
    throw InputError(fmt::format("--effective-radius-um: found '{}', allowed {}", text, allowed));
  };
  std::vector<double> number;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value) || value <= 0) reject("a radius > 0 or FROM:TO:STEP");
    number.push_back(value);
    at = next;
    if (at == end) break;
    if (*at != ':') reject("a radius > 0 or FROM:TO:STEP");
    ++at;
  }
  if (number.size() == 1) return number;
  if (number.size() != 3 || number[1] < number[0]) reject("a radius > 0 or FROM:TO:STEP with TO >= FROM");
  const double steps = std::floor((number[1] - number[0]) / number[2] * (1 + 1e-12) + 1e-9);
  if (steps >= kMaxRadii) reject(fmt::format("at most {} radii", kMaxRadii));
  std::vector<double> radii;
  for (int n = 0; n <= static_cast<int>(steps); ++n) radii.push_back(number[0] + n * number[2]);
  return radii;
}

int make_mie_file(const MieOptions& options) {
  const std::vector<double> radii = parse_radii(options.effective_radius_um);
  DropletRecipe recipe;
  DropletTableInfo info;
  recipe.wavelength_um = options.wavelength_um;
  recipe.distribution = options.distribution == "lognormal" ? DistributionKind::lognormal : DistributionKind::gamma;
  recipe.effective_variance = options.variance;
  if (options.refractive_index.empty()) {
    const Substance substance = options.substance == "ice" ? Substance::ice : Substance::water;
    recipe.refractive_index = refractive_index(substance, options.wavelength_um);
    recipe.density_g_cm3 = options.density_g_cm3.value_or(density_g_cm3(substance));
    info.refractive_index_source = refractive_index_source(substance);
  } else {
    recipe.refractive_index = {options.refractive_index[0], options.refractive_index[1]};
    recipe.density_g_cm3 = options.density_g_cm3.value_or(1);
    info.refractive_index_source = "given";
  }
  check_writable(options.output);

  const InterruptGuard guard;
  DropletTable table;
  {
    ProgressDisplay display(options.quiet, 1);
    MieTableOptions table_options;
    table_options.threads = options.threads;
    table_options.progress = [&display](double fraction) {
      InterruptGuard::check();
      SolverProgress progress;
      progress.phase = "mie";
      progress.fraction = fraction;
      display.show(progress);
    };
    table = make_mie_table(recipe, radii, table_options);
  }
  info.refractive_index = recipe.refractive_index;
  info.density_g_cm3 = recipe.density_g_cm3;
  info.distribution = distribution_name(recipe.distribution);
  info.effective_variance = recipe.effective_variance;
  info.source = fmt::format("cloudbow {}", version());
  info.history = options.command;
  write_droplet_table(options.output, table, info);
  InterruptGuard::check();
  if (!options.quiet) {
    fmt::print("refractive index {:.6g} + {:.4g} i ({})\n", recipe.refractive_index.real(),
               recipe.refractive_index.imag(), info.refractive_index_source);
    print_table(table);
    fmt::print("written to {}\n", options.output.string());
  }
  return kExitDone;
}

}  // namespace cloudbow
