// How quick this machine is beside the one that predict_seconds() was made on.
#pragma once

#include <utility>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// First line of the file that keeps the factor. Its number increases when predict_seconds() or the solve that is
/// measured changes: older factors then have another meaning (test_machine_speed.cpp notices the former).
inline constexpr const char* machine_speed_header = "cloudbow machine 4";

/// The solve that is measured.
std::pair<Problem, SolverOptions> calibration_solve();

/// Factor on predicted seconds: that stored by `cloudbow verify --calibrate` beside the table cache, else 1.
double machine_slowness();

/// Seconds of a solve by one thread, without its tables. Time in which other programs had the
/// processor does not count.
double undisturbed_seconds(const SolverReport& report);

/// Measures it by a fixed solve of a second or so and stores it. @returns the factor. One thread solves it and its
/// processor time counts: on a busy machine, wall time and threads that wait for each other measure the other programs.
/// @throws InputError if it cannot be stored.
double calibrate_machine();

}  // namespace cloudbow
