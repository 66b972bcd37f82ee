// Python as the host of cloudbow's work: interrupts, warnings, progress, the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <string>

#include "app/process/host.hpp"

namespace cloudbow::python {

/// Python functions that a call was handed. Each is None or callable.
struct Callables {
  pybind11::object message;   ///< message(text): notes of the program
  pybind11::object progress;  ///< progress(phase, sweep, estimated_error, energy_residual, fraction)
};

/// Runs `work` without the interpreter's lock. An interrupt (KeyboardInterrupt) ends it at the next sweep or phase, and
/// so does an exception of the callables. Both are raised in Python.
void without_lock(const Callables& callables, const std::function<void()>& work);

/// Libraries of file formats are called with the interpreter's lock, and with that of h5py if it is loaded: HDF5 is one
/// library for both.
void share_file_libraries();

}  // namespace cloudbow::python
