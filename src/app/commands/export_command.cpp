#include "app/commands/export_command.hpp"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "app/commands/command_checks.hpp"
#include "app/process/exit_codes.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/field_export.hpp"
#include "cloudbow/sphere/travel.hpp"

namespace cloudbow {
namespace {

struct Options {
  FieldExportOptions fields;
  std::vector<double> direction;
  std::optional<double> zenith_deg;
  double azimuth_deg = 0;
  bool quiet = false;
};

std::string names_of(const std::vector<std::string>& grids) {
  if (grids.size() <= 4) return joined(grids);
  return fmt::format("{}, {} ... {}", grids[0], grids[1], grids.back());
}

int export_vdb(const Options& options) {
  FieldExportOptions fields = options.fields;
  if (!options.direction.empty()) {
    fields.travel = Direction(options.direction[0], options.direction[1], options.direction[2]);
  } else if (options.zenith_deg) {
    if (*options.zenith_deg > 180) {
      throw InputError(fmt::format("--zenith-deg: {} is out of range (allowed: 0 to 180)", *options.zenith_deg));
    }
    fields.travel = -travel_from(*options.zenith_deg, options.azimuth_deg);
  }
  if (!fields.travel && !fields.all_directions && !fields.actinic && !fields.absorption && !fields.heating_rate) {
    throw InputError(
        "export: nothing to export (found no field, allowed one or more of --direction or --zenith-deg, "
        "--all-directions, --actinic, --absorption, --heating-rate)");
  }
  const FieldExportReport report = export_fields(fields);
  if (options.quiet) return exit_done;
  fmt::print("{}: {} {} ({})\n", fields.vdb_file.string(), report.grids.size(),
             report.grids.size() == 1 ? "grid" : "grids", names_of(report.grids));
  fmt::print("{} x {} x {} voxels of {:g} x {:g} x {:g} m from ({:g}, {:g}, {:g}) m to ({:g}, {:g}, {:g}) m: {}\n",
             report.voxels[0], report.voxels[1], report.voxels[2], report.voxel_size_m[0], report.voxel_size_m[1],
             report.voxel_size_m[2], report.min_m[0], report.min_m[1], report.min_m[2], report.max_m[0],
             report.max_m[1], report.max_m[2],
             report.whole_domain ? "the whole domain"
                                 : "the heights of the cloud, because levels of the result are of different thickness");
  return exit_done;
}

}  // namespace

void add_export(CLI::App& app, std::function<int()>& action) {
  auto options = std::make_shared<Options>();
  FieldExportOptions& fields = options->fields;
  CLI::App* export_app = app.add_subcommand(
      "export", "Write fields of a result file as OpenVDB grids (radiance by direction, actinic flux)");
  export_app->add_option("result", fields.result_file, "Result file (HDF5)")->type_name("FILE")->required();
  export_app->add_option("--vdb", fields.vdb_file, "OpenVDB file to write")->type_name("FILE")->required();
  auto* direction =
      export_app
          ->add_option(
              "--direction", options->direction,
              "Grid \"radiance\": diffuse light that travels along this vector, which points from the scene to "
              "the sensor, z up; any length")
          ->type_name("X Y Z")
          ->expected(3)
          ->check(finite_number(std::numeric_limits<double>::lowest(), "a finite number"));
  auto* zenith =
      export_app
          ->add_option("--zenith-deg", options->zenith_deg,
                       "The same by the position of the sensor, as in [[radiance]]: 0 sees light that travels "
                       "straight up, above 90 light that travels down")
          ->type_name("Z")
          ->excludes(direction)
          ->check(finite_number(0, "0 to 180"));
  export_app
      ->add_option("--azimuth-deg", options->azimuth_deg,
                   "Azimuth of the sensor, counter-clockwise from +x. As the sun's: light scattered back; the sun's "
                   "plus 180: light scattered forward (default: 0)")
      ->type_name("A")
      ->needs(zenith)
      ->check(finite_number(std::numeric_limits<double>::lowest(), "a finite number"));
  export_app->add_flag("--all-directions", fields.all_directions,
                       "Grids \"radiance_000\" ...: one for each control point, metadata \"direction\" of travel");
  export_app->add_flag("--actinic", fields.actinic,
                       "Grid \"actinic_flux\": 4 pi times the mean radiance, direct beam included");
  export_app->add_flag("--absorption", fields.absorption,
                       "Grid \"absorbed_power\" [W m-3]; of a scene with [thermal] \"net_absorbed_power\"");
  export_app->add_flag("--heating-rate", fields.heating_rate, "Grid \"heating_rate\" [K s-1]");
  export_app->add_flag("--quiet", options->quiet, "Print errors alone");
  export_app->footer(
      "Voxels are the cloud's, in metres, z up; cells without a value are inactive. Radiance needs the field "
      "radiance_field among output.fields of the scene, and does not hold the direct beam (docs/radiance-fields.md).");
  export_app->callback([&action, options] { action = [options] { return export_vdb(*options); }; });
}

}  // namespace cloudbow
