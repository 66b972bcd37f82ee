#include "cloudbow/results/result_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "atomic_file.hpp"
#include "netcdf4_file.hpp"

namespace cloudbow {

namespace {

using netcdf4::Attribute;
using Attributes = std::vector<Attribute>;
using Dimensions = std::vector<std::string>;

/// Names as in the CF standard name table (version 83), or none where the table has no name for exactly this quantity.
struct FluxName {
  const char* name;
  const char* long_name;
  const char* standard_name;
};
constexpr FluxName kUpwelling{"upwelling_flux", "upwelling diffuse flux through a horizontal surface",
                              "upwelling_shortwave_flux_in_air"};
constexpr FluxName kDownwellingDiffuse{"downwelling_diffuse_flux",
                                       "downwelling diffuse flux through a horizontal surface, without the direct beam",
                                       "diffuse_downwelling_shortwave_flux_in_air"};
constexpr FluxName kDirect{"direct_flux", "unscattered sunlight through a horizontal surface (true extinction)",
                           "direct_downwelling_shortwave_flux_in_air"};

Attributes flux_attributes(const FluxName& flux) {
  return {{"units", "W m-2"},
          {"long_name", flux.long_name},
          {"standard_name", flux.standard_name},
          {"cell_methods", "area: mean"}};
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

void write_z_edge(hid_t group, const BoxGrid& box) {
  netcdf4::write_coordinate(group, "z_edge", box.z_edge_m, vertical_attributes("height of the horizontal interfaces"));
}

void write_fields(hid_t file, const Solution& solution) {
  const BoxGrid& box = solution.box;
  netcdf4::write_coordinate(file, "x", centres(box.nx, box.x_min_m, box.dx_m),
                            horizontal_attributes("cell centre, x", "X", box.dx_m));
  netcdf4::write_coordinate(file, "y", centres(box.ny, box.y_min_m, box.dy_m),
                            horizontal_attributes("cell centre, y", "Y", box.dy_m));
  netcdf4::write_coordinate(file, "z", midpoints(box.z_edge_m), height_attributes(box.cloud));
  write_z_edge(file, box);

  const bool all_levels = solution.flux_level.size() == box.z_edge_m.size();
  const Dimensions flux_dimensions = {all_levels ? "z_edge" : "z_flux", "y", "x"};
  if (!all_levels) {
    netcdf4::write_coordinate(file, "z_flux", flux_heights(solution), vertical_attributes("height of the fluxes"));
  }
  netcdf4::write_variable(file, kUpwelling.name, flux_dimensions, std::span(solution.upwelling_flux),
                          flux_attributes(kUpwelling));
  netcdf4::write_variable(file, kDownwellingDiffuse.name, flux_dimensions, std::span(solution.downwelling_diffuse_flux),
                          flux_attributes(kDownwellingDiffuse));
  netcdf4::write_variable(file, kDirect.name, flux_dimensions, std::span(solution.direct_flux),
                          flux_attributes(kDirect));

  const Dimensions cell_dimensions = {"z", "y", "x"};
  if (!solution.absorbed_power.empty()) {
    netcdf4::write_variable(
        file, "absorbed_power", cell_dimensions, std::span(solution.absorbed_power),
        {{"units", "W m-3"}, {"long_name", "solar power absorbed per volume"}, {"cell_methods", "area: mean z: mean"}});
  }
  if (!solution.actinic_flux.empty()) {
    netcdf4::write_variable(file, "actinic_flux", cell_dimensions, std::span(solution.actinic_flux),
                            {{"units", "W m-2"},
                             {"long_name", "actinic flux: 4 pi times the mean radiance, direct beam included"},
                             {"cell_methods", "area: mean z: mean"}});
  }
}

void write_images(hid_t file, const Solution& solution) {
  constexpr double degree = std::numbers::pi / 180;
  for (const RadianceImage& image : solution.images) {
    const Direction& travel = image.view.travel;
    netcdf4::write_variable(
        file, ("radiance_" + image.view.name).c_str(), {"y", "x"}, std::span(image.radiance),
        {{"units", "W m-2 sr-1"},
         {"long_name",
          fmt::format(
              "diffuse radiance at the {} of the domain, mean over the column where the line of sight crosses it",
              travel.z() > 0 ? "top" : "bottom")},
         {"cell_methods", "area: mean"},
         {"sensor_zenith_deg", std::acos(std::clamp(travel.z(), -1., 1.)) / degree},
         {"sensor_azimuth_deg", std::atan2(travel.y(), travel.x()) / degree}});
  }
}

/// xarray opens a group without its parents, so the group brings its own z_edge.
void write_profile(hid_t file, const Solution& solution) {
  hdf5::Handle group = netcdf4::create_group(file, "profile");
  write_z_edge(group, solution.box);
  const Dimensions dimensions = {"z_edge"};
  netcdf4::write_variable(group, kUpwelling.name, dimensions, std::span(solution.profile_upwelling_flux),
                          flux_attributes(kUpwelling));
  netcdf4::write_variable(group, kDownwellingDiffuse.name, dimensions,
                          std::span(solution.profile_downwelling_diffuse_flux), flux_attributes(kDownwellingDiffuse));
  netcdf4::write_variable(group, kDirect.name, dimensions, std::span(solution.profile_direct_flux),
                          flux_attributes(kDirect));
  group.close();
}

void write_summary(hid_t file, const EnergyLedger& ledger) {
  hdf5::Handle group = netcdf4::create_group(file, "summary");
  netcdf4::write_attributes(group, {{"reflectance", ledger.reflectance},
                                    {"transmittance", ledger.transmittance},
                                    {"transmittance_direct", ledger.transmittance_direct},
                                    {"absorptance", ledger.absorptance},
                                    {"surface_absorptance", ledger.surface_absorptance},
                                    {"side_gain", ledger.side_gain},
                                    {"side_loss", ledger.side_loss},
                                    {"energy_residual", ledger.residual}});
  group.close();
}

void write_solver(hid_t file, const SolverReport& report, const ResultInfo& info) {
  hdf5::Handle group = netcdf4::create_group(file, "solver");
  netcdf4::write_attributes(group, {{"converged", std::int32_t{report.converged}},
                                    {"sweeps", std::int32_t{report.sweeps}},
                                    {"estimated_error", report.estimated_error},
                                    {"gather_rescaling", report.gather_rescaling},
                                    {"control_points", std::int32_t{report.control_points}},
                                    {"directions", report.directions},
                                    {"mode", report.mode},
                                    {"active_voxels", static_cast<std::int64_t>(report.active_voxels)},
                                    {"threads", std::int32_t{report.threads}},
                                    {"seconds_total", report.seconds_total},
                                    {"seconds_tables", report.seconds_tables},
                                    {"seconds_beam", report.seconds_beam},
                                    {"seconds_sweeps", report.seconds_sweeps},
                                    {"seconds_scattering", report.seconds_scattering},
                                    {"seconds_acceleration", report.seconds_acceleration},
                                    {"seconds_gather", report.seconds_gather},
                                    {"cpu_seconds", report.cpu_seconds},
                                    {"peak_memory_bytes", static_cast<std::int64_t>(report.peak_memory_bytes)},
                                    {"fit_closure", report.fit_closure},
                                    {"fit_max_error", report.fit_max_error},
                                    {"fit_fallbacks", std::int32_t{report.fit_fallbacks}},
                                    {"surface_largest_albedo", report.surface_largest_albedo},
                                    {"surface_largest_correction", report.surface_largest_correction}});
  if (info.phase_classes > 0) {
    netcdf4::write_attributes(
        group, {{"phase_classes", std::int32_t{info.phase_classes}}, {"phase_class_error", info.phase_class_error}});
  }
  group.close();
}

std::span<const std::int32_t> flattened(const std::vector<std::array<std::int32_t, 3>>& triples) {
  return {triples.empty() ? nullptr : triples.front().data(), 3 * triples.size()};
}

void write_radiance_field(hid_t file, const RadianceField& field) {
  hdf5::Handle group = netcdf4::create_group(file, "radiance_field");
  netcdf4::write_attributes(
      group, {{"frame", "axes of the domain: x, y horizontal, z up"},
              {"interpolation",
               "the radiance along a direction of travel is the mean of the radiances at the corners of "
               "the triangle that holds it, weighted by the areas of the spherical triangles that it forms with the "
               "sides opposite to the corners"}});
  netcdf4::write_dimension(group, "control_point", field.direction.size());
  netcdf4::write_dimension(group, "active_voxel", field.voxel.size());
  netcdf4::write_dimension(group, "face", field.triangle.size());
  netcdf4::write_dimension(group, "corner", 3);
  netcdf4::write_dimension(group, "axis", 3);

  std::vector<double> direction;
  for (const Direction& d : field.direction) direction.insert(direction.end(), {d.x(), d.y(), d.z()});
  netcdf4::write_variable(group, "direction", {"control_point", "axis"}, std::span<const double>(direction),
                          {{"units", "1"}, {"long_name", "unit vector in which light travels, at each control point"}});
  netcdf4::write_variable(group, "triangle", {"face", "corner"}, flattened(field.triangle),
                          {{"units", "1"},
                           {"long_name",
                            "control points at the corners of each triangle of the sphere, counter-clockwise seen from "
                            "outside, from 0"}});
  netcdf4::write_variable(group, "voxel", {"active_voxel", "axis"}, flattened(field.voxel),
                          {{"units", "1"}, {"long_name", "cell indices i, j, k along x, y, z, from 0"}});
  netcdf4::write_variable(
      group, "radiance", {"active_voxel", "control_point"}, std::span(field.radiance),
      {{"units", "W m-2 sr-1"},
       {"long_name", "voxel mean of the diffuse radiance of the delta-scaled problem, direct beam excluded"}});
  group.close();
}

void write_all(const std::filesystem::path& path, const Solution& solution, const ResultInfo& info) {
  hdf5::Handle file = hdf5::create_file(path);
  netcdf4::write_attributes(file, {{"Conventions", "CF-1.10"},
                                   {"title", info.title},
                                   {"source", info.source},
                                   {"history", info.history},
                                   {"scene", info.scene}});
  write_fields(file, solution);
  write_profile(file, solution);
  write_summary(file, solution.ledger);
  write_solver(file, solution.report, info);
  write_images(file, solution);
  if (solution.radiance_field) write_radiance_field(file, *solution.radiance_field);
  // After a failed write closing may report success and leave zeros in the file: what is still in memory goes out here,
  // checked.
  hdf5::check(H5Fflush(file, H5F_SCOPE_GLOBAL), "flush a file");
  file.close();
}

}  // namespace

void write_result(const std::filesystem::path& file, const Solution& solution, const ResultInfo& info) {
  assert(solution.box.nz() >= 1);
  AtomicFile target(file);
  try {
    write_all(target.temporary(), solution, info);
  } catch (const hdf5::Error& error) {
    throw_unwritable(file, error.what());
  }
  target.commit();
}

}  // namespace cloudbow
