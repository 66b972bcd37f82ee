// Members of solutions and of their error estimates, for ByteWriter and ByteReader. Structured bindings name all
// members: a new one does not compile until it stands here.
#pragma once

#include "cloudbow/core/bytes.hpp"
#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

template <class Archive>
void visit_members(Archive& archive, VoxelPlanes& planes) {
  auto& [count, bottom, height] = planes;
  archive(count, bottom, height);
}

template <class Archive>
void visit_members(Archive& archive, BoxGrid& box) {
  auto& [nx, ny, dx, dy, x_min, y_min, z_edge, periodic, cloud, uniform] = box;
  archive(nx, ny, dx, dy, x_min, y_min, z_edge, periodic, cloud, uniform);
}

template <class Archive>
void visit_members(Archive& archive, Sun& sun) {
  auto& [travel, irradiance] = sun;
  archive(travel, irradiance);
}

template <class Archive>
void visit_members(Archive& archive, View& view) {
  auto& [name, travel, width, height] = view;
  archive(name, travel, width, height);
}

template <class Archive>
void visit_members(Archive& archive, RadianceImage& image) {
  auto& [view, radiance] = image;
  archive(view, radiance);
}

template <class Archive>
void visit_members(Archive& archive, Camera& camera) {
  auto& [name, projection, position, forward, right, up, field_of_view, width, height, rays] = camera;
  archive(name, projection, position, forward, right, up, field_of_view, width, height, rays);
}

template <class Archive>
void visit_members(Archive& archive, CameraImage& image) {
  auto& [camera, radiance] = image;
  archive(camera, radiance);
}

template <class Archive>
void visit_members(Archive& archive, RadianceField& field) {
  auto& [direction, triangle, voxel, radiance] = field;
  archive(direction, triangle, voxel, radiance);
}

template <class Archive>
void visit_members(Archive& archive, EnergyLedger& ledger) {
  auto& [power, incident, emission, reflectance, transmittance, direct, absorptance, by_surface, gain, loss, residual] =
      ledger;
  archive(power, incident, emission, reflectance, transmittance, direct, absorptance, by_surface, gain, loss, residual);
}

template <class Archive>
void visit_members(Archive& archive, SolverReport& report) {
  auto& [converged, stalled, sweeps, estimated_error, gather_rescaling, control_points, directions, mode,
         collapsed_axes, added_levels, column_parts_x, column_parts_y, air, air_levels, air_block_columns, air_error,
         radiance_storage, active_voxels, threads, seconds_total, seconds_tables, seconds_beam, seconds_sweeps,
         seconds_scattering, seconds_acceleration, seconds_gather, cpu_seconds, peak_memory_bytes, fit_closure,
         fit_max_error, fit_fallbacks, largest_albedo, largest_correction] = report;
  archive(converged, stalled, sweeps, estimated_error, gather_rescaling, control_points, directions, mode,
          collapsed_axes, added_levels, column_parts_x, column_parts_y, air, air_levels, air_block_columns, air_error,
          radiance_storage, active_voxels, threads, seconds_total, seconds_tables, seconds_beam, seconds_sweeps,
          seconds_scattering, seconds_acceleration, seconds_gather, cpu_seconds, peak_memory_bytes, fit_closure,
          fit_max_error, fit_fallbacks, largest_albedo, largest_correction);
}

template <class Archive>
void visit_members(Archive& archive, Solution& solution) {
  auto& [box, sun, flux_level, up, down, direct, circumsolar, profile_up, profile_down, profile_direct, emits, absorbed,
         actinic, images, camera_images, radiance_field, ledger, report] = solution;
  archive(box, sun, flux_level, up, down, direct, circumsolar, profile_up, profile_down, profile_direct, emits,
          absorbed, actinic, images, camera_images, radiance_field, ledger, report);
}

template <class Archive>
void visit_members(Archive& archive, ByFlux& by_flux) {
  auto& [domain, up, down] = by_flux;
  archive(domain, up, down);
}

template <class Archive>
void visit_members(Archive& archive, ErrorParts& parts) {
  auto& [angular, spatial, iteration, spectral] = parts;
  archive(angular, spatial, iteration, spectral);
}

template <class Archive>
void visit_members(Archive& archive, ErrorEstimate& estimate) {
  auto& [domain, up, down, between_ends, angular, spatial, probe, cpu_seconds, table_seconds, calibrated_for, up_fields,
         down_fields] = estimate;
  archive(domain, up, down, between_ends, angular, spatial, probe, cpu_seconds, table_seconds, calibrated_for,
          up_fields, down_fields);
}

}  // namespace cloudbow
