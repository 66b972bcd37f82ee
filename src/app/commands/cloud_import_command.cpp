#include "app/commands/cloud_import_command.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <memory>

#include "app/commands/command_checks.hpp"
#include "app/process/exit_codes.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/io/phase_set_file.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "cloudbow/optics/legendre_series.hpp"

namespace cloudbow {
namespace {

/// Variables that CLI11 fills; optional triples and pairs as lists.
struct ImportCommand {
  CloudImportOptions import;
  std::vector<double> voxel_size_m;
  std::vector<int> columns;
  std::filesystem::path phase_functions;
  std::string moment_factor = "auto";
  std::string time = "0";
  VdbWriteOptions write;
  std::filesystem::path output;
  bool dry_run = false;
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
                                                    {"--model", les},
                                                    {"--with", les},
                                                    {"--profile", les},
                                                    {"--species", les},
                                                    {"--variable", {"les", "numpy"}},
                                                    {"--units", les},
                                                    {"--time", les},
                                                    {"--x-axis", les},
                                                    {"--y-axis", les},
                                                    {"--z-axis", les},
                                                    {"--time-axis", les},
                                                    {"--air-density", les},
                                                    {"--pressure", les},
                                                    {"--base-pressure", les},
                                                    {"--temperature", les},
                                                    {"--potential-temperature", les},
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

constexpr std::uint64_t most_times = 1000000000;

/// 0 if the text is no number.
std::size_t number_of_time(const std::string& text) {
  std::size_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

CLI::Validator all_or_whole_number() {
  return CLI::Validator(
      [](std::string& text) {
        const std::string problem = text == "all" ? "" : whole_number(0, most_times)(text);
        return problem.empty() ? problem : problem + ", or all";
      },
      "N");
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

void check_columns_and_sizes(const ImportCommand& command, CloudImportOptions& options) {
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
  if (!options.profile.empty() && !options.air_density.empty())
    throw InputError("--profile: not together with --air-density (both say the density of the air); leave out one");
}

void check_files(const ImportCommand& command, const std::filesystem::path& output) {
  std::vector<std::filesystem::path> inputs{command.import.file, command.phase_functions, command.import.profile};
  inputs.insert(inputs.end(), command.import.with.begin(), command.import.with.end());
  const std::array<OutputFile, 2> outputs{OutputFile{output, "the cloud", OutputKind::vdb},
                                          OutputFile{phase_set_beside(output), "its phase functions", OutputKind::csv}};
  check_distinct(outputs, inputs);
  check_writable(output);
}

void print_notes(const ImportedCloud& cloud) {
  for (const std::string& note : cloud.notes) fmt::print("{}\n", printable(note));
}

/// Content of a grid that is not written, in a line.
std::string grid_line(const std::string& name, const CloudField& field) {
  const CloudSummary summary = summarize(field);
  const auto& size = field.cell_size_m;
  std::string text =
      fmt::format("grid \"{}\": {} of {} x {} x {} voxels of {:.10g} x {:.10g} x {:.10g} m, values {:.6g} to {:.6g}",
                  name, summary.active_voxels, field.cells[0], field.cells[1], field.cells[2], size[0], size[1],
                  size[2], summary.value.min, summary.value.max);
  if (field.quantity != "temperature") text += fmt::format(", mean of cloudy columns {:.6g}", summary.column.mean);
  return text;
}

void print_dry_run(const ImportedCloud& cloud) {
  print_notes(cloud);
  fmt::print("nothing written (--dry-run); the file would have:\n{}\n", grid_line(cloud.grid, cloud.field));
  for (const VdbAuxiliary& auxiliary : cloud.auxiliaries) {
    const auto [least, most] = std::ranges::minmax_element(auxiliary.value);
    fmt::print("grid \"{}\": on these voxels, values {:.6g} to {:.6g}\n", auxiliary.grid, *least, *most);
  }
  for (const VdbCloudGrid& other : cloud.others) fmt::print("{}\n", grid_line(other.grid, other.field));
}

void write_import(const ImportCommand& command, const ImportedCloud& cloud, const std::filesystem::path& output) {
  VdbWriteOptions write = command.write;
  write.grid = cloud.grid;
  write_cloud_vdb(output, cloud.field, write, cloud.auxiliaries, cloud.others);
}

/// "cloud.vdb" becomes "cloud_0012.vdb".
std::filesystem::path numbered(const std::filesystem::path& output, std::size_t number) {
  const std::string name = fmt::format("{}_{:04}{}", output.stem().string(), number, output.extension().string());
  return output.parent_path() / name;
}

/// A file for each moment; those without any cloud get none.
int import_series(const ImportCommand& command, CloudImportOptions options) {
  options.may_be_clear = true;
  const std::size_t times = count_times(options);
  for (std::size_t n = 0; n < times && !command.dry_run; ++n) check_files(command, numbered(command.output, n));
  std::size_t written = 0;
  for (options.time = 0; options.time < times; ++options.time) {
    const ImportedCloud cloud = import_cloud(options);
    if (options.time == 0 && !command.quiet) print_notes(cloud);
    if (cloud.field.value.empty()) {
      if (!command.quiet) fmt::print("time {}: no cloud, no file\n", options.time);
      continue;
    }
    const std::filesystem::path output =
        command.dry_run ? std::filesystem::path() : numbered(command.output, options.time);
    if (!command.dry_run) write_import(command, cloud, output);
    ++written;
    if (command.quiet) continue;
    fmt::print("time {}: {}{}\n", options.time, command.dry_run ? "" : output.string() + ", ",
               grid_line(cloud.grid, cloud.field));
  }
  if (written == 0) {
    throw InputError(fmt::format("{}: no cloud at any of {} times (found no cell above {}, allowed at least one)",
                                 options.file.string(), times, options.minimum));
  }
  if (command.dry_run && !command.quiet) fmt::print("nothing written (--dry-run)\n");
  return exit_done;
}

int import_to_vdb(const CLI::App& app, const ImportCommand& command) {
  CloudImportOptions options = command.import;
  check_columns_and_sizes(command, options);
  if (!command.output.empty()) check_files(command, command.output);
  options.format = cloud_import_format(options);
  check_options_of_format(app, command.import, options.format);
  if (command.time == "all") return import_series(command, options);
  options.time = number_of_time(command.time);

  ImportedCloud cloud = import_cloud(options);
  const auto moments = phase_functions_of(command, cloud);
  if (!moments.empty()) check_indices(cloud, moments.size());
  if (command.dry_run) {
    if (!command.quiet) print_dry_run(cloud);
    return exit_done;
  }
  if (!moments.empty()) {
    write_phase_set_file(phase_set_beside(command.output), moments);
    cloud.notes.push_back(fmt::format("phase functions: written to {}, for [phase_function.NAME] type = \"set\"",
                                      phase_set_beside(command.output).string()));
  }
  write_import(command, cloud, command.output);
  if (command.quiet) return exit_done;
  print_notes(cloud);
  fmt::print("{}", format_cloud_info(describe_cloud_vdb(command.output)));
  return exit_done;
}

std::vector<std::string> models_to_choose() {
  std::vector<std::string> names{"auto"};
  names.insert(names.end(), les_model_names().begin(), les_model_names().end());
  return names;
}

}  // namespace

void add_cloud_import(CLI::App& cloud_app, std::function<int()>& action) {
  auto command = std::make_shared<ImportCommand>();
  CloudImportOptions& options = command->import;
  CLI::App* app = cloud_app.add_subcommand("import", "Import the cloud of another model");
  app->add_option("file", options.file, "LES output (netCDF), SHDOM property or LWC file, text, or NumPy array")
      ->type_name("FILE")
      ->required();
  app->add_option("-o,--output", command->output, "VDB file; phase functions go beside it, to NAME.phase.csv")
      ->type_name("FILE");
  app->add_flag("--dry-run", command->dry_run, "Print what is recognised and read, and write nothing");
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
                                  "SHDOM, text with optics: Legendre moments, one column per phase function")
                      ->type_name("MOMENTS");
  app->add_option("--moment-factor", command->moment_factor,
                  "Whether they hold the factor 2l+1: auto, included, excluded")
      ->needs(moments)
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "included", "excluded"}));
  app->add_option("--model", options.model,
                  "LES: whose layout the file has, if it does not show it: " + joined(models_to_choose()))
      ->capture_default_str()
      ->check(CLI::IsMember(models_to_choose()));
  app->add_option("--with", options.with, "LES: a further file, with variables that the first one lacks")
      ->type_name("FILE")
      ->expected(1)
      ->take_all();
  app->add_option("--profile", options.profile,
                  "LES: density of the air, or pressure and temperature, by height: text or netCDF")
      ->type_name("FILE");
  app->add_option("--species", options.species, "LES: grids of liquid, ice, rain, snow, graupel, or of all in the file")
      ->delimiter(',')
      ->check(CLI::IsMember({"liquid", "ice", "rain", "snow", "graupel", "all"}));
  app->add_option("--variable", options.variable, "LES: liquid water (default: a usual name)");
  app->add_option("--units", options.units,
                  "LES: of that variable, instead of the file's: kg/kg, g/kg, kg/m3, g/m3, 1/m, 1/km");
  app->add_option("--time", command->time, "LES: index on the time axis, from 0, or all: files NAME_0000.vdb, ...")
      ->capture_default_str()
      ->check(all_or_whole_number());
  const std::array<const char*, 4> axis{"x", "y", "z", "time"};
  for (std::size_t a = 0; a < axis.size(); ++a) {
    app->add_option(fmt::format("--{}-axis", axis[a]), options.axes[a],
                    fmt::format("LES: dimension that is {}", axis[a]));
  }
  app->add_option("--air-density", options.air_density,
                  "LES: air density, a variable or a number [kg/m3] or us-1976 (the standard atmosphere)");
  app->add_option("--pressure", options.pressure, "LES: pressure, with temperature in place of air density");
  app->add_option("--base-pressure", options.base_pressure, "LES: what is added to --pressure, a perturbation");
  auto* temperature =
      app->add_option("--temperature", options.temperature, "LES: temperature, or potential temperature");
  app->add_option("--potential-temperature", options.potential_temperature, "LES: potential temperature")
      ->excludes(temperature);
  app->add_flag("--temperature-grid", options.temperature_grid,
                "LES: import the temperature too, as a grid of the same voxels, for thermal emission");
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
  app->add_flag("--half", command->write.half, "Store the cloud with 16 bits per value");
  app->add_flag("--quiet", command->quiet, "Print errors alone");
  app->callback([&action, app, command] {
    if (command->output.empty() && !command->dry_run) throw CLI::RequiredError(app->get_option("--output")->get_name());
    action = [app, command] { return import_to_vdb(*app, *command); };
  });
}

}  // namespace cloudbow
