#include "cloudbow/io/phase_file.hpp"

#include <cctype>
#include <cmath>
#include <numbers>
#include <span>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/file_library_lock.hpp"
#include "io/netcdf4_file.hpp"

namespace cloudbow {
namespace {

constexpr double angle_step_deg = 0.5;

/// As names of variables are written here: "delta-M" becomes "delta_m".
std::string underscored(std::string name) {
  for (char& c : name) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

std::vector<double> section_angles() {
  std::vector<double> angle;
  for (int i = 0; i * angle_step_deg <= 360; ++i) angle.push_back(i * angle_step_deg);
  return angle;
}

void write_fit(hid_t group, const PhaseFit& fit, const PhaseReport& report, std::span<const double> angle) {
  if (fit.value.size() == 0) return;
  const std::string name = underscored(name_of(fit.method));
  const PhaseFitErrors& e = fit.errors;
  const std::vector<double> section = great_circle_section(report.points, fit.value, report.options.travel, angle);
  netcdf4::write_variable(group, ("fit_" + name).c_str(), {"angle"}, std::span<const double>(section),
                          {{"units", "1"},
                           {"long_name", "interpolant of the fit " + name_of(fit.method) + " along the great circle"},
                           {"max_error", e.max_error},
                           {"worst_angle_deg", e.worst_angle_deg},
                           {"max_error_between_samples", e.max_error_between},
                           {"rms_error", e.rms_error},
                           {"relative_rms_error", e.relative_rms_error},
                           {"max_error_over_square_root", e.scaled_error},
                           {"ordinate_norm", e.ordinate_norm},
                           {"ordinate_asymmetry_parameter", e.ordinate_asymmetry},
                           {"interpolant_norm", e.interpolant_norm},
                           {"interpolant_asymmetry_parameter", e.interpolant_asymmetry},
                           {"least_value", e.least_value},
                           {"exact_degree", std::int32_t{fit.exact_degree}}});
  netcdf4::write_variable(group, ("value_" + name).c_str(), {"control_point"},
                          std::span<const double>(fit.value.data(), static_cast<std::size_t>(fit.value.size())),
                          {{"units", "1"}, {"long_name", "the fit " + name_of(fit.method) + " at the control points"}});
}

void write_function(hid_t file, const FittedFunction& fitted, const PhaseReport& report) {
  hdf5::Handle group = netcdf4::create_group(file, underscored(fitted.name).c_str());
  netcdf4::write_attribute(group, {"asymmetry_parameter", fitted.function.asymmetry_parameter()});

  const std::vector<double> angle = section_angles();
  netcdf4::write_coordinate(
      group, "angle", angle,
      {{"units", "degree"},
       {"long_name", "angle from the direction of travel along a great circle; the scattering angle up to 180"}});
  const std::span<const double> moments = fitted.function.moments();
  std::vector<double> degree(moments.size());
  for (std::size_t l = 0; l < degree.size(); ++l) degree[l] = static_cast<double>(l);
  netcdf4::write_coordinate(group, "degree", degree, {{"units", "1"}, {"long_name", "degree of the Legendre moment"}});
  netcdf4::write_dimension(group, "control_point", static_cast<std::size_t>(report.points.size()));
  netcdf4::write_dimension(group, "axis", 3);

  std::vector<double> value;
  for (const double a : angle) value.push_back(fitted.function(std::cos(a * std::numbers::pi / 180)));
  netcdf4::write_variable(group, "phase_function", {"angle"}, std::span<const double>(value),
                          {{"units", "1"}, {"long_name", "phase function, mean 1 over the sphere"}});
  netcdf4::write_variable(group, "moment", {"degree"}, moments,
                          {{"units", "1"}, {"long_name", "Legendre moments, without the factor 2l+1"}});
  std::vector<double> direction;
  for (const Direction& d : report.points.directions()) direction.insert(direction.end(), {d.x(), d.y(), d.z()});
  netcdf4::write_variable(group, "direction", {"control_point", "axis"}, std::span<const double>(direction),
                          {{"units", "1"}, {"long_name", "unit vectors to the control points"}});
  for (const PhaseFit& fit : fitted.fits) write_fit(group, fit, report, angle);
  group.close();
}

}  // namespace

void write_phase_file(const std::filesystem::path& path, const PhaseReport& report, const std::string& source,
                      const std::string& history) {
  const FileLibraryLock lock;
  AtomicFile target(path);
  try {
    hdf5::Handle file = hdf5::create_file(target.temporary());
    const Direction travel = report.options.travel.normalized();
    netcdf4::write_attributes(file, {{"Conventions", "CF-1.10"},
                                     {"title", "phase function: " + report.title},
                                     {"source", source},
                                     {"history", history},
                                     {"delta_m_order", std::int32_t{report.delta_m_order}},
                                     {"forward_fraction", report.forward_fraction},
                                     {"control_points", std::int32_t{report.points.size()}},
                                     {"quadrature", report.ordinates},
                                     {"exact_moments", std::int32_t{report.options.exact_moments}},
                                     {"travel_x", travel.x()},
                                     {"travel_y", travel.y()},
                                     {"travel_z", travel.z()}});
    for (const FittedFunction& fitted : report.functions) write_function(file, fitted, report);
    hdf5::finish_file(file);
  } catch (const hdf5::Error& error) {
    throw_unwritable(path, error.what());
  }
  target.commit();
}

}  // namespace cloudbow
