// The report of `cloudbow phase` on a phase function: its moments, its delta-M form, its fits to control points. As
// text, as a file, as a picture.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cloudbow/optics/phase_fit.hpp"
#include "cloudbow/optics/phase_function.hpp"

namespace cloudbow {

/// One function, as given ("raw") or truncated ("delta-M"), and its fits.
struct FittedFunction {
  std::string name;
  PhaseFunction function;
  std::vector<PhaseFit> fits;
};

struct PhaseReport {
  std::string title;  ///< type and parameters
  int delta_m_order;
  double forward_fraction;  ///< f, 0 if the function has no forward peak
  ControlPoints points;
  std::string ordinates;  ///< name of the quadrature
  PhaseFitOptions options;
  std::vector<FittedFunction> functions;  ///< the raw one first
};

/// Tables for a terminal.
std::string phase_table(const PhaseReport& report);

}  // namespace cloudbow
