// Polar streams in the basis of column solvers: the first axis is isotropic light.
#pragma once

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "transport/columns/column_layers.hpp"
#include "transport/columns/polar_streams.hpp"

namespace cloudbow::columns {

/// A symmetric, orthogonal matrix that rotates sqrt(w mu), which is isotropic light, to the first axis. In this basis
/// the first row of the absorbing matrices (B, Z) is 0 without absorption. The net flux is the first component of d. So
/// it stands apart from larger numbers, even
// if a thick layer makes it small.
inline std::vector<std::vector<double>> isotropic_first(const PolarStreams& streams) {
  const int n = streams.size();
  std::vector<double> v;
  double square = 0;
  for (int i = 0; i < n; ++i) {
    v.push_back(std::sqrt(streams.weight[i] * streams.cosine[i]));
    square += v[i] * v[i];
  }
  for (double& component : v) component /= std::sqrt(square);
  v[0] -= 1;
  std::vector<std::vector<double>> turn(n, std::vector<double>(n, 0.));
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) turn[i][j] = (i == j ? 1. : 0.) + v[i] * v[j] / v[0];
  }
  return turn;
}

inline std::vector<double> transposed(const std::vector<std::vector<double>>& turn, const std::vector<double>& vector) {
  std::vector<double> result;
  for (const auto& row : turn) result.push_back(std::inner_product(row.begin(), row.end(), vector.begin(), 0.));
  return result;
}

/// Everything about the streams that the layers of all columns share.
template <class Real>
struct IsotropicBasis {
  using V = Lanes<Real>;

  /// Matrices of a phase function, scaled for s and d.
  struct Shape {
    std::vector<Real> even;            ///< lower triangle
    std::vector<Real> odd;             ///< the same, in the streams' own basis
    std::vector<Real> from_beam_even;  ///< [n]
    std::vector<Real> from_beam_odd;
  };

  /// @param with_sun whether the streams have the scattering of a beam.
  IsotropicBasis(const PolarStreams& streams, bool with_sun) {
    constexpr double pi = std::numbers::pi;
    const int n = streams.size();
    const std::vector<std::vector<double>> turn = isotropic_first(streams);
    std::vector<double> all_around;
    for (int i = 0; i < n; ++i) {
      const double mu = streams.cosine[i];
      all_around.push_back(2 * pi * std::sqrt(streams.weight[i] / mu));
      isotropic += streams.weight[i] * mu;
    }
    isotropic = std::sqrt(isotropic);
    all_around = transposed(turn, all_around);
    for (int i = 0; i < n; ++i) {
      flux[i] = V{} + static_cast<Real>(i == 0 ? 2 * pi * isotropic : 0);
      mean[i] = V{} + static_cast<Real>(all_around[i]);
      loss_of_isotropic.push_back(static_cast<Real>(all_around[i] / (2 * pi * isotropic)));
      for (int j = 0; j < n; ++j) root.push_back(static_cast<Real>(std::sqrt(streams.cosine[i]) * turn[i][j]));
      for (int j = 0; j <= i; ++j) {
        double sum = 0;
        for (int k = 0; k < n; ++k) sum += turn[i][k] * turn[j][k] / streams.cosine[k];
        inverse_cosine.push_back(static_cast<Real>(sum));
      }
    }
    for (const auto& phase : streams.phase) shapes.push_back(shape_of(streams, turn, phase, with_sun));
  }

  Vector<Real> flux;                    ///< of s and d
  Vector<Real> mean;                    ///< 4 pi mean radiance of s
  double isotropic = 0;                 ///< radiance 1 in s: its first component, the others are 0
  std::vector<Real> loss_of_isotropic;  ///< [n] first row of B without scattering
  std::vector<Real> inverse_cosine;     ///< triangle of M^-1
  std::vector<Real> root;               ///< [n][n] M^1/2, rows in the streams' own basis
  std::vector<Shape> shapes;            ///< [p]

 private:
  static Shape shape_of(const PolarStreams& streams, const std::vector<std::vector<double>>& turn,
                        const PolarStreams::Scattering& phase, bool with_sun) {
    const int n = streams.size();
    Shape shape;
    std::vector<std::vector<double>> even(n, std::vector<double>(n));
    std::vector<double> from_beam_even(n, 0.), from_beam_odd(n, 0.);
    for (int i = 0, e = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j, ++e) {
        even[i][j] = even[j][i] = phase.even[e] / std::sqrt(streams.cosine[i] * streams.cosine[j]);
        shape.odd.push_back(static_cast<Real>(phase.odd[e]));
      }
      if (!with_sun) continue;
      const double scale = std::sqrt(streams.weight[i] / streams.cosine[i]);
      from_beam_even[i] = scale * phase.from_beam_even[i];
      from_beam_odd[i] = scale * phase.from_beam_odd[i];
    }
    for (auto& row : even) row = transposed(turn, row);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) {
        double sum = 0;
        for (int k = 0; k < n; ++k) sum += turn[i][k] * even[k][j];
        shape.even.push_back(static_cast<Real>(sum));
      }
    }
    for (const double value : transposed(turn, from_beam_even))
      shape.from_beam_even.push_back(static_cast<Real>(value));
    for (const double value : transposed(turn, from_beam_odd)) shape.from_beam_odd.push_back(static_cast<Real>(value));
    return shape;
  }
};

}  // namespace cloudbow::columns
