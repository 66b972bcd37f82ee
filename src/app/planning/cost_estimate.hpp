// Cost of a run, computed before the first solve.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/planning/error_calibration.hpp"
#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/medium/cloud_files.hpp"
#include "cloudbow/transport/solve_plan.hpp"

namespace cloudbow {

/// A scene and how it is solved.
struct PlannedScene {
  PlannedScene(AssembledScene scene, std::string accuracy);
  /// Plan of the coarse solve of the error estimate. It may take as much memory as the scene: kept no longer than
  /// needed.
  SolvePlan coarse() const;

  std::shared_ptr<const AssembledScene> scene;
  SolvePlan plan;
  SolvedAs as;
  std::string accuracy;  ///< its level
};

/// @param levels_m as LevelOptions::levels_m
PlannedScene plan_scene(const Scene& scene, std::uint64_t available, CloudFiles& files,
                        const std::vector<double>& levels_m, int threads);

/// The scene with its mode of solution: `spectrum.method` sets it too.
Scene as_solved(Scene scene);

/// Resources that a run needs, computed before the first solve.
struct CostEstimate {
  std::size_t memory = 0;             ///< bytes, of the most demanding wavelength, with the results of all
  double seconds = 0;                 ///< of all wavelengths, on this machine
  std::vector<double> solve_seconds;  ///< of each wavelength or g-point, on the machine of predict_seconds()
  std::vector<double> levels_m;       ///< that serve all wavelengths; empty: there is one scene only
  std::optional<PlannedScene> only;   ///< that scene
};

/// Of the g-points of a broadband run that are solved, so many have an error estimate.
inline constexpr std::size_t estimated_points = 2;

/// "0.0684 GB", "1.5 s": digits that small runs have too.
std::string memory_text(std::size_t bytes);
std::string time_text(double seconds);

/// Looks at every wavelength, so that none fails after others were solved.
/// @param compare whether the same is solved as independent columns too
/// @param ranks that share each solve: memory is that of each
CostEstimate estimate_cost(const std::vector<Scene>& scenes, std::uint64_t available, int threads, bool compare,
                           CloudFiles& files, int ranks = 1);

/// Peak memory [bytes] of run() for the wavelengths of a scene.
/// @param available bytes that the optical grid may take. @throws InputError as assemble().
std::size_t predicted_memory(const std::vector<Scene>& scenes, std::uint64_t available, int threads);

/// Options for the same scene as independent columns, of which only fluxes are requested.
SolverOptions with_independent_columns(SolverOptions options);

}  // namespace cloudbow
