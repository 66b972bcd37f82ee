#include "app/commands/cloud_commands.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "app/commands/command_checks.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/messages.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/io/phase_set_file.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/plots/column_plot.hpp"

namespace cloudbow {
namespace {

void add_cloud_make(CLI::App& cloud_app, std::function<int()>& action) {
  struct Options {
    CloudMakerOptions maker;
    std::vector<int> cells;
    std::vector<double> voxel_size_m;
    VdbWriteOptions write;
    std::filesystem::path output;
  };
  auto options = std::make_shared<Options>();
  CLI::App* make_app = cloud_app.add_subcommand("make", "Make a cloud field from parameters and a seed");
  make_app->add_option("kind", options->maker.kind, joined(cloud_maker_kinds()))->required();
  make_app->add_option("--cells", options->cells, "Cells of the domain along x, y, z")
      ->required()
      ->expected(3)
      ->check(whole_number(1, 100000));
  make_app->add_option("--voxel-size-m", options->voxel_size_m, "Size of a cell along x, y, z [m]")
      ->required()
      ->expected(3)
      ->check(finite_number(0, "a number > 0"));
  make_app->add_option("--optical-depth", options->maker.optical_depth, "Mean over cloudy columns (default: by kind)")
      ->check(finite_number(0, "a number > 0"));
  make_app->add_option("--cover", options->maker.cover, "Fraction of cloudy columns; cumulus and stratocumulus")
      ->check(finite_number(0, "0 to 1"));
  make_app->add_option("--base-m", options->maker.base_m, "Height of the cloud base [m]")
      ->check(finite_number(0, "a height >= 0"));
  make_app->add_option("--seed", options->maker.seed, "Seed of the random numbers")
      ->capture_default_str()
      ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()));
  make_app->add_flag("--half", options->write.half, "Store 16 bits a value: half the size");
  make_app->add_option("-o,--output", options->output, "VDB file")->type_name("FILE")->required();
  make_app->callback([&action, options] {
    action = [options] {
      std::copy(options->cells.begin(), options->cells.end(), options->maker.cells.begin());
      std::copy(options->voxel_size_m.begin(), options->voxel_size_m.end(), options->maker.voxel_size_m.begin());
      check_outputs({{options->output, "the cloud", OutputKind::vdb}});
      write_cloud_vdb(options->output, make_cloud(options->maker), options->write);
      fmt::print("{}", format_cloud_info(describe_cloud_vdb(options->output)));
      return exit_done;
    };
  });
}

/// Variables that CLI11 fills; optional triples and pairs as lists.
struct ImportCommand {
  CloudImportOptions import;
  std::vector<double> voxel_size_m;
  std::vector<int> columns;
  std::filesystem::path phase_functions;
  std::string moment_factor = "auto";
  VdbWriteOptions write;
  std::filesystem::path output;
  bool quiet = false;
};

/// Options that count in some formats alone.
struct OptionOfFormats {
  const char* name;
  std::vector<std::string> formats;
};

const std::vector<OptionOfFormats>& options_of_formats() {
  const std::vector<std::string> les{"les"};
  static const std::vector<OptionOfFormats> options{{"--columns", {"columns", "optics-csv"}},
                                                    {"--quantity", {"les", "columns", "numpy"}},
                                                    {"--phase-functions", {"shdom", "optics-csv"}},
                                                    {"--variable", les},
                                                    {"--units", les},
                                                    {"--time", les},
                                                    {"--x-axis", les},
                                                    {"--y-axis", les},
                                                    {"--z-axis", les},
                                                    {"--time-axis", les},
                                                    {"--air-density", les},
                                                    {"--pressure", les},
                                                    {"--temperature", les},
                                                    {"--temperature-grid", les},
                                                    {"--fill", les},
                                                    {"--droplet-number", les},
                                                    {"--droplet-number-cm3", les},
                                                    {"--radius-ratio-cubed", les},
                                                    {"--effective-radius", les}};
  return options;
}

void check_options_of_format(const CLI::App& app, const CloudImportOptions& import, const std::string& format) {
  for (const OptionOfFormats& option : options_of_formats()) {
    if (app.get_option(option.name)->count() == 0 || std::ranges::count(option.formats, format) > 0) continue;
    throw InputError(fmt::format("{}: no option of this format (found {} to be of the format {}, allowed {}){}",
                                 option.name, import.file.string(), format, joined(option.formats),
                                 import.format == "auto" ? "; --format says another" : ""));
  }
}

/// "cloud.vdb" has its phase functions in "cloud.phase.csv".
std::filesystem::path phase_set_beside(std::filesystem::path output) { return output.replace_extension(".phase.csv"); }

/// Phase functions of the file given, or those in the cloud's own file.
std::vector<std::vector<double>> phase_functions_of(const ImportCommand& command, ImportedCloud& cloud) {
  if (command.phase_functions.empty()) {
    for (std::size_t p = 0; p < cloud.moments.size(); ++p) {
      try {
        check_not_negative(cloud.moments[p]);
      } catch (const InputError& error) {
        throw InputError(fmt::format("{}: function {}: {}", command.import.file.string(), p + 1, error.what()));
      }
    }
    return std::move(cloud.moments);
  }
  const MomentFactor factor = command.moment_factor == "included"   ? MomentFactor::included
                              : command.moment_factor == "excluded" ? MomentFactor::excluded
                                                                    : MomentFactor::automatic;
  PhaseSetFile set = read_phase_set_file(command.phase_functions, factor);
  cloud.notes.push_back(fmt::format("phase functions: {} in {}, moments {} the factor 2l+1{}", set.moments.size(),
                                    command.phase_functions.string(), set.factor_was_included ? "with" : "without",
                                    factor == MomentFactor::automatic ? " (GUESSED by their size)" : ""));
  if (!set.note.empty()) cloud.notes.push_back(set.note);
  return std::move(set.moments);
}

void check_indices(const ImportedCloud& cloud, std::size_t functions) {
  for (const VdbAuxiliary& auxiliary : cloud.auxiliaries) {
    if (auxiliary.grid != "phase_index") continue;
    for (const float index : auxiliary.value) {
      if (index > static_cast<float>(functions)) {
        throw InputError(
            fmt::format("--phase-functions: too few functions (found {}, allowed at least {}, which a cell has)",
                        functions, index));
      }
    }
  }
}

int import_to_vdb(const CLI::App& app, const ImportCommand& command) {
  CloudImportOptions options = command.import;
  if (!command.voxel_size_m.empty()) {
    const std::vector<double>& size = command.voxel_size_m;
    if (size.size() == 2) throw InputError("--voxel-size-m: two numbers (allowed: one for all axes, or three)");
    options.voxel_size_m = {size[0], size.size() > 1 ? size[1] : size[0], size.size() > 1 ? size[2] : size[0]};
    options.levels_by_voxel_size = size.size() == 3;
    for (const double length : *options.voxel_size_m) {
      if (!(length > 0)) throw InputError(fmt::format("--voxel-size-m: {} (allowed: > 0)", length));
    }
  }
  if (!command.columns.empty()) options.columns = {command.columns[0], command.columns[1]};
  const std::array<std::filesystem::path, 2> inputs{options.file, command.phase_functions};
  const std::array<OutputFile, 2> outputs{
      OutputFile{command.output, "the cloud", OutputKind::vdb},
      OutputFile{phase_set_beside(command.output), "its phase functions", OutputKind::csv}};
  check_distinct(outputs, inputs);
  check_writable(command.output);
  options.format = cloud_import_format(options);
  check_options_of_format(app, command.import, options.format);

  ImportedCloud cloud = import_cloud(options);
  const auto moments = phase_functions_of(command, cloud);
  if (!moments.empty()) {
    check_indices(cloud, moments.size());
    write_phase_set_file(phase_set_beside(command.output), moments);
    cloud.notes.push_back(fmt::format("phase functions: written to {}, for [phase_function.NAME] type = \"set\"",
                                      phase_set_beside(command.output).string()));
  }
  write_cloud_vdb(command.output, cloud.field, command.write, cloud.auxiliaries);
  if (command.quiet) return exit_done;
  for (const std::string& note : cloud.notes) fmt::print("{}\n", printable(note));
  fmt::print("{}", format_cloud_info(describe_cloud_vdb(command.output)));
  return exit_done;
}

void add_cloud_import(CLI::App& cloud_app, std::function<int()>& action) {
  auto command = std::make_shared<ImportCommand>();
  CloudImportOptions& options = command->import;
  CLI::App* app = cloud_app.add_subcommand("import", "Bring in a cloud that somebody else simulated");
  app->add_option("file", options.file, "LES output (netCDF), SHDOM property or LWC file, text, or NumPy array")
      ->type_name("FILE")
      ->required();
  app->add_option("-o,--output", command->output, "VDB file; phase functions go beside it, to NAME.phase.csv")
      ->type_name("FILE")
      ->required();
  app->add_option("--format", options.format, joined(cloud_import_formats()))
      ->capture_default_str()
      ->check(CLI::IsMember(cloud_import_formats()));
  app->add_option("--voxel-size-m", command->voxel_size_m,
                  "Size of a cell along x, y, z [m], instead of the file's; one number: of columns, and of levels if "
                  "the file does not say them")
      ->expected(1, 3)
      ->check(finite_number(0, "a number > 0"));
  app->add_option("--columns", command->columns, "Text: columns of the domain along x, y")
      ->expected(2)
      ->check(whole_number(1, 1000000));
  app->add_option("--vertical-size-m", options.vertical_size_m,
                  "Height of the uniform cells (default: of the thinnest level with cloud)")
      ->check(finite_number(0, "a number > 0"));
  app->add_option("--minimum", options.minimum, "Cells with less count as clear air [g/m3 or 1/m]")
      ->capture_default_str()
      ->check(finite_number(0, "a number >= 0"));
  app->add_option("--quantity", options.quantity,
                  "Text columns: extinction [1/m] (default) or liquid_water_content [g/m3]. LES: which of them")
      ->check(CLI::IsMember({"extinction", "liquid_water_content"}));
  auto* moments = app->add_option("--phase-functions", command->phase_functions,
                                  "SHDOM, text with optics: Legendre moments, one column a phase function")
                      ->type_name("MOMENTS");
  app->add_option("--moment-factor", command->moment_factor,
                  "Whether they hold the factor 2l+1: auto, included, excluded")
      ->needs(moments)
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "included", "excluded"}));
  app->add_option("--variable", options.variable, "LES: liquid water (default: a usual name)");
  app->add_option("--units", options.units,
                  "LES: of that variable, instead of the file's: kg/kg, g/kg, kg/m3, g/m3, 1/m, 1/km");
  app->add_option("--time", options.time, "LES: index on the time axis, from 0")
      ->capture_default_str()
      ->check(whole_number(0, 1000000000));
  const std::array<const char*, 4> axis{"x", "y", "z", "time"};
  for (std::size_t a = 0; a < axis.size(); ++a) {
    app->add_option(fmt::format("--{}-axis", axis[a]), options.axes[a],
                    fmt::format("LES: dimension that is {}", axis[a]));
  }
  app->add_option("--air-density", options.air_density,
                  "LES: air density, a variable or a number [kg/m3] or us-1976 (the standard atmosphere)");
  app->add_option("--pressure", options.pressure, "LES: pressure, with temperature in place of air density");
  app->add_option("--temperature", options.temperature, "LES: temperature, or potential temperature");
  app->add_flag("--temperature-grid", options.temperature_grid,
                "LES: bring the temperature too, as a grid of the same voxels, for thermal emission");
  app->add_option("--fill", options.fill, "LES: cells with missing water are an error, or clear air")
      ->capture_default_str()
      ->check(CLI::IsMember({"error", "clear"}));
  app->add_option("--droplet-number", options.droplet_number,
                  "LES: droplet number, from which the effective radius comes");
  app->add_option("--droplet-number-cm3", options.droplet_number_cm3, "LES: the same number of droplets everywhere")
      ->check(finite_number(0, "a number > 0"));
  app->add_option("--radius-ratio-cubed", options.radius_ratio_cubed,
                  "LES: (volume radius / effective radius)^3 of the droplets")
      ->capture_default_str()
      ->check(finite_number(1e-3, "a number above 0"));
  app->add_option("--effective-radius", options.effective_radius, "LES: effective radius");
  app->add_flag("--half", command->write.half, "Store the cloud with 16 bits a value");
  app->add_flag("--quiet", command->quiet, "Nothing but errors");
  app->callback([&action, app, command] { action = [app, command] { return import_to_vdb(*app, *command); }; });
}

void plot_columns(const std::filesystem::path& file, const std::filesystem::path& image) {
  const VdbCloud field = read_cloud_vdb(file);
  ColumnPlot plot;
  plot.title = file.filename().string();
  plot.label = column_integral_name(field.quantity, field.units);
  if (const auto unit = plot.label.find("m2]"); unit != std::string::npos) plot.label.replace(unit, 2, "m^{2}");
  plot.columns = {field.cells[0], field.cells[1]};
  plot.column_size_m = {field.cell_size_m[0], field.cell_size_m[1]};
  plot.min_m = {field.min_m[0], field.min_m[1]};
  plot.value = column_integrals(field);
  write_column_plot(image, plot);
}

void add_cloud_info(CLI::App& cloud_app, std::function<int()>& action) {
  struct Options {
    std::filesystem::path file;
    std::filesystem::path plot;
  };
  auto options = std::make_shared<Options>();
  CLI::App* app =
      cloud_app.add_subcommand("info", "Grids, size, voxel size, active voxels, values, column optical depth, fill");
  app->add_option("file", options->file, "VDB file")->type_name("FILE")->required();
  app->add_option("--plot", options->plot, "Map (one row: curve) of the columns of the grid \"density\" (PNG)")
      ->type_name("FILE");
  app->callback([&action, options] {
    action = [options] {
      check_outputs({{options->plot, "the plot", OutputKind::plot}}, std::span(&options->file, 1));
      const CloudInfo info = describe_cloud_vdb(options->file);
      fmt::print("{}", format_cloud_info(info));
      for (const std::string& doubt : doubts_about(info)) tell("cloudbow: warning: {}\n", printable(doubt));
      check_effective_radii(info);
      if (!options->plot.empty()) plot_columns(options->file, options->plot);
      return exit_done;
    };
  });
}

}  // namespace

void add_cloud(CLI::App& app, std::function<int()>& action) {
  CLI::App* cloud_app = app.add_subcommand("cloud", "Make, import and describe cloud fields (OpenVDB)");
  cloud_app->require_subcommand(1);
  add_cloud_make(*cloud_app, action);
  add_cloud_import(*cloud_app, action);
  add_cloud_info(*cloud_app, action);
}

}  // namespace cloudbow
