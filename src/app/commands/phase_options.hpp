// `cloudbow phase` with its options, for the command line and for Python.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/optics/phase_fit.hpp"

namespace cloudbow {

struct PhaseOptions {
  std::string type;
  std::optional<double> asymmetry_parameter;
  std::optional<double> forward_asymmetry_parameter, backward_asymmetry_parameter, forward_weight;
  std::optional<std::string> file;
  int control_points = 162;
  int delta_m_order = 12;
  std::vector<std::string> fits;  ///< names of methods; empty: all
  std::string ordinates;          ///< empty: the solver's for so many control points
  PhaseFitOptions fit;
  std::vector<double> travel;  ///< x, y, z; empty: that of `fit`
  std::filesystem::path plot, output;
  bool quiet = false;
  std::string command;  ///< as the user typed it, for the history of the file it writes
};

/// @returns exit_done. @throws InputError for anything wrong with the options or the files.
int phase(const PhaseOptions& options);

}  // namespace cloudbow
