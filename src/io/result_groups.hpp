// Groups of a result file that contain attributes alone.
#pragma once

#include "io/solution_writer.hpp"

namespace cloudbow {

/// Fractions of the incident power; of scenes that emit, the residual alone.
void write_summary(hid_t file, const SolutionWriter& writer);
/// The energy ledger in W m-2.
void write_ledger(hid_t file, const SolutionWriter& writer);
/// Names and amounts of the constituents of the clouds; nothing if they have no names.
void write_cloud(hid_t file, const SolutionWriter& writer);
/// Spectral interval and temperatures of emission; nothing without them.
void write_thermal(hid_t file, const SolutionWriter& writer);
/// G-points of a sum over a gas model; nothing without one.
void write_spectral(hid_t file, const SolutionWriter& writer);
void write_solver(hid_t file, const SolutionWriter& writer);
/// Nothing without estimates.
void write_error_estimate(hid_t file, const SolutionWriter& writer);
/// Nothing without a target.
void write_target_report(hid_t file, const SolutionWriter& writer);

}  // namespace cloudbow
