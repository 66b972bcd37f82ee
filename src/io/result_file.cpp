#include "cloudbow/io/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/file_library_lock.hpp"
#include "cloudbow/results/energy_fluxes.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "io/result_groups.hpp"
#include "io/solution_writer.hpp"

namespace cloudbow {

namespace {

using netcdf4::Attribute;
using Attributes = std::vector<Attribute>;
using Dimensions = std::vector<std::string>;

// The scalar coordinates of write_sun().
Attribute of_the_sun() { return {"coordinates", "solar_zenith_angle solar_azimuth_angle"}; }
constexpr const char* without_sun_disc = "the sun's disc is left out";

Attributes attributes_of(const OutputField& field, const FieldNames& names) {
  Attributes attributes = {{"units", names.units}, {"long_name", names.long_name}};
  if (names.standard_name != nullptr) attributes.push_back({"standard_name", names.standard_name});
  attributes.push_back({"cell_methods", field.grid == OutputField::Grid::levels ? "area: mean" : "area: mean z: mean"});
  return attributes;
}

Attributes horizontal_attributes(const char* long_name, const char* axis, double spacing) {
  return {{"units", "m"}, {"long_name", long_name}, {"axis", axis}, {"cell_size_m", spacing}};
}

Attributes vertical_attributes(const char* long_name) {
  return {{"units", "m"}, {"long_name", long_name}, {"axis", "Z"}, {"positive", "up"}};
}

Attributes height_attributes(const VoxelPlanes& cloud) {
  Attributes attributes = vertical_attributes("height of the cell centre");
  if (cloud.count > 0) {
    attributes.insert(attributes.end(), {{"cloud_voxel_planes", std::int32_t{cloud.count}},
                                         {"cloud_bottom_m", cloud.bottom_m},
                                         {"cloud_voxel_height_m", cloud.height_m}});
  }
  return attributes;
}

std::vector<double> centres(int cells, double min, double spacing) {
  std::vector<double> centre(static_cast<std::size_t>(cells));
  for (int i = 0; i < cells; ++i) centre[static_cast<std::size_t>(i)] = min + (i + 0.5) * spacing;
  return centre;
}

std::vector<double> midpoints(std::span<const double> edge) {
  std::vector<double> middle;
  for (std::size_t k = 0; k + 1 < edge.size(); ++k) middle.push_back(0.5 * (edge[k] + edge[k + 1]));
  return middle;
}

std::vector<double> flux_heights(const Solution& solution) {
  std::vector<double> height;
  for (const int level : solution.flux_level) height.push_back(solution.box.z_edge_m[static_cast<std::size_t>(level)]);
  return height;
}

/// Names of the dimensions of an image.
struct ImagePlane {
  std::string y = "y";
  std::string x = "x";
};

/// pi I / (mu0 F0).
std::vector<float> reflectance_factor(std::span<const float> radiance, const std::optional<Sun>& sun) {
  const double of_white = sun ? -sun->travel.z() * sun->irradiance / std::numbers::pi : 0;
  std::vector<float> factor;
  factor.reserve(radiance.size());
  for (const float value : radiance)
    factor.push_back(of_white > 0 ? static_cast<float>(value / of_white) : std::numeric_limits<float>::quiet_NaN());
  return factor;
}

std::vector<float> brightness_temperature(std::span<const float> radiance, const PlanckFunction& planck) {
  std::vector<float> kelvin;
  kelvin.reserve(radiance.size());
  for (const float value : radiance) {
    // A fisheye does not look into its corners.
    kelvin.push_back(std::isnan(value) ? value : static_cast<float>(planck.brightness_temperature(value)));
  }
  return kelvin;
}

std::vector<double> components(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::span<const std::int32_t> flattened(const std::vector<std::array<std::int32_t, 3>>& triples) {
  return {triples.empty() ? nullptr : triples.front().data(), 3 * triples.size()};
}

class ResultWriter : private SolutionWriter {
 public:
  ResultWriter(std::span<const Solution> solutions, const ResultInfo& info,
               std::span<const Solution> independent_columns)
      : SolutionWriter(solutions, info),
        solutions_(solutions),
        first_(solutions.front()),
        info_(info),
        independent_columns_(independent_columns) {}

  void write(const std::filesystem::path& path) const {
    hdf5::Handle file = hdf5::create_file(path);
    netcdf4::write_attributes(file, {{"Conventions", "CF-1.10"},
                                     {"title", info_.title},
                                     {"source", info_.source},
                                     {"history", info_.history},
                                     {"scene", info_.scene}});
    if (!info_.run_key.empty()) netcdf4::write_attribute(file, {"run_key", info_.run_key});
    write_fields(file);
    write_profile(file);
    write_summary(file, *this);
    write_ledger(file, *this);
    write_cloud(file, *this);
    write_thermal(file, *this);
    write_spectral(file, *this);
    write_solver(file, *this);
    if (!independent_columns_.empty()) write_comparison(file);
    write_error_estimate(file, *this);
    if (!info_.error_estimates.empty()) write_error_fields(file);
    write_target_report(file, *this);
    write_clear_sky(file);
    write_bands(file);
    write_images(file);
    write_camera_images(file);
    if (first_.radiance_field) write_radiance_field(file);
    hdf5::finish_file(file);
  }

 private:
  /// As write_variable(), of a field that depends on the sun.
  template <class Values>
  void write_lit(hid_t file, const std::string& name, const Dimensions& dimensions, const Values& values_of,
                 Attributes attributes) const {
    if (info_.sun) attributes.push_back(of_the_sun());
    write_variable(file, name, dimensions, values_of, attributes);
  }

  void write_sun(hid_t file) const {
    if (!info_.sun) return;
    netcdf4::write_scalar_coordinate(
        file, "solar_zenith_angle", info_.sun->zenith_deg,
        {{"units", "degree"}, {"long_name", "zenith angle of the sun"}, {"standard_name", "solar_zenith_angle"}});
    netcdf4::write_scalar_coordinate(file, "solar_azimuth_angle", info_.sun->bearing_deg,
                                     {{"units", "degree"},
                                      {"long_name", "azimuth of the sun, clockwise from north, which is +y"},
                                      {"standard_name", "solar_azimuth_angle"}});
  }

  void write_z(hid_t file) const {
    const std::vector<double>& edge = first_.box.z_edge_m;
    Attributes attributes = height_attributes(first_.box.cloud);
    attributes.push_back({"bounds", "z_bounds"});
    netcdf4::write_coordinate(file, "z", midpoints(edge), attributes);
    netcdf4::write_dimension(file, "bound", 2);
    std::vector<double> bounds;
    for (std::size_t k = 0; k + 1 < edge.size(); ++k) bounds.insert(bounds.end(), {edge[k], edge[k + 1]});
    netcdf4::write_variable(file, "z_bounds", {"z", "bound"}, std::span<const double>(bounds),
                            {{"long_name", "lower and upper face of each cell"}});
  }

  void write_z_edge(hid_t group) const {
    netcdf4::write_coordinate(group, "z_edge", first_.box.z_edge_m,
                              vertical_attributes("height of the horizontal interfaces"));
  }

  void write_fields(hid_t file) const {
    const BoxGrid& box = first_.box;
    write_wavelength(file);
    netcdf4::write_coordinate(file, "x", centres(box.nx, box.x_min_m, box.dx_m),
                              horizontal_attributes("cell centre, x", "X", box.dx_m));
    netcdf4::write_coordinate(file, "y", centres(box.ny, box.y_min_m, box.dy_m),
                              horizontal_attributes("cell centre, y", "Y", box.dy_m));
    write_z(file);
    write_z_edge(file);
    write_sun(file);

    if (flux_level_name() == "z_flux") {
      netcdf4::write_coordinate(file, "z_flux", flux_heights(first_), vertical_attributes("height of the fluxes"));
    }
    for (const OutputField& field : output_fields()) {
      const bool at_levels = field.grid == OutputField::Grid::levels;
      if ((first_.*field.values).empty()) continue;
      const FieldNames field_names = names(field);
      Attributes attributes = attributes_of(field, field_names);
      if (field.values == &Solution::circumsolar_flux)
        attributes.push_back({"half_angle_deg", info_.circumsolar_deg.value_or(0)});
      write_lit(
          file, field_names.name, {at_levels ? flux_level_name() : "z", "y", "x"},
          [&field](const Solution& s) -> auto& { return s.*field.values; }, attributes);
    }
    write_direct_normal_flux(file);
    write_heating_rate(file, {"z", "y", "x"}, "area: mean z: mean", &HeatingRate::cell);
    write_cloud_fields(file);
  }

  /// Writes nothing unless circumsolar light was requested.
  void write_direct_normal_flux(hid_t file) const {
    if (first_.circumsolar_flux.empty()) return;
    write_lit(file, "direct_normal_flux", {flux_level_name(), "y", "x"},
              [](const Solution& s) {
                std::vector<float> flux = s.direct_flux;
                const double mu0 = s.sun ? -s.sun->travel.z() : 1;
                for (float& f : flux) f = static_cast<float>(f / mu0);
                return flux;
              },
              {{"units", units("W m-2")},
               {"long_name", "unscattered sunlight through a plane that faces the sun (true extinction)"},
               {"cell_methods", "area: mean"}});
  }

  /// Writes what was requested of optical depth and extinction.
  void write_cloud_fields(hid_t file) const {
    const std::optional<double>& wavelength_um = info_.cloud_optical_depth_um;
    const std::string at = wavelength_um ? fmt::format(" at {} um", *wavelength_um) : "";
    Attributes of_depth{{"units", "1"},
                        {"long_name", "vertical optical depth of the cloud alone" + at},
                        {"standard_name", "atmosphere_optical_thickness_due_to_cloud"},
                        {"cell_methods", "area: mean"}};
    Attributes of_extinction{{"units", "m-1"},
                             {"long_name", "extinction coefficient of the cloud alone" + at},
                             {"cell_methods", "area: mean z: mean"}};
    if (wavelength_um) {
      of_depth.push_back({"wavelength_um", *wavelength_um});
      of_extinction.push_back({"wavelength_um", *wavelength_um});
    }
    if (!info_.cloud_optical_depth.empty()) {
      write_variable(
          file, "optical_depth",
          {"y", "x"}, [this](const Solution& s) -> auto& { return info_.cloud_optical_depth[index_of(s)]; }, of_depth);
    }
    if (!info_.cloud_extinction.empty()) {
      write_variable(
          file, "extinction",
          {"z", "y", "x"}, [this](const Solution& s) -> auto& { return info_.cloud_extinction[index_of(s)]; },
          of_extinction);
    }
  }

  /// Writes nothing without heating rates.
  template <class Values>
  void write_heating_rate(hid_t group, const std::vector<std::string>& dimensions, const char* cell_methods,
                          Values HeatingRate::*values) const {
    if (info_.heating_rates.empty()) return;
    std::string long_name =
        fmt::format("heating rate of the air: {}absorbed power over density and heat capacity at constant pressure",
                    emits() ? "net " : "");
    if (unit() == SpectralUnit::wavelength) long_name += ", per micrometre of wavelength";
    Attributes attributes{{"units", units("K s-1")},
                          {"long_name", long_name},
                          {"units_metadata", "temperature: difference"},
                          {"specific_heat_j_kg_k", specific_heat}};
    if (unit() == SpectralUnit::band && (!emits() || !first_.sun)) {
      attributes.push_back({"standard_name", fmt::format("tendency_of_air_temperature_due_to_{}_heating",
                                                         emits() ? "longwave" : "shortwave")});
    }
    attributes.push_back({"cell_methods", cell_methods});
    if (info_.sun && dimensions.size() == 3) attributes.push_back(of_the_sun());
    write_variable(
        group, "heating_rate",
        dimensions, [&](const Solution& s) -> auto& { return info_.heating_rates[index_of(s)].*values; }, attributes);
  }

  std::string flux_level_name() const {
    return first_.flux_level.size() == first_.box.z_edge_m.size() ? "z_edge" : "z_flux";
  }

  /// Both solutions have the levels that write_fields() wrote.
  void write_comparison(hid_t file) const {
    for (const OutputField& field : output_fields()) {
      const bool in_both = !(first_.*field.values).empty() && !(independent_columns_.front().*field.values).empty();
      if (field.grid != OutputField::Grid::levels || !in_both) continue;
      const FieldNames field_names = names(field);
      write_lit(file, fmt::format("difference_{}", field_names.name), {flux_level_name(), "y", "x"},
                [this, &field](const Solution& s) {
                  std::vector<float> difference = s.*field.values;
                  const Solution& columns = independent_columns_[index_of(s)];
                  std::transform(difference.begin(), difference.end(), (columns.*field.values).begin(),
                                 difference.begin(), std::minus<>());
                  return difference;
                },
                {{"units", field_names.units},
                 {"long_name", fmt::format("{}: this solution minus independent columns", field_names.long_name)},
                 {"cell_methods", "area: mean"}});
      Attributes attributes = attributes_of(field, field_names);
      attributes[1] = {"long_name", fmt::format("{}: independent columns", field_names.long_name)};
      write_lit(
          file, fmt::format("independent_columns_{}", field_names.name), {flux_level_name(), "y", "x"},
          [ this, &field ](const Solution& s) -> auto& { return independent_columns_[index_of(s)].*field.values; },
          attributes);
    }

    hdf5::Handle group = netcdf4::create_group(file, "independent_columns");
    write_wavelength(group);
    write_z_edge(group);
    write_profiles(group, SolutionWriter(independent_columns_, info_));
    const auto of = [this](const auto& number_of) { return each(number_of, independent_columns_); };
    if (emits()) {
      const auto flux = [&of](double EnergyFluxes::*term) {
        return of([term](const Solution& s) { return energy_fluxes(s.ledger).*term; });
      };
      netcdf4::write_attributes(group, {{"upwelling_top", flux(&EnergyFluxes::upwelling_top)},
                                        {"downwelling_bottom", flux(&EnergyFluxes::downwelling_bottom)},
                                        {"absorbed", flux(&EnergyFluxes::absorbed)}});
    } else {
      netcdf4::write_attributes(group, {{"reflectance", of([](const Solution& s) { return s.ledger.reflectance; })},
                                        {"transmittance", of([](const Solution& s) { return s.ledger.transmittance; })},
                                        {"absorptance", of([](const Solution& s) { return s.ledger.absorptance; })}});
    }
    netcdf4::write_attributes(group,
                              {{"energy_residual", of([](const Solution& s) { return s.ledger.residual; })},
                               {"converged", of([](const Solution& s) { return std::int32_t{s.report.converged}; })},
                               {"sweeps", of([](const Solution& s) { return std::int32_t{s.report.sweeps}; })},
                               {"estimated_error", of([](const Solution& s) { return s.report.estimated_error; })},
                               {"seconds_total", of([](const Solution& s) { return s.report.seconds_total; })},
                               {"cpu_seconds", of([](const Solution& s) { return s.report.cpu_seconds; })}});
    group.close();
  }

  void write_error_fields(hid_t file) const {
    write_error_field(file, "upwelling_flux_error", "up at the highest level", &ErrorEstimate::upwelling_flux_error);
    write_error_field(file, "downwelling_flux_error", "down (direct and diffuse) at the lowest level",
                      &ErrorEstimate::downwelling_flux_error);
  }

  /// Writes nothing if the field was not requested.
  void write_error_field(hid_t file, const char* name, const char* which,
                         std::vector<float> ErrorEstimate::*field) const {
    if ((info_.error_estimates.front().*field).empty()) return;
    write_lit(file, name,
              {"y", "x"}, [&](const Solution& s) -> auto& { return info_.error_estimates[index_of(s)].*field; },
              {{"units", units("W m-2")},
               {"long_name", fmt::format("estimated error of the flux {}", which)},
               {"cell_methods", "area: mean"}});
  }

  /// Of an image whose radiance is `radiance_of` a solution; only if there is a sun, and nothing else shines.
  template <class Radiance>
  void write_reflectance_factor(hid_t file, const std::string& name, const ImagePlane& plane,
                                const Radiance& radiance_of) const {
    if (emits() ||
        std::none_of(solutions_.begin(), solutions_.end(), [](const Solution& s) { return s.sun.has_value(); }))
      return;
    write_lit(
        file, "reflectance_factor_" + name, {plane.y, plane.x},
        [&](const Solution& s) { return reflectance_factor(radiance_of(s), s.sun); },
        {{"units", "1"},
         {"long_name",
          "reflectance factor pi I / (mu0 F0): diffuse radiance over that of a level, white, Lambertian surface in the "
          "sun above the atmosphere"},
         {"comment", without_sun_disc}});
  }

  /// Of an image whose radiance is `radiance_of` a solution, if it was requested.
  template <class Radiance>
  void write_brightness_temperature(hid_t file, const std::string& name, const ImagePlane& plane,
                                    const Radiance& radiance_of) const {
    const std::vector<std::string>& wanted = info_.brightness_temperatures;
    if (std::find(wanted.begin(), wanted.end(), name) == wanted.end()) return;
    write_lit(
        file, "brightness_temperature_" + name, {plane.y, plane.x},
        [&](const Solution& s) { return brightness_temperature(radiance_of(s), *info_.thermal[index_of(s)].planck); },
        {{"units", "K"},
         {"long_name", "brightness temperature: that of a black body with this radiance"},
         {"standard_name", "brightness_temperature"},
         {"units_metadata", "temperature: on_scale"},
         {"comment", without_sun_disc}});
  }

  ImagePlane write_view_plane(hid_t file, const View& view) const {
    if (view.width == 0) return {};
    const BoxGrid& box = first_.box;
    const ImagePlane plane{"y_" + view.name, "x_" + view.name};
    const double dx = box.nx * box.dx_m / view.width, dy = box.ny * box.dy_m / view.height;
    netcdf4::write_coordinate(file, plane.x.c_str(), centres(view.width, box.x_min_m, dx),
                              horizontal_attributes("pixel centre, x", "X", dx));
    netcdf4::write_coordinate(file, plane.y.c_str(), centres(view.height, box.y_min_m, dy),
                              horizontal_attributes("pixel centre, y", "Y", dy));
    return plane;
  }

  void write_images(hid_t file) const {
    constexpr double degree = std::numbers::pi / 180;
    for (std::size_t n = 0; n < first_.images.size(); ++n) {
      const View& view = first_.images[n].view;
      const ImagePlane plane = write_view_plane(file, view);
      const auto radiance_of = [n](const Solution& s) -> auto& { return s.images[n].radiance; };
      write_lit(file, "radiance_" + view.name, {plane.y, plane.x}, radiance_of,
                {{"units", units("W m-2 sr-1")},
                 {"long_name",
                  fmt::format("diffuse radiance at the {} of the domain, mean over the {} where the line of sight "
                              "crosses it",
                              view.travel.z() > 0 ? "top" : "bottom", view.width == 0 ? "column" : "pixel")},
                 {"cell_methods", "area: mean"},
                 {"comment", without_sun_disc},
                 {"sensor_zenith_deg", std::acos(std::clamp(view.travel.z(), -1., 1.)) / degree},
                 {"sensor_azimuth_deg", std::atan2(view.travel.y(), view.travel.x()) / degree}});
      write_reflectance_factor(file, view.name, plane, radiance_of);
      write_brightness_temperature(file, view.name, plane, radiance_of);
    }
  }

  void write_camera_images(hid_t file) const {
    constexpr double degree = std::numbers::pi / 180;
    for (std::size_t n = 0; n < first_.camera_images.size(); ++n) {
      const Camera& camera = first_.camera_images[n].camera;
      const ImagePlane plane{"row_" + camera.name, "column_" + camera.name};
      // Descending, so that what plots by coordinates has the first row on top.
      netcdf4::write_coordinate(file, plane.y.c_str(), centres(camera.height, camera.height, -1),
                                {{"units", "1"}, {"long_name", "pixel centre, height above the image's bottom edge"}});
      netcdf4::write_coordinate(file, plane.x.c_str(), centres(camera.width, 0, 1),
                                {{"units", "1"}, {"long_name", "pixel centre, columns from the image's left edge"}});
      const auto radiance_of = [n](const Solution& s) -> auto& { return s.camera_images[n].radiance; };
      write_lit(file, "camera_" + camera.name, {plane.y, plane.x}, radiance_of,
                {{"units", units("W m-2 sr-1")},
                 {"long_name", "diffuse radiance that a camera sees, mean over the pixel"},
                 {"comment", without_sun_disc},
                 {"projection", projection_name(camera.projection)},
                 {"position_m", components(camera.position_m)},
                 {"forward", components(camera.forward)},
                 {"right", components(camera.right)},
                 {"up", components(camera.up)},
                 {"field_of_view_deg", camera.field_of_view / degree}});
      write_reflectance_factor(file, camera.name, plane, radiance_of);
      write_brightness_temperature(file, camera.name, plane, radiance_of);
    }
  }

  /// Domain means of the fluxes at `z_edge` of the group.
  static void write_profiles(hid_t group, const SolutionWriter& of) {
    for (const OutputField& field : output_fields()) {
      if (field.profile == nullptr) continue;
      const FieldNames field_names = of.names(field);
      of.write_variable(
          group, field_names.name, {"z_edge"}, [&field](const Solution& s) -> auto& { return s.*field.profile; },
          attributes_of(field, field_names));
    }
  }

  /// xarray does not open the parents of a group, so the group has its own coordinates.
  void write_profile(hid_t file) const {
    hdf5::Handle group = netcdf4::create_group(file, "profile");
    write_wavelength(group);
    write_z_edge(group);
    write_profiles(group, *this);
    if (!info_.heating_rates.empty()) {
      netcdf4::write_coordinate(group, "z", midpoints(first_.box.z_edge_m), height_attributes(first_.box.cloud));
      write_heating_rate(group, {"z"}, "area: mean z: mean", &HeatingRate::profile);
    }
    group.close();
  }

  /// Writes nothing without a clear sky.
  void write_clear_sky(hid_t file) const {
    if (info_.clear_sky.empty()) return;
    const SolutionWriter clear(info_.clear_sky, info_);
    hdf5::Handle group = netcdf4::create_group(file, "clear_sky");
    write_wavelength(group);
    netcdf4::write_coordinate(group, "z_edge", clear.first().box.z_edge_m,
                              vertical_attributes("height of the horizontal interfaces without clouds"));
    write_profiles(group, clear);
    const auto of = [&clear](double EnergyFluxes::*term) {
      return clear.each([term](const Solution& s) { return energy_fluxes(s.ledger).*term; });
    };
    netcdf4::write_attributes(group, {{"units", clear.units("W m-2")},
                                      {"upwelling_top", of(&EnergyFluxes::upwelling_top)},
                                      {"downwelling_bottom", of(&EnergyFluxes::downwelling_bottom)},
                                      {"absorbed", of(&EnergyFluxes::absorbed)},
                                      {"surface_absorbed", of(&EnergyFluxes::surface_absorbed)},
                                      {"surface_emitted", of(&EnergyFluxes::surface_emitted)}});
    group.close();
  }

  /// Writes nothing without bands.
  void write_bands(hid_t file) const {
    if (info_.bands.empty()) return;
    hdf5::Handle group = netcdf4::create_group(file, "bands");
    netcdf4::write_dimension(group, "band", info_.bands.size());
    netcdf4::write_dimension(group, "bound", 2);
    write_z_edge(group);
    std::vector<double> bounds;
    for (const BandProfile& band : info_.bands)
      bounds.insert(bounds.end(), band.wavenumber_cm1.begin(), band.wavenumber_cm1.end());
    netcdf4::write_variable(group, "wavenumber_bounds", {"band", "bound"}, std::span<const double>(bounds),
                            {{"units", "cm-1"}, {"long_name", "lower and upper wavenumber of each band"}});
    const auto write_profile_of = [&](const OutputField& field, const char* level,
                                      std::vector<double> BandProfile::*values) {
      std::vector<double> all;
      for (const BandProfile& band : info_.bands) all.insert(all.end(), (band.*values).begin(), (band.*values).end());
      const FieldNames field_names = names(field);
      netcdf4::write_variable(group, field_names.name.c_str(), {"band", level}, std::span<const double>(all),
                              attributes_of(field, field_names));
    };
    for (const OutputField& field : output_fields()) {
      if (field.profile == &Solution::profile_upwelling_flux)
        write_profile_of(field, "z_edge", &BandProfile::upwelling_flux);
      if (field.profile == &Solution::profile_downwelling_diffuse_flux)
        write_profile_of(field, "z_edge", &BandProfile::downwelling_diffuse_flux);
      if (field.profile == &Solution::profile_direct_flux) write_profile_of(field, "z_edge", &BandProfile::direct_flux);
      if (field.values == &Solution::absorbed_power && !info_.bands.front().absorbed_power.empty()) {
        netcdf4::write_coordinate(group, "z", midpoints(first_.box.z_edge_m), height_attributes(first_.box.cloud));
        write_profile_of(field, "z", &BandProfile::absorbed_power);
      }
    }
    group.close();
  }

  void write_radiance_field(hid_t file) const {
    const RadianceField& field = *first_.radiance_field;
    hdf5::Handle group = netcdf4::create_group(file, "radiance_field");
    netcdf4::write_attributes(
        group, {{"frame", "axes of the domain: x, y horizontal, z up"},
                {"interpolation",
                 "the radiance along a direction of travel is the mean of the radiances at the corners of "
                 "the triangle that holds it, weighted by the areas of the spherical triangles that it forms with the "
                 "sides opposite to the corners"}});
    write_wavelength(group);
    netcdf4::write_dimension(group, "control_point", field.direction.size());
    netcdf4::write_dimension(group, "active_voxel", field.voxel.size());
    netcdf4::write_dimension(group, "face", field.triangle.size());
    netcdf4::write_dimension(group, "corner", 3);
    netcdf4::write_dimension(group, "axis", 3);

    std::vector<double> direction;
    for (const Direction& d : field.direction) direction.insert(direction.end(), {d.x(), d.y(), d.z()});
    netcdf4::write_variable(
        group, "direction", {"control_point", "axis"}, std::span<const double>(direction),
        {{"units", "1"}, {"long_name", "unit vector in which light travels, at each control point"}});
    netcdf4::write_variable(
        group, "triangle", {"face", "corner"}, flattened(field.triangle),
        {{"units", "1"},
         {"long_name",
          "control points at the corners of each triangle of the sphere, counter-clockwise seen from "
          "outside, from 0"}});
    netcdf4::write_variable(group, "voxel", {"active_voxel", "axis"}, flattened(field.voxel),
                            {{"units", "1"}, {"long_name", "cell indices i, j, k along x, y, z, from 0"}});
    write_variable(
        group, "radiance", {"active_voxel", "control_point"},
        [](const Solution& s) -> auto& { return s.radiance_field->radiance; },
        {{"units", units("W m-2 sr-1")},
         {"long_name", "voxel mean of the diffuse radiance of the delta-scaled problem, direct beam excluded"}});
    group.close();
  }

  std::span<const Solution> solutions_;
  const Solution& first_;
  const ResultInfo& info_;
  std::span<const Solution> independent_columns_;
};

}  // namespace

void write_result(const std::filesystem::path& file, const Solution& solution, const ResultInfo& info) {
  write_result(file, std::span(&solution, 1), info);
}

void write_result(const std::filesystem::path& file, std::span<const Solution> solutions, const ResultInfo& info,
                  std::span<const Solution> independent_columns) {
  assert(independent_columns.empty() || independent_columns.size() == solutions.size());
  assert(!solutions.empty() && solutions.front().box.nz() >= 1);
  assert(info.error_estimates.empty() || info.error_estimates.size() == solutions.size());
  assert(solutions.size() == std::max<std::size_t>(info.wavelengths_um.size(), 1));
  assert(info.thermal.empty() || info.thermal.size() == solutions.size());
  assert(info.heating_rates.empty() || info.heating_rates.size() == solutions.size());
  assert(info.cloud_optical_depth.empty() || info.cloud_optical_depth.size() == solutions.size());
  assert(info.cloud_extinction.empty() || info.cloud_extinction.size() == solutions.size());
  assert(info.brightness_temperatures.empty() || !info.thermal.empty());
  const FileLibraryLock lock;
  AtomicFile target(file);
  try {
    ResultWriter(solutions, info, independent_columns).write(target.temporary());
  } catch (const hdf5::Error& error) {
    throw_unwritable(file, error.what());
  }
  target.commit();
}

}  // namespace cloudbow
