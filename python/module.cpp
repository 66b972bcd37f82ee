// The extension module cloudbow._core: calls of the app layer, with plain arguments. Python code in cloudbow/ makes the
// interface for users of them.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "app/commands/mie_command.hpp"
#include "app/commands/phase_options.hpp"
#include "app/process/version.hpp"
#include "app/runs/run.hpp"
#include "app/runs/sweep.hpp"
#include "app/verify/verify.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/printable.hpp"
#include "clouds.hpp"
#include "host.hpp"

namespace py = pybind11;

namespace cloudbow::python {
namespace {

/// How a result shows its scene.
struct SceneText {
  std::string text;                          ///< empty: that of the file
  std::map<std::string, std::string> shown;  ///< names of temporary files, and what stands in their places

  void apply_to(std::string& scene) const {
    if (!text.empty()) scene = text;
    for (const auto& [file, instead] : shown) {
      for (std::size_t at = scene.find(file); at != std::string::npos; at = scene.find(file, at + instead.size()))
        scene.replace(at, file.size(), instead);
    }
  }
};

/// @returns sentences on what did not converge
std::vector<std::string> run_scene(const RunOptions& options, const SceneText& scene_text, const Callables& callables) {
  std::vector<std::string> sentences;
  without_lock(callables, [&] {
    const PreparedRun prepared = prepare_run(options);
    SolvedRun solved = solve_run(prepared.scenes, options);
    scene_text.apply_to(solved.info.scene);
    write_run(prepared.output, solved, options.threads);
    sentences = shortcomings(solved, "the result");
  });
  return sentences;
}

RunEstimate check_scene(const RunOptions& options, const Callables& callables) {
  RunEstimate estimate;
  without_lock(callables, [&] { estimate = estimate_run(prepare_run(options).scenes, options); });
  return estimate;
}

/// Lists of a sweep: (key, values as --set takes them, whether they are a dimension).
using Lists = std::vector<std::tuple<std::string, std::vector<std::string>, bool>>;

/// @returns exit code and sentences on runs that failed or did not converge
SweepOutcome sweep_scene(const RunOptions& run, const Lists& lists, int jobs, const SceneText& scene_text,
                         const Callables& callables) {
  SweepOptions options{run, {}, jobs, [&scene_text](std::string& scene) { scene_text.apply_to(scene); }};
  for (const auto& [key, values, is_list] : lists) options.keys.push_back({key, values, is_list});
  SweepOutcome outcome;
  without_lock(callables, [&] {
    for (const SweptKey& key : options.keys) check_values(key);
    outcome = solve_sweep(options, plan_sweep(options));
  });
  return outcome;
}

/// Values of a list as the command line has it, and whether it is a dimension.
std::pair<std::vector<std::string>, bool> swept_values(const std::string& key, const std::string& list) {
  try {
    const SweptKey swept = parse_swept_key(key + "=" + list);
    return {swept.values, swept.is_list};
  } catch (const InputError& error) {
    const std::string message = error.what(), option = "--set ";
    throw InputError(message.starts_with(option) ? message.substr(option.size()) : message);
  }
}

/// Checks of `cloudbow verify`, one by one: (name, statement, unit, tolerance, found, passed, error, seconds).
py::list carry_out_checks(const std::vector<std::string>& only) {
  py::list outcomes;
  for (const PhysicalCheck& check : physical_checks()) {
    if (!only.empty() && std::find(only.begin(), only.end(), check.name) == only.end()) continue;
    CheckOutcome outcome;
    without_lock({py::none(), py::none()}, [&] { outcome = carry_out(check); });
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    outcomes.append(py::make_tuple(check.name, check.statement, check.unit, check.tolerance, outcome.found,
                                   outcome.passed, outcome.error, outcome.seconds));
  }
  return outcomes;
}

std::vector<std::string> check_names() {
  std::vector<std::string> names;
  for (const PhysicalCheck& check : physical_checks()) names.push_back(check.name);
  return names;
}

/// A class for the options of a command, which then prints nothing.
template <class Options>
py::class_<Options> class_of_options(py::module_& module, const char* name) {
  return py::class_<Options>(module, name).def(py::init([] {
    Options options;
    options.quiet = true;
    return options;
  }));
}

/// InputError of C++ is that of the Python package.
void translate_errors(std::exception_ptr error) {
  try {
    if (error) std::rethrow_exception(error);
  } catch (const InputError& wrong) {
    const py::object type = py::module_::import("cloudbow._errors").attr("InputError");
    PyErr_SetString(type.ptr(), printable(wrong.what()).c_str());
  }
}

}  // namespace
}  // namespace cloudbow::python

PYBIND11_MODULE(_core, module) {
  using namespace cloudbow;
  using namespace cloudbow::python;
  share_file_libraries();
  py::register_exception_translator(translate_errors);
  module.attr("version") = version();

  class_of_options<RunOptions>(module, "RunOptions")
      .def_readwrite("scene", &RunOptions::scene)
      .def_readwrite("overrides", &RunOptions::overrides)
      .def_readwrite("output", &RunOptions::output)
      .def_readwrite("threads", &RunOptions::threads)
      .def_readwrite("compare", &RunOptions::compare)
      .def_readwrite("clear_sky", &RunOptions::clear_sky)
      .def_readwrite("dry_run", &RunOptions::dry_run)
      .def_readwrite("command", &RunOptions::command);
  py::class_<RunEstimate>(module, "RunEstimate")
      .def_readonly("cells", &RunEstimate::cells)
      .def_readonly("active_cells", &RunEstimate::active_cells)
      .def_readonly("memory_bytes", &RunEstimate::memory_bytes)
      .def_readonly("available_bytes", &RunEstimate::available_bytes)
      .def_readonly("seconds", &RunEstimate::seconds)
      .def_readonly("text", &RunEstimate::text);
  module.def(
      "run",
      [](const RunOptions& options, const std::string& scene_text, const std::map<std::string, std::string>& shown,
         const py::object& message, const py::object& progress) {
        return run_scene(options, {scene_text, shown}, {message, progress});
      },
      py::arg("options"), py::arg("scene_text"), py::arg("shown"), py::arg("message"), py::arg("progress"));
  py::class_<SweepOutcome>(module, "SweepOutcome")
      .def_readonly("exit_code", &SweepOutcome::exit_code)
      .def_readonly("written", &SweepOutcome::written)
      .def_readonly("sentences", &SweepOutcome::sentences);
  module.def("swept_values", &swept_values, py::arg("key"), py::arg("list"));
  module.def(
      "sweep",
      [](const RunOptions& options, const Lists& lists, int jobs, const std::map<std::string, std::string>& shown,
         const py::object& message, const py::object& progress) {
        return sweep_scene(options, lists, jobs, {"", shown}, {message, progress});
      },
      py::arg("options"), py::arg("lists"), py::arg("jobs"), py::arg("shown"), py::arg("message"), py::arg("progress"));
  module.def(
      "check",
      [](const RunOptions& options, const py::object& message) {
        return check_scene(options, {message, py::none()});
      },
      py::arg("options"), py::arg("message"));

  class_of_options<MieOptions>(module, "MieOptions")
      .def_readwrite("wavelength_um", &MieOptions::wavelength_um)
      .def_readwrite("effective_radius_um", &MieOptions::effective_radius_um)
      .def_readwrite("distribution", &MieOptions::distribution)
      .def_readwrite("variance", &MieOptions::variance)
      .def_readwrite("substance", &MieOptions::substance)
      .def_readwrite("refractive_index", &MieOptions::refractive_index)
      .def_readwrite("density_g_cm3", &MieOptions::density_g_cm3)
      .def_readwrite("output", &MieOptions::output)
      .def_readwrite("threads", &MieOptions::threads)
      .def_readwrite("command", &MieOptions::command);
  module.def(
      "mie",
      [](const MieOptions& options, const py::object& message, const py::object& progress) {
        without_lock({message, progress}, [&] { make_mie_file(options); });
      },
      py::arg("options"), py::arg("message"), py::arg("progress"));

  class_of_options<PhaseOptions>(module, "PhaseOptions")
      .def_readwrite("type", &PhaseOptions::type)
      .def_readwrite("asymmetry_parameter", &PhaseOptions::asymmetry_parameter)
      .def_readwrite("forward_asymmetry_parameter", &PhaseOptions::forward_asymmetry_parameter)
      .def_readwrite("backward_asymmetry_parameter", &PhaseOptions::backward_asymmetry_parameter)
      .def_readwrite("forward_weight", &PhaseOptions::forward_weight)
      .def_readwrite("file", &PhaseOptions::file)
      .def_readwrite("control_points", &PhaseOptions::control_points)
      .def_readwrite("delta_m_order", &PhaseOptions::delta_m_order)
      .def_readwrite("fits", &PhaseOptions::fits)
      .def_readwrite("output", &PhaseOptions::output)
      .def_readwrite("command", &PhaseOptions::command);
  module.def(
      "phase",
      [](const PhaseOptions& options, const py::object& message) {
        without_lock({message, py::none()}, [&] { phase(options); });
      },
      py::arg("options"), py::arg("message"));

  module.def("verify", &carry_out_checks, py::arg("only"));
  module.def("check_names", &check_names);
  add_clouds(module);
}
