// Properties of a problem before it is solved. They are computed once. The solve, predictions of its cost and other
// solves of the problem read them.
#pragma once

#include <memory>

#include "cloudbow/transport/options.hpp"
#include "cloudbow/transport/problem.hpp"
#include "cloudbow/transport/reductions.hpp"

namespace cloudbow {

/// Whether columns are solved by polar streams, without azimuths and without iteration: independent columns over a
/// Lambertian ground, if no radiance is requested.
bool solved_by_polar_streams(const Problem& problem, const SolverOptions& options);

class SolvePlan {
 public:
  /// @param problem must last as long as the plan.
  SolvePlan(const Problem& problem, const SolverOptions& options);

  /// The same problem with other options. Properties that do not depend on them are not computed again.
  SolvePlan with(const SolverOptions& options) const;

  const Problem& whole() const { return *whole_; }                       ///< as given
  const SolverOptions& whole_options() const { return whole_options_; }  ///< as given
  UniformAxes collapsed_axes() const { return collapsed_axes_; }         ///< of the whole; none unless requested
  /// Without these axes; with layers in the voxels' own cells, if light in every voxel is needed.
  const Problem& collapsed() const { return collapsed_ ? *collapsed_ : own_cells_ ? *own_cells_ : *whole_; }
  /// Subdivided levels of the collapsed problem.
  const SubdividedLevels& levels() const { return levels_; }
  int added_levels() const { return levels_.added(collapsed().grid.box); }

  /// Subdivided columns of the collapsed problem.
  SubdividedColumns column_parts() const { return column_parts_; }
  /// The collapsed problem with these levels.
  const Problem& with_levels() const { return subdivided_ ? *subdivided_ : collapsed(); }

  /// The problem and options as solved, without these axes, with these levels and these columns. If cells() is more
  /// than it has, the solve adds its cells without matter.
  const Problem& problem() const { return in_parts_ ? *in_parts_ : with_levels(); }
  const SolverOptions& options() const { return options_; }

  /// One periodic column is all that is solved.
  bool is_one_column() const { return problem().grid.box.periodic && problem().grid.box.columns() == 1; }
  bool by_polar_streams() const { return by_polar_streams_; }
  bool in_double() const { return in_double_; }
  int threads() const { return threads_; }  ///< 0: all that OpenMP gives
  /// Cells for which light is computed: with actinic flux all, else those with matter.
  std::size_t cells() const { return cells_; }

 private:
  explicit SolvePlan(const Problem* whole) : whole_(whole) {}
  void set(const SolverOptions& options, const SolvePlan* other);

  const Problem* whole_;
  SolverOptions whole_options_;
  UniformAxes collapsed_axes_;
  std::shared_ptr<const Problem> own_cells_;  // null: the cells of the whole
  std::shared_ptr<const Problem> collapsed_;  // null: no axis is collapsed
  SubdividedLevels levels_;
  std::shared_ptr<const Problem> subdivided_;  // null: no level is subdivided
  SubdividedColumns column_parts_;
  std::shared_ptr<const Problem> in_parts_;  // null: no column is subdivided
  SolverOptions options_;
  bool by_polar_streams_ = false;
  bool too_thick_for_float_ = false;
  bool in_double_ = false;
  int threads_ = 0;
  std::size_t cells_ = 0;
};

}  // namespace cloudbow
