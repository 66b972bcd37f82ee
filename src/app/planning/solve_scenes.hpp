// The solves of a run.
#pragma once

#include <cstdint>
#include <vector>

#include "app/planning/cost_estimate.hpp"
#include "app/planning/run_options.hpp"
#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/transport/cell_light.hpp"

namespace cloudbow {

/// Solutions of all wavelengths, and the data on their origin in the result file.
struct Solved {
  std::vector<Solution> solutions;
  std::vector<Solution> independent_columns;            ///< of each the same as independent columns, or none
  std::vector<PhaseClassReport> phase_classes;          ///< of each, or none
  std::vector<std::vector<CloudFigures>> clouds;        ///< of each, by constituent
  std::vector<ErrorEstimate> errors;                    ///< of each, or none
  std::vector<std::vector<float>> cloud_optical_depth;  ///< of each, by column, or none
  std::vector<std::vector<float>> cloud_extinction;     ///< of each, by cell, or none
};

/// Errors of a solution of the scene, from coarse solves. @param light of the solution, given up. @param ranks that
/// make them; the first has the estimate.
/// @throws Interrupted.
ErrorEstimate estimate_of(const Scene& scene, const PlannedScene& planned, const Solution& solution, CellLight light,
                          Ranks* ranks = nullptr);

/// @throws Interrupted.
Solved solve_all(const std::vector<Scene>& scenes, CostEstimate cost, const RunOptions& options,
                 std::uint64_t available, CloudFiles& files);

}  // namespace cloudbow
