#include "host.hpp"

#include <memory>
#include <vector>

#include "cloudbow/core/file_library_lock.hpp"

namespace py = pybind11;

namespace cloudbow::python {
namespace {

/// h5py's lock around HDF5, or None if h5py is not loaded. Needs the interpreter's lock.
py::object lock_of_h5py() {
  const py::dict modules = py::module_::import("sys").attr("modules");
  if (!modules.contains("h5py._objects")) return py::none();
  return py::getattr(modules["h5py._objects"], "phil", py::none());
}

/// A lock taken: the interpreter's, and h5py's.
struct Taken {
  py::gil_scoped_acquire interpreter;
  py::object h5py = lock_of_h5py();

  Taken() {
    if (!h5py.is_none()) h5py.attr("acquire")();
  }
  ~Taken() {
    if (!h5py.is_none()) h5py.attr("release")();
  }
  Taken(const Taken&) = delete;
  Taken& operator=(const Taken&) = delete;
};

thread_local std::vector<std::unique_ptr<Taken>> taken;

void lock() { taken.push_back(std::make_unique<Taken>()); }

void unlock() { taken.pop_back(); }

void check_interrupt() {
  const py::gil_scoped_acquire lock;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace

void without_lock(const Callables& callables, const std::function<void()>& work) {
  HostCalls calls;
  calls.check_interrupt = check_interrupt;
  calls.message = [&callables](const std::string& text) {
    const py::gil_scoped_acquire lock;
    if (!callables.message.is_none()) callables.message(text);
  };
  if (!callables.progress.is_none()) {
    calls.progress = [&callables](const SolverProgress& progress) {
      const py::gil_scoped_acquire lock;
      callables.progress(progress.phase, progress.sweep, progress.estimated_error, progress.energy_residual,
                         progress.fraction);
    };
  }
  const py::gil_scoped_release release;
  const HostScope scope(calls);
  work();
}

void share_file_libraries() { FileLibraryLock::use(lock, unlock); }

}  // namespace cloudbow::python
