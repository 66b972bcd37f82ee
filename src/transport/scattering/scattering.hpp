// Scattering: radiance at the ordinates becomes source, tile by tile of cells (docs/theory.md, "Scattering").
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "transport/grid/angular_field.hpp"
#include "transport/grid/cells.hpp"

namespace cloudbow {

/// Low moments of the radiance of a cell: integral of J times the 9 functions of degree l <= 2; the first is 1.
inline constexpr int low_moments = 9;

template <class Real>
using DenseMatrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rounds a scattering matrix to Real so that every column keeps its integral. The sum_i weight_i m(i, j) is that in
/// double, to a unit in the last place of one element.
template <class Real>
DenseMatrix<Real> rounded_conservatively(const Eigen::MatrixXd& matrix, std::span<const double> weight);

/// The source that a beam leaves in the cells: intensity [n] times a function of direction.
template <class Real>
struct BeamSource {
  Eigen::Matrix<Real, Eigen::Dynamic, 1> direction;  ///< one value a row of the field
  std::vector<Real> intensity;                       ///< [n]
};

/// Terms of a scattering apart from the given radiance.
template <class Real>
struct ScatteringTerms {
  std::span<const BeamSource<Real>> beam;
  /// [1 to low_moments][cells of the field] added to the moments of J before it scatters; or empty
  std::span<const Real> correction;
  std::span<const Real> emission;  ///< [low_moments][n] moments added to the source; or empty
  bool dark = false;               ///< J is zero, whatever the field holds
};

/// In place: radiance J at the ordinates -> source S = sum_p scattered_p * matrix_p * (J + correction) + emission + sum
/// of beam sources.
/// @param shape D x low_moments: addition to J_d or S_d per unit of each moment.
template <class Real>
void scatter_in_place(AngularField<Real>& field, std::span<const DenseMatrix<Real>> matrix, const Cells<Real>& cells,
                      const ScatteringTerms<Real>& terms, const DenseMatrix<Real>& shape);

/// The same without terms, to other directions: the scattered source at the control points, in the memory of the
/// radiance.
/// @param matrix [p] rows x radiance.rows
template <class Real>
AngularField<Real> scatter_to(int rows, AngularField<Real> radiance, std::span<const DenseMatrix<Real>> matrix,
                              const Cells<Real>& cells);

/// The same into memory of its own: the source towards any directions.
/// @param matrix [p] rows x radiance.rows, all with the same number of rows
template <class Real>
AngularField<Real> scatter_towards(const AngularField<Real>& radiance, std::span<const DenseMatrix<Real>> matrix,
                                   const Cells<Real>& cells);

/// moments[m * cells + c] = sum_d weights(m, d) J_d(c), of the cells of the field.
template <class Real>
void moments_of(const AngularField<Real>& radiance, const DenseMatrix<Real>& weights, std::span<Real> moments);

}  // namespace cloudbow
