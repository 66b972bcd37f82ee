// How quick this machine is beside the one that predict_seconds() was made on.
#pragma once

namespace cloudbow {

/// Factor on predicted seconds: what `cloudbow verify --calibrate` has stored beside the table cache, else 1.
double machine_slowness();

/// Measures it by a fixed solve of a second or so, on all processors, and stores it. @returns the factor.
/// @throws InputError where it cannot be stored.
double calibrate_machine();

}  // namespace cloudbow
