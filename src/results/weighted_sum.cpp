#include "cloudbow/results/weighted_sum.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "cloudbow/transport/output_fields.hpp"

namespace cloudbow {
namespace {

[[noreturn]] void refuse() { throw std::invalid_argument("solutions of different grids do not add up"); }

template <class Value>
void add(const std::vector<Value>& of, double weight, std::vector<Value>& sum) {
  if (sum.empty()) sum.assign(of.size(), Value(0));
  if (sum.size() != of.size()) refuse();
  for (std::size_t n = 0; n < of.size(); ++n) {
    // The weight 1 leaves the bits, so that a sum over all is that of single runs.
    sum[n] += weight == 1 ? of[n] : static_cast<Value>(weight * static_cast<double>(of[n]));
  }
}

/// Terms of the ledger that are fractions of its power.
constexpr double EnergyLedger::*fractions[] = {&EnergyLedger::incident,
                                               &EnergyLedger::surface_emission,
                                               &EnergyLedger::reflectance,
                                               &EnergyLedger::transmittance,
                                               &EnergyLedger::transmittance_direct,
                                               &EnergyLedger::absorptance,
                                               &EnergyLedger::surface_absorptance,
                                               &EnergyLedger::side_gain,
                                               &EnergyLedger::side_loss,
                                               &EnergyLedger::residual};

void add(const EnergyLedger& of, double weight, EnergyLedger& sum) {
  const double power = sum.power + weight * of.power;
  for (const auto term : fractions) {
    // A product and a quotient could change the last bit of the only solution with power.
    sum.*term = sum.power > 0 && of.power > 0 ? (sum.power * (sum.*term) + weight * of.power * (of.*term)) / power
                : sum.power > 0               ? sum.*term
                                              : of.*term;
  }
  sum.power = power;
}

// @param share of the new part in the power of the sum.
void add(const SolverReport& of, bool first, double share, SolverReport& sum) {
  if (first) {
    sum = of;
    return;
  }
  sum.converged = sum.converged && of.converged;
  sum.stalled = sum.stalled || of.stalled;
  sum.sweeps = std::max(sum.sweeps, of.sweeps);
  sum.estimated_error = std::max(sum.estimated_error, of.estimated_error);
  if (std::abs(of.gather_rescaling - 1) > std::abs(sum.gather_rescaling - 1))
    sum.gather_rescaling = of.gather_rescaling;
  sum.peak_memory_bytes = std::max(sum.peak_memory_bytes, of.peak_memory_bytes);
  sum.active_voxels = std::max(sum.active_voxels, of.active_voxels);
  // The same pattern is lost in all parts: their errors add up like the fluxes.
  sum.air_error += share * (of.air_error - sum.air_error);
  if (of.air_block_columns > 0) sum.air_block_columns = std::min(sum.air_block_columns, of.air_block_columns);
  sum.fit_closure = std::max(sum.fit_closure, of.fit_closure);
  sum.fit_max_error = std::max(sum.fit_max_error, of.fit_max_error);
  sum.fit_fallbacks += of.fit_fallbacks;
  for (const auto seconds :
       {&SolverReport::seconds_total, &SolverReport::seconds_tables, &SolverReport::seconds_beam,
        &SolverReport::seconds_sweeps, &SolverReport::seconds_scattering, &SolverReport::seconds_acceleration,
        &SolverReport::seconds_gather, &SolverReport::cpu_seconds})
    sum.*seconds += of.*seconds;
}

}  // namespace

void add_weighted(Solution& sum, const Solution& solution, double weight) {
  const bool first = sum.flux_level.empty();
  if (first) {
    sum.box = solution.box;
    sum.sun = solution.sun;
    if (sum.sun) sum.sun->irradiance = 0;
    sum.flux_level = solution.flux_level;
    sum.ledger.incident = 0;
    for (const RadianceImage& image : solution.images) sum.images.push_back({image.view, {}});
    for (const CameraImage& image : solution.camera_images) sum.camera_images.push_back({image.camera, {}});
  }
  if (sum.flux_level != solution.flux_level || sum.box.z_edge_m != solution.box.z_edge_m ||
      sum.images.size() != solution.images.size() || sum.camera_images.size() != solution.camera_images.size())
    refuse();
  if (solution.sun) {
    // A g-point without sunlight may be the first.
    if (!sum.sun) sum.sun = Sun{solution.sun->travel, 0};
    sum.sun->irradiance += weight * solution.sun->irradiance;
  }
  sum.emits = sum.emits || solution.emits;
  for (const OutputField& field : output_fields()) {
    add(solution.*field.values, weight, sum.*field.values);
    if (field.profile != nullptr) add(solution.*field.profile, weight, sum.*field.profile);
  }
  for (std::size_t n = 0; n < sum.images.size(); ++n) add(solution.images[n].radiance, weight, sum.images[n].radiance);
  for (std::size_t n = 0; n < sum.camera_images.size(); ++n)
    add(solution.camera_images[n].radiance, weight, sum.camera_images[n].radiance);
  if (!first && sum.radiance_field.has_value() != solution.radiance_field.has_value()) refuse();
  if (solution.radiance_field) {
    if (first) {
      sum.radiance_field = solution.radiance_field;
      std::fill(sum.radiance_field->radiance.begin(), sum.radiance_field->radiance.end(), 0.F);
    }
    add(solution.radiance_field->radiance, weight, sum.radiance_field->radiance);
  }
  add(solution.ledger, weight, sum.ledger);
  const double share = sum.ledger.power > 0 ? weight * solution.ledger.power / sum.ledger.power : 1;
  add(solution.report, first, share, sum.report);
}

}  // namespace cloudbow
