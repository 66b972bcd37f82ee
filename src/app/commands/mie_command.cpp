#include "app/commands/mie_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "app/process/exit_codes.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/progress.hpp"
#include "app/process/version.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "cloudbow/optics/mie_table.hpp"
#include "cloudbow/optics/refractive_index.hpp"

namespace cloudbow {
namespace {

constexpr int max_steps = 1000;

void print_table(const DropletTable& table) {
  fmt::print("{:>10} {:>14} {:>14} {:>10} {:>8}\n", "r_e [um]", "ext [m2/g]", "1 - albedo", "g", "moments");
  for (std::size_t n = 0; n < table.size(); ++n) {
    fmt::print("{:10.4g} {:14.6g} {:14.5g} {:10.6f} {:8}\n", table.effective_radius_um[n], table.extinction_m2_per_g[n],
               1 - table.single_scattering_albedo[n], table.moments[n][1], table.moments[n].size());
  }
}

std::vector<double> parse_wavelengths(const std::vector<std::string>& texts) {
  std::vector<double> all;
  for (const std::string& text : texts) {
    for (const double wavelength : parse_steps("--wavelength-um", text)) {
      if (std::find(all.begin(), all.end(), wavelength) != all.end())
        throw InputError(fmt::format("--wavelength-um: found {} twice, allowed each once", wavelength));
      all.push_back(wavelength);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

Substance substance_of(const MieOptions& options) {
  return options.substance == "ice" ? Substance::ice : Substance::water;
}

DropletRecipe make_recipe(const MieOptions& options, double wavelength_um) {
  DropletRecipe recipe;
  recipe.wavelength_um = wavelength_um;
  recipe.distribution = options.distribution == "lognormal" ? DistributionKind::lognormal : DistributionKind::gamma;
  recipe.effective_variance = options.variance;
  if (options.refractive_index.empty()) {
    recipe.refractive_index = refractive_index(substance_of(options), wavelength_um);
    recipe.density_g_cm3 = options.density_g_cm3.value_or(density_g_cm3(substance_of(options)));
  } else {
    recipe.refractive_index = {options.refractive_index[0], options.refractive_index[1]};
    recipe.density_g_cm3 = options.density_g_cm3.value_or(1);
  }
  return recipe;
}

DropletTableInfo make_info(const MieOptions& options, const DropletRecipe& recipe) {
  DropletTableInfo info;
  info.refractive_index = recipe.refractive_index;
  info.refractive_index_source =
      options.refractive_index.empty() ? refractive_index_source(substance_of(options)) : "given";
  info.density_g_cm3 = recipe.density_g_cm3;
  info.distribution = distribution_name(recipe.distribution);
  info.effective_variance = recipe.effective_variance;
  info.source = fmt::format("cloudbow {}", version());
  info.history = options.command;
  return info;
}

}  // namespace

std::vector<double> parse_steps(const std::string& option, const std::string& text) {
  const auto reject = [&](const std::string& allowed) {
    throw InputError(fmt::format("{}: found '{}', allowed {}", option, text, allowed));
  };
  std::vector<double> number;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value) || value <= 0) reject("a number > 0 or FROM:TO:STEP");
    number.push_back(value);
    at = next;
    if (at == end) break;
    if (*at != ':') reject("a number > 0 or FROM:TO:STEP");
    ++at;
  }
  if (number.size() == 1) return number;
  if (number.size() != 3 || number[1] < number[0]) reject("a number > 0 or FROM:TO:STEP with TO >= FROM");
  const double steps = std::floor((number[1] - number[0]) / number[2] * (1 + 1e-12) + 1e-9);
  if (steps >= max_steps) reject(fmt::format("at most {} numbers", max_steps));
  std::vector<double> values;
  for (int n = 0; n <= static_cast<int>(steps); ++n) values.push_back(number[0] + n * number[2]);
  return values;
}

int make_mie_file(const MieOptions& options) {
  const std::vector<double> radii = parse_steps("--effective-radius-um", options.effective_radius_um);
  const std::vector<double> wavelengths = parse_wavelengths(options.wavelength_um);
  std::vector<DropletRecipe> recipes;
  for (const double wavelength : wavelengths) recipes.push_back(make_recipe(options, wavelength));
  check_outputs({{options.output, "the table", OutputKind::hdf5}});

  const InterruptGuard guard;
  std::vector<DropletTable> tables;
  std::vector<DropletTableInfo> infos;
  {
    RunClock clock({1.});
    ProgressDisplay display(options.quiet, 1, &clock);
    for (const DropletRecipe& recipe : recipes) {
      MieTableOptions table_options;
      table_options.threads = options.threads;
      const double done = static_cast<double>(tables.size());
      table_options.progress = [&](double fraction) {
        InterruptGuard::check();
        SolverProgress progress;
        progress.phase = "mie";
        progress.fraction = (done + fraction) / static_cast<double>(recipes.size());
        display.show(progress);
      };
      tables.push_back(make_mie_table(recipe, radii, table_options));
      infos.push_back(make_info(options, recipe));
    }
  }
  write_droplet_tables(options.output, tables, infos);
  InterruptGuard::check();
  if (!options.quiet) {
    for (std::size_t n = 0; n < tables.size(); ++n) {
      if (tables.size() > 1) fmt::print("{}wavelength {} um\n", n == 0 ? "" : "\n", wavelengths[n]);
      fmt::print("refractive index {:.6g} + {:.4g} i ({})\n", infos[n].refractive_index.real(),
                 infos[n].refractive_index.imag(), infos[n].refractive_index_source);
      print_table(tables[n]);
    }
    fmt::print("written to {}\n", options.output.string());
  }
  return exit_done;
}

}  // namespace cloudbow
