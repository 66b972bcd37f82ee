#include "cloudbow/results/summary.hpp"

#include <fmt/format.h>

#include "cloudbow/results/energy_fluxes.hpp"

namespace cloudbow {

std::string summary_table(const Solution& solution, const std::string& flux_units) {
  const EnergyLedger& ledger = solution.ledger;
  const SolverReport& report = solution.report;
  std::string table;
  const auto line = [&table](std::string_view name, const std::string& value) {
    table += fmt::format("{:<21}{}\n", name, value);
  };
  const auto fraction = [](double value) { return fmt::format("{:9.6f}", value); };

  if (solution.emits) {
    const EnergyFluxes energy = energy_fluxes(ledger);
    const auto flux = [&](double value) { return fmt::format("{:9.4g} {}", value, flux_units); };
    line("flux up at the top", flux(energy.upwelling_top));
    line("flux down, ground",
         flux(energy.downwelling_bottom) +
             (solution.sun ? fmt::format("   direct {:.4g}", energy.direct_bottom) : std::string()));
    line("net absorbed by air", flux(energy.absorbed));
    line("net absorbed, ground", flux(energy.surface_net()));
    if (!solution.box.periodic) {
      line("side gain", flux(energy.side_gain));
      line("side loss", flux(energy.side_loss));
    }
  } else {
    line("reflectance", fraction(ledger.reflectance));
    line("transmittance",
         fmt::format("{}   direct {:.6f}", fraction(ledger.transmittance), ledger.transmittance_direct));
    line("absorptance", fraction(ledger.absorptance));
    line("surface absorptance", fraction(ledger.surface_absorptance));
    if (!solution.box.periodic) {
      line("side gain", fraction(ledger.side_gain));
      line("side loss", fraction(ledger.side_loss));
    }
  }
  if (report.added_levels > 0)
    line("levels", fmt::format(" {} more, because light fades within a voxel", report.added_levels));
  if (report.column_parts_x * report.column_parts_y > 1) {
    line("columns", fmt::format(" in {} x {} parts: light fades across their voxels", report.column_parts_x,
                                report.column_parts_y));
  }
  if (report.air_levels > 0) {
    line("layers", fmt::format(" beside clouds in blocks of {} columns or more, in {} level{}",
                               report.air_block_columns, report.air_levels, report.air_levels == 1 ? "" : "s"));
  }
  if (!report.collapsed_axes.empty())
    line("solved as", fmt::format(" {}: nothing varies along {}", report.mode, report.collapsed_axes));
  line("energy residual",
       fmt::format("{:9.1e}{}", ledger.residual, solution.emits ? "   of the power incident and emitted" : ""));
  line("estimated error",
       fmt::format("{:9.1e}   after {} sweep{}", report.estimated_error, report.sweeps, report.sweeps == 1 ? "" : "s"));
  line("time", fmt::format("{:9.2f} s with {} thread{} (tables {:.2f}, beam {:.2f}, sweeps {:.2f}, gather {:.2f})",
                           report.seconds_total, report.threads, report.threads == 1 ? "" : "s", report.seconds_tables,
                           report.seconds_beam, report.seconds_sweeps, report.seconds_gather));
  line("memory", fmt::format("{:9.1f} MB at its peak", static_cast<double>(report.peak_memory_bytes) * 1e-6));
  table += report.converged ? "converged\n"
           : report.stalled ? "NOT CONVERGED: the iteration stalled above its tolerance\n"
                            : "NOT CONVERGED: the estimated error or the energy residual is above its tolerance\n";
  return table;
}

}  // namespace cloudbow
