#include "app/commands/cloud_commands.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

#include "app/commands/cloud_import_command.hpp"
#include "app/commands/command_checks.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/messages.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/medium/cloud_refinement.hpp"
#include "cloudbow/medium/vdb_file.hpp"
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
  make_app->add_flag("--half", options->write.half, "Store 16 bits per value: half the size");
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

struct RefineOptions {
  std::filesystem::path file, output;
  VdbReadOptions read;
  int factor = 2;
  std::string boundary = "periodic";
  VdbWriteOptions write;
};

/// Grids of the file on the voxels of the cloud, which keep their value in all parts; the others are named.
std::vector<VdbAuxiliary> refined_auxiliaries(const RefineOptions& options, const CloudField& field,
                                              const CloudField& refined) {
  std::vector<VdbAuxiliary> auxiliaries;
  for (const VdbGridInfo& grid : describe_cloud_vdb(options.file, {}, options.read.up_axis).grids) {
    if (grid.name == options.read.grid) continue;
    VdbReadOptions read = options.read;
    read.grid = grid.name;
    try {
      const std::vector<float> values = read_auxiliary_vdb(options.file, field, read);
      auxiliaries.push_back(
          {grid.name, grid.quantity, grid.units, values_of_parts(field, refined, options.factor, values)});
    } catch (const InputError&) {
      tell("cloudbow: note: {}: grid \"{}\" has different voxels and is not written (--grid {} refines it)\n",
           printable(options.file.string()), printable(grid.name), printable(grid.name));
    }
  }
  return auxiliaries;
}

int refine(const RefineOptions& options) {
  check_outputs({{options.output, "the cloud", OutputKind::vdb}}, std::span(&options.file, 1));
  const VdbCloud field = read_cloud_vdb(options.file, options.read);
  const CloudField refined = refine_cloud(field, options.factor, options.boundary == "periodic");
  VdbWriteOptions write = options.write;
  write.grid = options.read.grid;
  write_cloud_vdb(options.output, refined, write, refined_auxiliaries(options, field, refined));
  fmt::print("{}", format_cloud_info(describe_cloud_vdb(options.output)));
  return exit_done;
}

void add_cloud_refine(CLI::App& cloud_app, std::function<int()>& action) {
  auto options = std::make_shared<RefineOptions>();
  CLI::App* app = cloud_app.add_subcommand(
      "refine", "Divide voxels into parts, trilinear between their centres, with the mean of each voxel kept");
  app->add_option("file", options->file, "VDB file")->type_name("FILE")->required();
  app->add_option("--factor", options->factor, "Parts of a voxel along each axis")
      ->capture_default_str()
      ->check(whole_number(least_refinement, largest_refinement));
  app->add_option("--grid", options->read.grid, "Grid with the cloud")->type_name("NAME")->capture_default_str();
  app->add_option("--boundary", options->boundary, "Beyond the sides: periodic, or open with the values at the rim")
      ->capture_default_str()
      ->check(CLI::IsMember({"periodic", "open"}));
  app->add_option("--up-axis", options->read.up_axis, "Axis of the file that points up: x, y (renderers) or z")
      ->capture_default_str()
      ->check(CLI::IsMember({"x", "y", "z"}));
  app->add_flag("--half", options->write.half, "Store 16 bits per value: half the size");
  app->add_option("-o,--output", options->output, "VDB file")->type_name("FILE")->required();
  app->callback([&action, options] { action = [options] { return refine(*options); }; });
}

void plot_columns(const std::filesystem::path& file, const VdbReadOptions& read, const std::filesystem::path& image) {
  const VdbCloud field = read_cloud_vdb(file, read);
  ColumnPlot plot;
  plot.title = file.filename().string();
  plot.name = column_integral_name(field.quantity, field.units);
  plot.unit = "1";
  if (const auto unit = plot.name.find(" [g/m2]"); unit != std::string::npos) {
    plot.name.resize(unit);
    plot.unit = "g m-2";
  }
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
    std::string grid;
    std::string up_axis = "z";
  };
  auto options = std::make_shared<Options>();
  CLI::App* app =
      cloud_app.add_subcommand("info", "Grids, size, voxel size, active voxels, values, column optical depth, fill");
  app->add_option("file", options->file, "VDB file")->type_name("FILE")->required();
  app->add_option("--plot", options->plot,
                  "Map (one row: curve) of the columns of the grid \"density\", or --grid (PNG, SVG, PDF)")
      ->type_name("FILE");
  app->add_option("--grid", options->grid, "This grid alone")->type_name("NAME");
  app->add_option("--up-axis", options->up_axis, "Axis of the file that points up: x, y (renderers) or z")
      ->capture_default_str()
      ->check(CLI::IsMember({"x", "y", "z"}));
  app->callback([&action, options] {
    action = [options] {
      check_outputs({{options->plot, "the plot", OutputKind::plot}}, std::span(&options->file, 1));
      const CloudInfo info = describe_cloud_vdb(options->file, options->grid, options->up_axis);
      fmt::print("{}", format_cloud_info(info));
      for (const std::string& doubt : doubts_about(info)) tell("cloudbow: warning: {}\n", printable(doubt));
      check_effective_radii(info);
      if (options->plot.empty()) return exit_done;
      VdbReadOptions read;
      if (!options->grid.empty()) read.grid = options->grid;
      read.up_axis = options->up_axis;
      plot_columns(options->file, read, options->plot);
      return exit_done;
    };
  });
}

}  // namespace

void add_cloud(CLI::App& app, std::function<int()>& action) {
  CLI::App* cloud_app = app.add_subcommand("cloud", "Make, import, describe and refine cloud fields (OpenVDB)");
  cloud_app->require_subcommand(1);
  add_cloud_make(*cloud_app, action);
  add_cloud_import(*cloud_app, action);
  add_cloud_info(*cloud_app, action);
  add_cloud_refine(*cloud_app, action);
}

}  // namespace cloudbow
