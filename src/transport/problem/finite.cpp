#include "transport/problem/finite.hpp"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <stdexcept>

#include "cloudbow/transport/output_fields.hpp"

namespace cloudbow {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& where, double found) {
  throw std::runtime_error(
      fmt::format("{}{}: not a number in the solution (found {}, allowed finite numbers); nothing is written", what,
                  where.empty() ? "" : " " + where, found));
}

/// The functor returns the name of the location of value n.
template <class Value, class Where>
void check_all(const std::string& what, std::span<const Value> values, const Where& where) {
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (!std::isfinite(values[n])) fail(what, where(n), static_cast<double>(values[n]));
  }
}

std::string column_text(const BoxGrid& box, std::size_t column) {
  const auto nx = static_cast<std::size_t>(box.nx);
  return fmt::format("column ({}, {})", column % nx, column / nx);
}

void check_fields(const Solution& solution) {
  const BoxGrid& box = solution.box;
  const std::size_t columns = box.columns();
  const auto at_level = [&](std::size_t n) {
    const auto level = static_cast<std::size_t>(solution.flux_level[n / columns]);
    return fmt::format("at {} m, {}", box.z_edge_m[level], column_text(box, n % columns));
  };
  const auto in_cell = [&](std::size_t n) {
    return fmt::format("in level {}, {}", n / columns, column_text(box, n % columns));
  };
  const auto at_edge = [&](std::size_t n) { return fmt::format("at {} m", box.z_edge_m[n]); };
  for (const OutputField& field : output_fields()) {
    const std::span<const float> values = solution.*field.values;
    if (field.grid == OutputField::Grid::levels) check_all(field.name, values, at_level);
    if (field.grid == OutputField::Grid::cells) check_all(field.name, values, in_cell);
    if (field.profile != nullptr)
      check_all(fmt::format("profile/{}", field.name), std::span<const double>(solution.*field.profile), at_edge);
  }
}

std::string pixel_text(std::size_t pixel, std::size_t width) {
  return fmt::format("at pixel ({}, {})", pixel % width, pixel / width);
}

void check_images(const Solution& solution) {
  for (const RadianceImage& image : solution.images) {
    const int width = image.view.width > 0 ? image.view.width : solution.box.nx;
    check_all<float>(fmt::format("radiance \"{}\"", image.view.name), image.radiance,
                     [&](std::size_t n) { return pixel_text(n, static_cast<std::size_t>(width)); });
  }
  for (const CameraImage& image : solution.camera_images) {
    const auto width = static_cast<std::size_t>(image.camera.width);
    for (std::size_t n = 0; n < image.radiance.size(); ++n) {
      if (std::isfinite(image.radiance[n])) continue;
      bool looks = !std::isnan(image.radiance[n]);
      for_lines_of_sight(image.camera, static_cast<int>(n / width), static_cast<int>(n % width),
                         [&](const Direction&) { looks = true; });
      if (!looks) continue;
      fail(fmt::format("camera \"{}\"", image.camera.name), pixel_text(n, width), image.radiance[n]);
    }
  }
}

void check_numbers(const Solution& solution) {
  const EnergyLedger& ledger = solution.ledger;
  const SolverReport& report = solution.report;
  const std::pair<const char*, double> numbers[] = {{"reflectance", ledger.reflectance},
                                                    {"transmittance", ledger.transmittance},
                                                    {"transmittance_direct", ledger.transmittance_direct},
                                                    {"absorptance", ledger.absorptance},
                                                    {"surface_absorptance", ledger.surface_absorptance},
                                                    {"side_gain", ledger.side_gain},
                                                    {"side_loss", ledger.side_loss},
                                                    {"energy_residual", ledger.residual},
                                                    {"estimated_error", report.estimated_error},
                                                    {"gather_rescaling", report.gather_rescaling},
                                                    {"fit_closure", report.fit_closure},
                                                    {"fit_max_error", report.fit_max_error}};
  for (const auto& [name, value] : numbers) {
    if (!std::isfinite(value)) fail(name, "", value);
  }
}

}  // namespace

void check_finite(const Solution& solution) {
  check_fields(solution);
  check_images(solution);
  if (const auto& field = solution.radiance_field) {
    check_all<float>("radiance_field", field->radiance, [&](std::size_t n) {
      const auto& voxel = field->voxel[n / field->direction.size()];
      return fmt::format("in voxel ({}, {}, {}), control point {}", voxel[0], voxel[1], voxel[2],
                         n % field->direction.size());
    });
  }
  check_numbers(solution);
}

}  // namespace cloudbow
