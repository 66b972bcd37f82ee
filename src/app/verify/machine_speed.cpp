#include "app/verify/machine_speed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "app/process/cache_directory.hpp"
#include "app/verify/scenes.hpp"
#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

constexpr double least_slowness = .01, most_slowness = 100;  // beyond, it is no measurement

std::filesystem::path speed_file() {
  const std::filesystem::path folder = cache_directory();
  return folder.empty() ? folder : folder / "machine-speed.txt";
}

}  // namespace

std::pair<Problem, SolverOptions> calibration_solve() {
  SolverOptions options = field_options("draft");
  options.threads = 1;
  options.absorption = false;
  return {field_problem(uneven_field(48, 48, 16, .5), 1, PhaseFunction::henyey_greenstein(.85), sun_at(.5, 30)),
          options};
}

double machine_slowness() {
  const std::filesystem::path path = speed_file();
  if (!unreadable_reason(path).empty()) return 1;
  std::ifstream file(path);
  std::string header;
  double factor = 0;
  if (!std::getline(file, header) || header != machine_speed_header || !(file >> factor)) return 1;
  return std::isfinite(factor) && factor >= least_slowness && factor <= most_slowness ? factor : 1;
}

double undisturbed_seconds(const SolverReport& report) {
  const double of_solve = (report.seconds_total - report.seconds_tables) / report.seconds_total;
  return of_solve * std::min(report.cpu_seconds, report.seconds_total);
}

double calibrate_machine() {
  const std::filesystem::path path = speed_file();
  if (path.empty())
    throw InputError("--calibrate: no folder for caches (found neither XDG_CACHE_HOME nor HOME, allowed either)");
  const auto [problem, options] = calibration_solve();
  const double predicted = predict_seconds(SolvePlan(problem, options));
  double least = 0;
  for (int n = 0; n < 3; ++n) {
    const double seconds = undisturbed_seconds(solve(problem, options).report);
    least = n == 0 ? seconds : std::min(least, seconds);
  }
  const double factor = std::clamp(least / predicted, least_slowness, most_slowness);
  write_file_atomically(path, fmt::format("{}\n{:.4g}\n", machine_speed_header, factor));
  return factor;
}

}  // namespace cloudbow
