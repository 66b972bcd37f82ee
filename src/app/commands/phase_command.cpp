#include "app/commands/phase_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include "app/commands/phase_options.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/history.hpp"
#include "app/process/messages.hpp"
#include "app/process/version.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/io/phase_file.hpp"
#include "cloudbow/io/phase_function_file.hpp"
#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/plots/phase_plot.hpp"
#include "cloudbow/sphere/scaled_vector.hpp"

namespace cloudbow {
namespace {

constexpr int most_delta_m_order = 64;
constexpr std::array<const char*, 6> types = {"isotropic", "rayleigh", "henyey-greenstein", "double-henyey-greenstein",
                                              "legendre",  "table"};

template <class Value>
Value required(const std::optional<Value>& value, const char* option, const PhaseOptions& options) {
  if (!value) throw InputError(fmt::format("phase {}: {} is missing", options.type, option));
  return *value;
}

/// An option that says nothing about this type is a mistake.
void check_options_of_type(const PhaseOptions& options) {
  const auto check = [&options](bool given, const char* option, const char* type) {
    if (given && options.type != type)
      throw InputError(fmt::format("phase {}: {} belongs to {} alone", options.type, option, type));
  };
  check(options.asymmetry_parameter.has_value(), "--asymmetry-parameter", "henyey-greenstein");
  check(options.forward_asymmetry_parameter.has_value(), "--forward-asymmetry-parameter", "double-henyey-greenstein");
  check(options.backward_asymmetry_parameter.has_value(), "--backward-asymmetry-parameter", "double-henyey-greenstein");
  check(options.forward_weight.has_value(), "--forward-weight", "double-henyey-greenstein");
  if (options.file && options.type != "legendre" && options.type != "table")
    throw InputError(fmt::format("phase {}: --file belongs to legendre and table alone", options.type));
}

struct NamedFunction {
  PhaseFunction function;
  std::string title;
};

NamedFunction make_phase_function(const PhaseOptions& options) {
  if (std::find(types.begin(), types.end(), options.type) == types.end()) {
    throw InputError(
        fmt::format("phase: unknown type (found \"{}\", allowed {})", options.type, fmt::join(types, ", ")));
  }
  check_options_of_type(options);
  if (options.type == "isotropic") return {PhaseFunction::isotropic(), options.type};
  if (options.type == "rayleigh") return {PhaseFunction::rayleigh(), options.type};
  if (options.type == "henyey-greenstein") {
    const double g = required(options.asymmetry_parameter, "--asymmetry-parameter", options);
    return {PhaseFunction::henyey_greenstein(g), fmt::format("henyey-greenstein, asymmetry parameter {}", g)};
  }
  if (options.type == "double-henyey-greenstein") {
    const double forward = required(options.forward_asymmetry_parameter, "--forward-asymmetry-parameter", options);
    const double backward = required(options.backward_asymmetry_parameter, "--backward-asymmetry-parameter", options);
    const double weight = required(options.forward_weight, "--forward-weight", options);
    return {
        PhaseFunction::double_henyey_greenstein(forward, backward, weight),
        fmt::format("double-henyey-greenstein, asymmetry parameters {} (weight {}) and {}", forward, weight, backward)};
  }
  const std::filesystem::path file = required(options.file, "--file", options);
  const std::string title = fmt::format("{}, {}", options.type, file.filename().string());
  PhaseFunctionFile read = options.type == "legendre" ? read_legendre_file(file) : read_phase_table_file(file);
  for (const std::string& note : read.notes) tell("cloudbow: {}: {}\n", file.string(), note);
  return {std::move(read.function), title};
}

/// The ordinates that the solver takes with so many control points.
std::string usual_ordinates(int control_points) {
  switch (control_points) {
    case 12:
      return "double-gauss-4x8";
    case 42:
      return "double-gauss-6x8";
    case 642:
      return "double-gauss-18x36";
    default:
      return "double-gauss-8x16";
  }
}

}  // namespace

int phase(const PhaseOptions& options) {
  const auto [function, title] = make_phase_function(options);
  if (options.delta_m_order < 1 || options.delta_m_order > most_delta_m_order) {
    throw InputError(
        fmt::format("phase: delta-M order is {} (allowed: 1 to {})", options.delta_m_order, most_delta_m_order));
  }
  std::vector<PhaseFitMethod> methods;
  for (const std::string& name : options.fits.empty() ? phase_fit_names() : options.fits) {
    methods.push_back(phase_fit_method(name));
  }
  PhaseFitOptions fit = options.fit;
  if (!options.travel.empty())
    fit.travel = scaled_to_order_one({options.travel[0], options.travel[1], options.travel[2]});
  if (!fit.travel.allFinite()) throw InputError("phase: --travel is not a direction (allowed: three finite numbers)");
  const ControlPoints points(options.control_points);
  const OrdinateSet ordinates =
      make_ordinate_set(options.ordinates.empty() ? usual_ordinates(points.size()) : options.ordinates);
  const std::filesystem::path input = options.file.value_or("");
  check_outputs(
      {{options.plot, "the plot", OutputKind::plot}, {options.output, "the file of all figures", OutputKind::hdf5}},
      std::span(&input, 1));

  const DeltaM scaled = delta_m(function, options.delta_m_order);
  PhaseReport report{title, options.delta_m_order, scaled.forward_fraction, points, ordinates.name, fit, {}};
  report.functions.push_back({"raw", function, fit_phase_function(function, points, ordinates, methods, fit)});
  if (scaled.forward_fraction > 0) {
    report.functions.push_back(
        {"delta-M", scaled.truncated, fit_phase_function(scaled.truncated, points, ordinates, methods, fit)});
  }
  if (!options.plot.empty()) write_phase_plot(options.plot, report);
  if (!options.output.empty()) {
    write_phase_file(options.output, report, fmt::format("cloudbow {}", version()), history_line(options.command));
  }
  if (!options.quiet) fmt::print("{}", phase_table(report));
  return exit_done;
}

void add_phase(CLI::App& app, std::function<int()>& action, const std::string& command) {
  auto options = std::make_shared<PhaseOptions>();
  options->command = command;
  CLI::App* phase_app =
      app.add_subcommand("phase", "A phase function: moments, asymmetry, its fits to control points and their errors");
  phase_app->add_option("type", options->type, fmt::format("{}", fmt::join(types, ", ")))->required();
  phase_app->add_option("--asymmetry-parameter", options->asymmetry_parameter, "henyey-greenstein: -1 < g < 1");
  phase_app->add_option("--forward-asymmetry-parameter", options->forward_asymmetry_parameter,
                        "double-henyey-greenstein: -1 < g < 1");
  phase_app->add_option("--backward-asymmetry-parameter", options->backward_asymmetry_parameter,
                        "double-henyey-greenstein: -1 < g < 1");
  phase_app->add_option("--forward-weight", options->forward_weight, "double-henyey-greenstein: 0 to 1");
  phase_app
      ->add_option("--file", options->file,
                   "legendre: lines \"l chi_l\" without the factor 2l+1; table: lines \"angle_deg value\", of mean 1")
      ->type_name("FILE");
  phase_app->add_option("--control-points", options->control_points, "12, 42, 162 or 642")->capture_default_str();
  phase_app->add_option("--delta-m-order", options->delta_m_order, "Moments kept by the truncation, 1 to 64")
      ->capture_default_str();
  phase_app
      ->add_option("--fit", options->fits,
                   fmt::format("Fits to make, of {} (default: all)", fmt::join(phase_fit_names(), ", ")))
      ->delimiter(',')
      ->allow_extra_args(false);
  phase_app
      ->add_option("--exact-moments", options->fit.exact_moments,
                   "Moments l up to this are held exactly by linear-programming...")
      ->capture_default_str();
  phase_app->add_option("--quadrature", options->ordinates,
                        "Ordinate set whose quadrature holds them (default: the solver's for so many control points)");
  phase_app->add_option("--travel", options->travel, "Direction x y z in which the arriving light travels")
      ->expected(3);
  phase_app->add_option("--plot", options->plot, "Picture of the function and its fits (PNG, SVG, PDF)")
      ->type_name("FILE");
  phase_app->add_option("-o,--output", options->output, "All figures (HDF5)")->type_name("FILE");
  phase_app->callback([&action, options] { action = [options] { return phase(*options); }; });
}

}  // namespace cloudbow
