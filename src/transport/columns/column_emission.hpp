// Thermal emission of columns that are solved without iteration, in lanes (docs/theory.md, Eqs. 40a to 40e). v is the
// vector of isotropic light.
//
// In an opaque cell s is nearly 2 v times the Planck radiance, and emission less absorption is a small difference.
// There s is counted from that value, and only the slope of the Planck radiance is a source. Other cells have sources,
// since they may emit much less than a black body. At faces between cells the reference of s jumps.
#pragma once

#include "transport/columns/column_layers.hpp"

namespace cloudbow::columns {

/// Emission of a cell.
template <class Real>
struct Emission {
  Lanes<Real> opaque{};     ///< 1 or 0: whether s is relative to 2 v times the Planck radiance
  Lanes<Real> planck{};     ///< radiance, mean of the cell; 0 in opaque lanes, as is the step
  Lanes<Real> step{};       ///< its value at the bottom less that at the top
  Lanes<Real> gradient{};   ///< its derivative by optical depth in opaque lanes, 0 in others
  Lanes<Real> reference{};  ///< s at the cell's bottom is relative to 2 v times this radiance
  Lanes<Real> jump{};       ///< reference there, less that at the top of the cell below
};

/// Absorption optical depth of a cell from which on it is opaque. In thinner cells, counting s from the Planck radiance
/// would take digits from what they emit; in others, sources would take digits from emission less absorption.
inline constexpr double least_opaque = .25;

/// How a cell emits, and the references at its faces.
struct CellEmission {
  /// @param absorption optical depth. @param mean, bottom_less_top of the Planck radiance.
  CellEmission(double thickness, double absorption, double mean, double bottom_less_top)
      : opaque(absorption > least_opaque),
        planck(mean),
        step(bottom_less_top),
        gradient(step / thickness),
        top(opaque ? planck - .5 * step : 0),
        bottom(opaque ? planck + .5 * step : 0) {}
  bool opaque;
  double planck, step, gradient;
  double top, bottom;
};

/// @param below reference at the top of the cell below, or at the cell's own bottom above the ground
template <class Real>
inline void set_emission(int lane, const CellEmission& cell, double below, Emission<Real>& emission) {
  emission.opaque[lane] = cell.opaque ? 1 : 0;
  emission.planck[lane] = cell.opaque ? 0 : static_cast<Real>(cell.planck);
  emission.step[lane] = cell.opaque ? 0 : static_cast<Real>(cell.step);
  emission.gradient[lane] = cell.opaque ? static_cast<Real>(cell.gradient) : 0;
  emission.reference[lane] = static_cast<Real>(cell.bottom);
  emission.jump[lane] = static_cast<Real>(cell.bottom - below);
}

/// Source b of a thin layer per step of the Planck radiance, over |v| (Eq. 40b).
/// @param absorption optical depth of half of the layer
/// @param loss [n] first row of B without scattering
template <class Real>
inline void make_odd_source(int n, const Lanes<Real>& absorption, const Real* loss, Lanes<Real>* odd) {
  constexpr Real third = Real(1) / Real(3);
  for (int i = 0; i < n; ++i) odd[i] = -third * absorption * loss[i];
}

/// That of two layers with half of the step each, from Z of one layer (Eq. 40c).
template <class Real>
inline void double_odd_source(int n, const Lanes<Real>* shunt, Lanes<Real>* odd) {
  for (int i = 0; i < n; ++i) odd[i] = Real(.5) * (odd[i] - shunt[place(i, 0)]);
}

/// Adds the cell's emission to its sources (Eq. 40b, 40d).
/// @param isotropic |v|
/// @param length A^-1
template <class Real>
inline void add_emission(int n, Real isotropic, const Emission<Real>& emission, const Lanes<Real>* length,
                         const Lanes<Real>* odd, Layer<Real>& layer) {
  const Lanes<Real> even = Real(-2) * isotropic * emission.planck;
  for (int i = 0; i < n; ++i) {
    const Lanes<Real> a = even * layer.shunt[place(i, 0)];
    const Lanes<Real> b = isotropic * (emission.step * odd[i] + Real(2) * emission.gradient * length[place(i, 0)]);
    layer.a[i] += a;
    layer.b[i] += b;
    layer.at_bottom[i] += a + b;
  }
  layer.own_mean -= even * layer.shade;
}

/// d = G s + c for an s that is relative to a radiance higher by `jump` (Eq. 40e).
template <class Real>
inline void raise_reference(int n, Real isotropic, const Lanes<Real>& jump, Below<Real>& below) {
  for (int i = 0; i < n; ++i) below.source[i] += Real(2) * isotropic * jump * below.conductance[place(i, 0)];
}

}  // namespace cloudbow::columns
