// The converged source in any direction: scattered light from the control points, the direct beam's first scattering
// from its phase function itself.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "cloudbow/sphere/control_points.hpp"
#include "transport/scattering/scattering.hpp"

namespace cloudbow {

/// First scattering of a beam: source = phase(Omega . sun) * intensity[n].
template <class Real>
struct SingleScattering {
  std::function<double(double)> phase;
  std::vector<Real> intensity;
};

/// The source in one direction, as the terms of its sum.
template <class Real>
struct SourceAlong {
  struct Term {
    Real weight;
    const Real* at_cells;  ///< [n]
  };
  struct PointTerm {
    Real weight;
    FieldRow<Real> at_cells;
  };
  bool any_points = false;
  std::array<PointTerm, 3> points;  ///< if there are any
  std::vector<Term> first_order;
  Term emission{};  ///< null: none

  /// Source of the cells [first, first + n).
  void fill(std::size_t first, std::size_t n, Real* source) const;

 private:
  void fill_scattered(std::size_t first, std::size_t n, Real* source) const;
};

template <class Real>
struct DirectionalSource {
  ControlPoints points;
  AngularField<Real> at_points;  ///< orders >= 2 (and the first of sky and surface light); no rows: none
  Direction sun_travel = -Direction::UnitZ();
  std::vector<SingleScattering<Real>> first_order;
  CellEmission<Real> emission{};  ///< thermal, the same in all directions; its arrays are those of the cells

  /// Source for light that travels along `direction`: three streams times three weights, and one more a beam.
  SourceAlong<Real> along(const Direction& direction, double scale = 1) const;
  /// The same of all cells, evaluated.
  void query(const Direction& direction, Real* source) const;
};

}  // namespace cloudbow
