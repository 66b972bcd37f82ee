#include "app/commands/render_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <memory>

#include "app/commands/command_checks.hpp"
#include "app/process/exit_codes.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/number_text.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/plots/render.hpp"

namespace cloudbow {
namespace {

void set_exposure(RenderOptions& options, const std::string& text) {
  options.automatic_exposure = text == "auto";
  if (options.automatic_exposure) return;
  options.exposure = number_in(text);
  if (!options.exposure || !std::isfinite(*options.exposure) || *options.exposure <= 0)
    throw InputError(fmt::format("--exposure: found '{}', allowed a number > 0 or auto", text));
}

int draw(const RenderOptions& options) {
  const RenderReport report = render(options);
  fmt::print("{}: {} [{}], {}{}{} x {} {}, {}\n", options.image_file.string(), report.image.variable,
             printable(report.image.units), report.image.place, report.image.place.empty() ? "" : ", ", report.width,
             report.height, report.size_unit, report.colours);
  return exit_done;
}

}  // namespace

void add_render(CLI::App& app, std::function<int()>& action) {
  auto options = std::make_shared<RenderOptions>();
  const auto any_number = finite_number(std::numeric_limits<double>::lowest(), "a finite number");
  CLI::App* render_app =
      app.add_subcommand("render", "Draw a field of a result: a map, a section, a profile, or an image as it is seen");
  render_app->add_option("result", options->result_file, "Result file (HDF5)")->type_name("FILE")->required();
  render_app
      ->add_option("-o,--output", options->image_file, "Picture: PNG, or by its ending SVG, PDF or OpenEXR (.exr)")
      ->type_name("FILE")
      ->required();
  auto* variable =
      render_app->add_option("--variable,--field", options->variable, "Variable to draw")->capture_default_str();
  render_app
      ->add_option("--level", options->level,
                   "top, bottom or a height in metres (default: top; bottom for fluxes of light that travels down)")
      ->type_name("LEVEL");
  auto* section = render_app->add_option("--section", options->section, "A vertical section at this x or y, in metres")
                      ->type_name("x=M|y=M");
  render_app->add_flag("--profile", options->profile, "Domain means by height; without --variable those of all fluxes")
      ->excludes(section);
  auto* bare = render_app->add_flag_callback(
      "--bare", [options] { options->form = RenderForm::bare; },
      "Pixels alone (default of radiances, cameras, --scale and OpenEXR)");
  auto* figure = render_app->add_flag_callback(
      "--figure", [options] { options->form = RenderForm::figure; },
      "Axes, title and scale of colours (default of all others)");
  figure->excludes(bare);
  render_app
      ->add_option("--outline", options->outline,
                   "Sections: outline of the clouds at this extinction [1/m], 0 for none (default: 1e-4, if the result "
                   "has the field extinction)")
      ->check(finite_number(0, "an extinction >= 0 1/m"));
  render_app->add_option("--title", options->title, "Title of a figure (default: the scene's)")->type_name("TEXT");
  render_app->add_option("--size", options->width, "Width of a PNG figure in pixels (default: 1200)")
      ->check(whole_number(400, 10000));
  render_app->add_option("--range", options->range, "Values of the first and the last colour (default: those there)")
      ->type_name("FIRST LAST")
      ->check(any_number);
  render_app->add_option("--min", options->min, "Value of the first colour alone")->check(any_number);
  render_app->add_option("--max", options->max, "Value of the last colour alone")->check(any_number);
  render_app->add_option("--scale", options->scale, "Pixels alone, as many per cell (default: about 768 in all)")
      ->check(whole_number(1, 1000));
  render_app
      ->add_option("--colormap", options->colormap,
                   joined(colormap_names()) +
                       " (default: natural colours if possible; figures: viridis, or blue-red about 0; pixels: grey)")
      ->type_name("NAME");
  render_app->add_option("--wavelength-um", options->wavelength_um, "Of a spectrum: draw the nearest alone")
      ->check(finite_number(std::numeric_limits<double>::min(), "a wavelength > 0"));
  render_app->add_option("--tone", options->tone, "Tone curve of natural colours: " + joined(tone_names()))
      ->type_name("NAME");
  render_app
      ->add_option_function<std::string>(
          "--exposure", [options](const std::string& text) { set_exposure(*options, text); },
          "Factor on reflectance factors, or auto (default: 1)")
      ->type_name("X|auto");
  render_app->callback([&action, options, variable] {
    options->all_fluxes = variable->count() == 0;
    action = [options] { return draw(*options); };
  });
}

}  // namespace cloudbow
