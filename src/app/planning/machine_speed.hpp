// How quick this machine is beside the one that predict_seconds() was made on.
#pragma once

#include <utility>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// First line of the file that keeps the factor. Its number increases when predict_seconds() or the solve that is
/// measured changes: older factors then have another meaning (test_machine_speed.cpp notices the former).
inline constexpr const char* machine_speed_header = "cloudbow machine 2";

/// The solve that is measured.
std::pair<Problem, SolverOptions> calibration_solve();

/// Factor on predicted seconds: that stored by `cloudbow verify --calibrate` beside the table cache, else 1.
double machine_slowness();

/// Measures it by a fixed solve of a second or so, on all processors, and stores it. @returns the factor.
/// @throws InputError if it cannot be stored.
double calibrate_machine();

}  // namespace cloudbow
