#include "io/result_groups.hpp"

#include <fmt/format.h>

#include <string>

#include "cloudbow/results/energy_fluxes.hpp"

namespace cloudbow {

void write_summary(hid_t file, const SolutionWriter& writer) {
  hdf5::Handle group = netcdf4::create_group(file, "summary");
  const auto of = [&writer](double EnergyLedger::*term) {
    return writer.each([term](const Solution& s) { return s.ledger.*term; });
  };
  // Fractions of incident and emitted power together have no name in the field.
  if (!writer.emits()) {
    netcdf4::write_attributes(group, {{"reflectance", of(&EnergyLedger::reflectance)},
                                      {"transmittance", of(&EnergyLedger::transmittance)},
                                      {"transmittance_direct", of(&EnergyLedger::transmittance_direct)},
                                      {"absorptance", of(&EnergyLedger::absorptance)},
                                      {"surface_absorptance", of(&EnergyLedger::surface_absorptance)},
                                      {"side_gain", of(&EnergyLedger::side_gain)},
                                      {"side_loss", of(&EnergyLedger::side_loss)}});
  }
  netcdf4::write_attribute(group, {"energy_residual", of(&EnergyLedger::residual)});
  group.close();
}

void write_ledger(hid_t file, const SolutionWriter& writer) {
  hdf5::Handle group = netcdf4::create_group(file, "ledger");
  const auto of = [&writer](double EnergyFluxes::*term) {
    return writer.each([term](const Solution& s) { return energy_fluxes(s.ledger).*term; });
  };
  netcdf4::write_attributes(group, {{"units", writer.units("W m-2")},
                                    {"power", writer.each([](const Solution& s) { return s.ledger.power; })},
                                    {"incident", of(&EnergyFluxes::incident)},
                                    {"surface_emitted", of(&EnergyFluxes::surface_emitted)},
                                    {"upwelling_top", of(&EnergyFluxes::upwelling_top)},
                                    {"downwelling_bottom", of(&EnergyFluxes::downwelling_bottom)},
                                    {"direct_bottom", of(&EnergyFluxes::direct_bottom)},
                                    {"absorbed", of(&EnergyFluxes::absorbed)},
                                    {"surface_absorbed", of(&EnergyFluxes::surface_absorbed)},
                                    {"side_gain", of(&EnergyFluxes::side_gain)},
                                    {"side_loss", of(&EnergyFluxes::side_loss)},
                                    {"residual", of(&EnergyFluxes::residual)}});
  group.close();
}

void write_cloud(hid_t file, const SolutionWriter& writer) {
  const std::vector<ConstituentInfo>& constituents = writer.info().constituents;
  if (constituents.empty()) return;
  hdf5::Handle group = netcdf4::create_group(file, "cloud");
  std::string names;
  for (const ConstituentInfo& constituent : constituents)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", constituent.name);
  netcdf4::write_attribute(group, {"constituents", names});
  for (const ConstituentInfo& constituent : constituents) {
    if (!constituent.optical_depth.empty())
      netcdf4::write_attribute(group, {"optical_depth_" + constituent.name, writer.each(constituent.optical_depth)});
    if (!constituent.water_path_g_m2.empty())
      netcdf4::write_attribute(group, {"water_path_" + constituent.name, writer.each(constituent.water_path_g_m2)});
  }
  group.close();
}

void write_thermal(hid_t file, const SolutionWriter& writer) {
  const std::vector<ThermalInfo>& thermal = writer.info().thermal;
  if (thermal.empty()) return;
  const ThermalInfo& first = thermal.front();
  hdf5::Handle group = netcdf4::create_group(file, "thermal");
  if (first.wavelength_um) {
    std::vector<double> wavelength;
    for (const ThermalInfo& of : thermal) wavelength.push_back(*of.wavelength_um);
    netcdf4::write_attribute(group, {"wavelength_um", writer.each(wavelength)});
  }
  if (first.band_um)
    netcdf4::write_attribute(group, {"band_um", std::vector<double>(first.band_um->begin(), first.band_um->end())});
  netcdf4::write_attribute(group, {"atmosphere", first.atmosphere});
  if (first.surface_temperature_k)
    netcdf4::write_attribute(group, {"surface_temperature_k", *first.surface_temperature_k});
  if (!first.surface_temperature_map.empty())
    netcdf4::write_attribute(group, {"surface_temperature_map", first.surface_temperature_map});
  if (!first.cloud_temperature_grid.empty())
    netcdf4::write_attribute(group, {"cloud_temperature_grid", first.cloud_temperature_grid});
  if (first.sky_temperature_k) netcdf4::write_attribute(group, {"sky_temperature_k", *first.sky_temperature_k});
  group.close();
}

void write_spectral(hid_t file, const SolutionWriter& writer) {
  if (!writer.info().spectral) return;
  const SpectralInfo& spectral = *writer.info().spectral;
  hdf5::Handle group = netcdf4::create_group(file, "spectral");
  std::vector<double> solved(spectral.solved.begin(), spectral.solved.end());
  netcdf4::write_attributes(group, {{"gas_model", spectral.model},
                                    {"light", spectral.light},
                                    {"method", spectral.method},
                                    {"g_points", static_cast<std::int32_t>(spectral.points)},
                                    {"solved", solved},
                                    {"weight", spectral.weight},
                                    {"residual", spectral.residual}});
  group.close();
}

void write_solver(hid_t file, const SolutionWriter& writer) {
  hdf5::Handle group = netcdf4::create_group(file, "solver");
  const auto real = [&writer](double SolverReport::*term) {
    return writer.each([term](const Solution& s) { return s.report.*term; });
  };
  const auto whole = [&writer](int SolverReport::*term) {
    return writer.each([term](const Solution& s) { return std::int32_t{s.report.*term}; });
  };
  const auto size = [&writer](std::size_t SolverReport::*term) {
    return writer.each([term](const Solution& s) { return static_cast<std::int64_t>(s.report.*term); });
  };
  using R = SolverReport;
  netcdf4::write_attributes(
      group, {{"converged", writer.each([](const Solution& s) { return std::int32_t{s.report.converged}; })},
              {"stalled", writer.each([](const Solution& s) { return std::int32_t{s.report.stalled}; })},
              {"sweeps", whole(&R::sweeps)},
              {"estimated_error", real(&R::estimated_error)},
              {"gather_rescaling", real(&R::gather_rescaling)},
              {"control_points", whole(&R::control_points)},
              {"directions", writer.first().report.directions},
              {"radiance_storage", writer.first().report.radiance_storage},
              {"mode", writer.first().report.mode},
              {"left_out_axes", writer.first().report.collapsed_axes},
              {"added_levels", whole(&R::added_levels)},
              {"column_parts_x", whole(&R::column_parts_x)},
              {"column_parts_y", whole(&R::column_parts_y)},
              {"air", writer.first().report.air},
              {"air_levels", whole(&R::air_levels)},
              {"air_block_columns", whole(&R::air_block_columns)},
              {"air_error", real(&R::air_error)},
              {"active_voxels", size(&R::active_voxels)},
              {"threads", whole(&R::threads)},
              {"seconds_total", real(&R::seconds_total)},
              {"seconds_tables", real(&R::seconds_tables)},
              {"seconds_beam", real(&R::seconds_beam)},
              {"seconds_sweeps", real(&R::seconds_sweeps)},
              {"seconds_scattering", real(&R::seconds_scattering)},
              {"seconds_acceleration", real(&R::seconds_acceleration)},
              {"seconds_gather", real(&R::seconds_gather)},
              {"cpu_seconds", real(&R::cpu_seconds)},
              {"peak_memory_bytes", size(&R::peak_memory_bytes)},
              {"fit_closure", real(&R::fit_closure)},
              {"fit_max_error", real(&R::fit_max_error)},
              {"fit_fallbacks", whole(&R::fit_fallbacks)},
              {"surface_largest_albedo", real(&R::surface_largest_albedo)},
              {"surface_largest_correction", real(&R::surface_largest_correction)}});
  if (!writer.info().phase_classes.empty()) {
    netcdf4::write_attributes(group, {{"phase_classes", writer.each(writer.info().phase_classes)},
                                      {"phase_class_error", writer.each(writer.info().phase_class_error)}});
  }
  group.close();
}

void write_error_estimate(hid_t file, const SolutionWriter& writer) {
  const std::vector<ErrorEstimate>& estimates = writer.info().error_estimates;
  if (estimates.empty()) return;
  const auto of = [&](const auto& number_of) {
    if (!writer.spectral()) return netcdf4::AttributeValue(number_of(estimates.front()));
    std::vector<double> all;
    for (const ErrorEstimate& estimate : estimates) all.push_back(number_of(estimate));
    return netcdf4::AttributeValue(all);
  };
  hdf5::Handle group = netcdf4::create_group(file, "error_estimate");
  netcdf4::write_attributes(
      group,
      {{"units", "1"},
       {"comment",
        fmt::format("domain: of the mean fluxes up and down, fraction of {}; columns: up at the highest and down at "
                    "the lowest level, RMS over the columns / mean; columns_between: up or down, at the worst of the "
                    "other levels; 0 without any",
                    writer.emits() ? "the ledger's power, incident and emitted" : "incident")}});
  struct Named {
    const char* name;
    ErrorParts ErrorEstimate::*parts;
    double ByFlux::*distance;
  };
  for (const Named& flux :
       {Named{"domain", &ErrorEstimate::domain, &ByFlux::domain}, Named{"columns_up", &ErrorEstimate::up, &ByFlux::up},
        Named{"columns_down", &ErrorEstimate::down, &ByFlux::down}}) {
    const auto part = [&](double ErrorParts::*which) {
      return of([&](const ErrorEstimate& estimate) { return estimate.*flux.parts.*which; });
    };
    const std::string name = flux.name;
    netcdf4::write_attributes(
        group, {{name, of([&](const ErrorEstimate& estimate) { return (estimate.*flux.parts).total(); })},
                {name + "_angular", part(&ErrorParts::angular)},
                {name + "_spatial", part(&ErrorParts::spatial)},
                {name + "_iteration", part(&ErrorParts::iteration)},
                {name + "_spectral", part(&ErrorParts::spectral)},
                {name + "_angular_distance",
                 of([&](const ErrorEstimate& estimate) { return estimate.angular_distance.*flux.distance; })},
                {name + "_spatial_distance",
                 of([&](const ErrorEstimate& estimate) { return estimate.spatial_distance.*flux.distance; })},
                {name + "_probe_distance",
                 of([&](const ErrorEstimate& estimate) { return estimate.probe_distance.*flux.distance; })}});
  }
  netcdf4::write_attributes(group,
                            {{"columns", of([](const ErrorEstimate& estimate) { return estimate.columns(); })},
                             {"columns_between", of([](const ErrorEstimate& e) { return e.between_ends; })},
                             {"cpu_seconds", of([](const ErrorEstimate& estimate) { return estimate.cpu_seconds; })},
                             {"calibrated_for", estimates.front().calibrated_for}});
  group.close();
}

void write_target_report(hid_t file, const SolutionWriter& writer) {
  if (!writer.info().target) return;
  const TargetReport& report = *writer.info().target;
  hdf5::Handle group = netcdf4::create_group(file, "plan");
  if (report.target_error)
    netcdf4::write_attributes(group, {{"target_error", *report.target_error}, {"of", report.of}});
  if (report.budget_seconds) netcdf4::write_attributes(group, {{"budget_seconds", *report.budget_seconds}});
  netcdf4::write_attributes(group, {{"accuracy", report.accuracy},
                                    {"levels_solved", report.levels_solved},
                                    {"predicted_error", report.predicted_error},
                                    {"predicted_seconds", report.predicted_seconds},
                                    {"seconds", report.seconds},
                                    {"predicted_memory_bytes", report.predicted_memory_bytes},
                                    {"seconds_in_all", report.seconds_in_all},
                                    {"met", std::int32_t{report.met}}});
  group.close();
}

}  // namespace cloudbow
