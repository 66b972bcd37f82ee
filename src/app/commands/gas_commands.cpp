#include "app/commands/gas_commands.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "app/commands/command_checks.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/history.hpp"
#include "app/process/version.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/number_text.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/io/gas_optics_file.hpp"
#include "cloudbow/medium/atmosphere.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/optics/planck.hpp"

namespace cloudbow {
namespace {

constexpr double usual_ground_k = 288;  // temperature of the Planck shares that are printed

bool is_solar(const GasModel& model) { return model.light() == GasModel::Light::solar; }

/// Shares of the g-points in the sun's irradiance or, in the longwave, in what a black body emits.
std::vector<double> shares_of_light(const GasModel& model) {
  std::vector<double> share;
  double sum = 0;
  for (int g = 0; g < model.points(); ++g) {
    share.push_back(is_solar(model) ? model.solar_share(g) : model.planck(g, usual_ground_k));
    sum += share.back();
  }
  for (double& of_point : share) of_point /= sum > 0 ? sum : 1;
  return share;
}

/// Mean wavenumber [cm-1] of the light at a g-point.
double mean_wavenumber(const GasModel& model, int point) {
  const GasModel::Spectrum& spectrum = model.spectrum();
  constexpr double um_per_cm = 1e4;
  double sum = 0, weighted = 0;
  for (std::size_t i = 0; i < spectrum.lower.size(); ++i) {
    const double middle = (spectrum.lower[i] + spectrum.upper[i]) / 2;
    const double light = is_solar(model) ? spectrum.solar[i]
                                         : PlanckFunction::at(um_per_cm / middle)(usual_ground_k) / (middle * middle) *
                                               (spectrum.upper[i] - spectrum.lower[i]);
    const double weight = model.share_of_interval(point, i) * light;
    sum += weight;
    weighted += weight * middle;
  }
  return sum > 0 ? weighted / sum : 0;
}

int describe_model(const std::filesystem::path& file) {
  const std::unique_ptr<GasModel> model = read_gas_model(file);
  const GasModel::Spectrum& spectrum = model->spectrum();
  fmt::print("{}: ecCKD gas model, {}\n", file.string(), is_solar(*model) ? "solar" : "longwave");
  fmt::print("g-points: {}\n", model->points());
  fmt::print("gases by height: {}\n", printable(joined(model->gases())));
  fmt::print("spectrum: {:g} to {:g} cm-1 in {} intervals\n", spectrum.lower.front(), spectrum.upper.back(),
             spectrum.lower.size());
  fmt::print("{:>8} {:>12} {:>14}\n", "g-point", "share [%]", "mean [cm-1]");
  const std::vector<double> share = shares_of_light(*model);
  for (int g = 0; g < model->points(); ++g)
    fmt::print("{:8} {:12.4f} {:14.0f}\n", g, 100 * share[static_cast<std::size_t>(g)], mean_wavenumber(*model, g));
  fmt::print("{}\n", is_solar(*model) ? "share: of the total solar irradiance"
                                      : fmt::format("share: of black-body emission at {:g} K", usual_ground_k));
  return exit_done;
}

struct OpticsOptions {
  std::filesystem::path atmosphere, model, output;
  std::vector<std::string> mole_fractions;
  std::vector<double> heights_m;
  bool quiet = false;
  std::string command;
};

/// Sets gases that do not vary with height, from words such as "co2=420e-6".
void set_mole_fractions(Atmosphere& air, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    const auto number = sign == std::string::npos ? std::nullopt : number_in(std::string_view(word).substr(sign + 1));
    if (sign == 0 || !number || !(*number >= 0 && *number <= 1)) {
      throw InputError(
          fmt::format("--mole-fraction: no gas with its mole fraction (found '{}', allowed GAS=X with X "
                      "from 0 to 1, as in co2=420e-6)",
                      word));
    }
    air.mole_fraction[word.substr(0, sign)].assign(air.height_m.size(), *number);
  }
}

std::vector<double> edges_of(const OpticsOptions& options, const Atmosphere& air) {
  const std::vector<double>& given = options.heights_m;
  if (given.empty()) return air.height_m;
  if (given.size() < 2)
    throw InputError(fmt::format("--heights-m: too few (found {}, allowed two or more)", given.size()));
  for (std::size_t n = 1; n < given.size(); ++n) {
    if (given[n] > given[n - 1]) continue;
    throw InputError(fmt::format("--heights-m: not in order (found {} after {}, allowed ascending heights); sort them",
                                 given[n], given[n - 1]));
  }
  return given;
}

void print_depths(const GasModel& model, const GasOpticsData& data) {
  const auto sum = [](const std::vector<double>& layers) {
    double total = 0;
    for (const double depth : layers) total += depth;
    return total;
  };
  const std::vector<double> share = shares_of_light(model);
  fmt::print("{:>8} {:>12} {:>14}{}\n", "g-point", "share [%]", "absorption",
             is_solar(model) ? fmt::format(" {:>14}", "rayleigh") : "");
  for (std::size_t g = 0; g < share.size(); ++g) {
    fmt::print("{:8} {:12.4f} {:14.6g}{}\n", g, 100 * share[g], sum(data.optics.absorption[g]),
               is_solar(model) ? fmt::format(" {:14.6g}", sum(data.optics.rayleigh[g])) : "");
  }
}

int write_optics(const OpticsOptions& options) {
  const std::array<std::filesystem::path, 2> inputs{options.atmosphere, options.model};
  check_outputs({{options.output, "the optics", OutputKind::hdf5}}, inputs);
  Atmosphere air = read_atmosphere(options.atmosphere);
  set_mole_fractions(air, options.mole_fractions);
  const std::unique_ptr<GasModel> model = read_gas_model(options.model);

  GasOpticsData data;
  data.light = model->light();
  data.height_m = edges_of(options, air);
  try {
    data.optics = gas_optics(*model, air, data.height_m);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}; --mole-fraction GAS=X gives one", options.atmosphere.string(), error.what()));
  }
  for (const double height : data.height_m) {
    data.pressure_pa.push_back(air.pressure_at(height));
    data.temperature_k.push_back(air.temperature_at(height));
  }
  for (int g = 0; g < model->points(); ++g) {
    if (is_solar(*model)) {
      data.solar_share.push_back(model->solar_share(g));
      continue;
    }
    std::vector<double>& row = data.planck.emplace_back();
    for (const double kelvin : data.temperature_k) row.push_back(model->planck(g, kelvin));
  }
  data.source = fmt::format("cloudbow {}", version());
  data.history = history_line(options.command);
  write_gas_optics(options.output, data);
  if (options.quiet) return exit_done;
  fmt::print("{}, {} g-points, {} layers from {:g} to {:g} m; optical depths of all layers:\n",
             is_solar(*model) ? "solar" : "longwave", model->points(), data.height_m.size() - 1, data.height_m.front(),
             data.height_m.back());
  print_depths(*model, data);
  fmt::print("written to {}\n", options.output.string());
  return exit_done;
}

void add_info(CLI::App& gas_app, std::function<int()>& action) {
  auto file = std::make_shared<std::filesystem::path>();
  CLI::App* info_app = gas_app.add_subcommand("info", "Describe a gas model: its g-points, gases and spectrum");
  info_app->add_option("model", *file, "Gas model: ecCKD definition file (netCDF)")->type_name("FILE")->required();
  info_app->callback([&action, file] { action = [file] { return describe_model(*file); }; });
}

void add_optics(CLI::App& gas_app, std::function<int()>& action, const std::string& command) {
  auto options = std::make_shared<OpticsOptions>();
  options->command = command;
  CLI::App* app = gas_app.add_subcommand("optics", "Compute optical depths of the air by layer and g-point");
  app->add_option("atmosphere", options->atmosphere, "Profile of the air: text columns or netCDF")
      ->type_name("FILE")
      ->required();
  app->add_option("--model", options->model, "Gas model: ecCKD definition file (netCDF)")
      ->type_name("FILE")
      ->required();
  app->add_option("--mole-fraction", options->mole_fractions,
                  "A gas that is the same at all heights, as in --mole-fraction co2=420e-6; repeatable")
      ->type_name("GAS=X")
      ->allow_extra_args(false);
  app->add_option("--heights-m", options->heights_m, "Interfaces of the layers [m] (default: heights of the profile)")
      ->check(finite_number(std::numeric_limits<double>::lowest(), "a finite number"));
  app->add_flag("--quiet", options->quiet, "Print errors alone");
  app->add_option("-o,--output", options->output, "HDF5 file, also netCDF-4")->type_name("FILE")->required();
  app->callback([&action, options] { action = [options] { return write_optics(*options); }; });
}

}  // namespace

void add_gas(CLI::App& app, std::function<int()>& action, const std::string& command) {
  CLI::App* gas_app = app.add_subcommand("gas", "Gas models: describe them, compute the optics of the air");
  gas_app->require_subcommand(1);
  add_info(*gas_app, action);
  add_optics(*gas_app, action, command);
}

}  // namespace cloudbow
