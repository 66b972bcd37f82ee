// Plane-parallel layers as pairs of matrices, doubled and stacked without iteration, in lanes: one column per lane
// (docs/theory.md, "Columns without iteration").
//
// In n polar directions, with the sum s and the difference d of downward and upward radiance (both times sqrt(w mu)), a
// homogeneous layer between faces 1 (above) and 2 obeys
//   d1 = (Z + N) s1 - N s2 + a - b,    -d2 = (Z + N) s2 - N s1 + a + b                                     (Eq. 37)
// with symmetric Z, N of no negative eigenvalue, and vectors a, b of its sources. The equations are those of a ladder
// network: s are voltages, d currents, Z shunts and N series conductances. No nearly equal numbers are subtracted, so
// energy is conserved to rounding in float. The first axis of vectors is isotropic light. Without absorption the first
// row of Z is 0, and N keeps all its digits however thick the layer is.
//
// Symmetric matrices are given by their lower triangles, row by row; "factors" are such a triangle that holds L of L D
// L^T below the diagonal and 1/D on it.
#pragma once

#include "transport/grid/lanes.hpp"

namespace cloudbow::columns {

/// Largest n.
inline constexpr int most_streams = 16;
/// Radiances' columns beside those of a matrix when both are eliminated together.
inline constexpr int most_columns = most_streams + 2;

/// Entries of the lower triangle of an n x n matrix.
constexpr int entries(int n) { return n * (n + 1) / 2; }
/// Place of entry (i, j), i >= j, in it.
constexpr int place(int i, int j) { return entries(i) + j; }

template <class Real>
using Triangle = Lanes<Real>[entries(most_columns)];
template <class Real>
using Vector = Lanes<Real>[most_streams];
template <class Real>
using Matrix = Lanes<Real>[most_streams][most_columns];

/// y += A x
template <class Real>
inline void add_product(int n, const Lanes<Real>* a, const Lanes<Real>* x, Lanes<Real>* y) {
  for (int i = 0; i < n; ++i) {
    const Lanes<Real>* const row = a + place(i, 0);
    Lanes<Real> sum = y[i] + row[i] * x[i];
    for (int j = 0; j < i; ++j) {
      sum += row[j] * x[j];
      y[j] += row[j] * x[i];
    }
    y[i] = sum;
  }
}

/// Factors of P in its place.
template <class Real>
inline void factorise(int n, Lanes<Real>* p) {
  for (int k = 0; k < n; ++k) {
    const Lanes<Real> inverse = Real(1) / p[place(k, k)];
    p[place(k, k)] = inverse;
    Vector<Real> unscaled;
    for (int i = k + 1; i < n; ++i) {
      Lanes<Real>* const row = p + place(i, 0);
      unscaled[i] = row[k];
      const Lanes<Real> l = unscaled[i] * inverse;
      row[k] = l;
      for (int j = k + 1; j <= i; ++j) row[j] -= l * unscaled[j];
    }
  }
}

/// Columns [j, j + width) of row i of L^-1 X, given the rows before it.
template <int width, class Real>
inline void eliminate_row(const Lanes<Real>* factors, Matrix<Real>& x, int i, int j) {
  Lanes<Real> sum[width];
  for (int c = 0; c < width; ++c) sum[c] = x[i][j + c];
  for (int k = 0; k < i; ++k) {
    const Lanes<Real> l = factors[place(i, k)];
    for (int c = 0; c < width; ++c) sum[c] -= l * x[k][j + c];
  }
  for (int c = 0; c < width; ++c) x[i][j + c] = sum[c];
}

/// X = L^-1 X, for m columns.
template <class Real>
inline void forward(int n, int m, const Lanes<Real>* factors, Matrix<Real>& x) {
  for (int i = 1; i < n; ++i) {
    int j = 0;
    for (; j + 4 <= m; j += 4) eliminate_row<4, Real>(factors, x, i, j);
    for (; j < m; ++j) eliminate_row<1, Real>(factors, x, i, j);
  }
}

/// x = P^-1 x.
template <class Real>
inline void solve(int n, const Lanes<Real>* factors, Lanes<Real>* x) {
  for (int i = 1; i < n; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= factors[place(i, k)] * x[k];
  }
  for (int i = n - 1; i >= 0; --i) {
    x[i] *= factors[place(i, i)];
    for (int k = i + 1; k < n; ++k) x[i] -= factors[place(k, i)] * x[k];
  }
}

/// Entries (i, j) to (i, j + width) of X^T D^-1 X.
template <int width, class Real>
inline void multiply_columns(int n, const Lanes<Real>* scaled, const Matrix<Real>& x, int j, Lanes<Real>* to) {
  Lanes<Real> sum[width] = {};
  for (int k = 0; k < n; ++k) {
    for (int c = 0; c < width; ++c) sum[c] += scaled[k] * x[k][j + c];
  }
  for (int c = 0; c < width; ++c) to[c] = sum[c];
}

/// X^T D^-1 X of m columns, as a triangle.
template <class Real>
inline void gram(int n, int m, const Lanes<Real>* factors, const Matrix<Real>& x, Lanes<Real>* product) {
  for (int i = 0; i < m; ++i) {
    Vector<Real> scaled;
    for (int k = 0; k < n; ++k) scaled[k] = x[k][i] * factors[place(k, k)];
    Lanes<Real>* const row = product + place(i, 0);
    int j = 0;
    for (; j + 4 <= i + 1; j += 4) multiply_columns<4, Real>(n, scaled, x, j, row + j);
    for (; j <= i; ++j) multiply_columns<1, Real>(n, scaled, x, j, row + j);
  }
}

template <class Real>
inline void fill(int n, const Lanes<Real>* triangle, Matrix<Real>& x) {
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) x[i][j] = x[j][i] = triangle[place(i, j)];
  }
}

/// Properties of a layer; directions are those of the vectors.
template <class Real>
struct Matter {
  Triangle<Real> loss;                ///< B of (Eq. 35)
  Triangle<Real> length;              ///< A^-1
  Vector<Real> source_of_sum;         ///< q+, at the layer's top
  Vector<Real> source_of_difference;  ///< q-
  Lanes<Real> decay;                  ///< kappa: sources fall as exp(-kappa optical depth)
};

template <class Real>
struct Layer {
  Triangle<Real> shunt;   ///< Z
  Triangle<Real> series;  ///< N
  Vector<Real> a;
  Vector<Real> b;
  Vector<Real> at_bottom;  ///< a + b, in thick layers much less than either
  /// 4 pi times the mean radiance in it is mean . (s1 + s2)/2 + own_mean.
  Vector<Real> mean;
  Lanes<Real> own_mean;
  Lanes<Real> shade;  ///< first component of `mean`: that of a transparent layer less that of this one
};

/// A layer whose half thickness over the smallest cosine is below one: error of fourth order in that ratio (Eq. 38).
/// @param thickness optical
/// @param left mean of exp(-kappa depth) in it
/// @param mean_radiance [n] 4 pi times mean radiance from s
template <class Real>
inline void make_thin_layer(int n, const Matter<Real>& matter, const Lanes<Real>& thickness, const Lanes<Real>& left,
                            const Lanes<Real>* mean_radiance, Layer<Real>& layer) {
  constexpr Real third = Real(1) / Real(3);
  const Lanes<Real> h = Real(.5) * thickness;
  const Lanes<Real> inverse_h = Real(1) / h;
  Triangle<Real> factors;
  for (int e = 0; e < entries(n); ++e) {
    layer.shunt[e] = h * matter.loss[e];
    layer.series[e] = inverse_h * matter.length[e] + third * layer.shunt[e];  // W for now
    factors[e] = layer.series[e];
  }
  factorise<Real>(n, factors);
  Matrix<Real> x;
  fill<Real>(n, layer.shunt, x);
  for (int i = 0; i < n; ++i) {
    x[i][n] = matter.source_of_sum[i];
    x[i][n + 1] = mean_radiance[i];
  }
  forward<Real>(n, n + 2, factors, x);
  Triangle<Real> product;
  gram<Real>(n, n + 2, factors, x, product);

  const Lanes<Real> slope = third * matter.decay * h * h * left;
  Vector<Real> bent = {};
  add_product<Real>(n, layer.shunt, matter.source_of_difference, bent);
  Vector<Real> reach = {};
  add_product<Real>(n, matter.length, matter.source_of_difference, reach);
  layer.own_mean = left * third * h * product[place(n + 1, n)];
  layer.shade = third * product[place(n + 1, 0)];
  for (int i = 0; i < n; ++i) {
    layer.a[i] = slope * bent[i] - h * left * (matter.source_of_sum[i] - third * product[place(n, i)]);
    layer.b[i] = slope * matter.source_of_sum[i] - left * reach[i];
    layer.at_bottom[i] = layer.a[i] + layer.b[i];
    layer.mean[i] = mean_radiance[i] - third * product[place(n + 1, i)];
    layer.own_mean += slope * mean_radiance[i] * matter.source_of_difference[i];
  }
  for (int e = 0; e < entries(n); ++e) {
    layer.shunt[e] -= third * product[e];
    layer.series[e] = Real(.5) * (layer.series[e] - layer.shunt[e]);
  }
}

/// Two of the layer, one above the other, the sources of the lower one times `passed` (Eq. 39).
/// @param lost 1 - passed
template <class Real>
inline void double_layer(int n, const Lanes<Real>& passed, const Lanes<Real>& lost, Layer<Real>& layer) {
  Triangle<Real> factors;
  for (int e = 0; e < entries(n); ++e) factors[e] = layer.shunt[e] + layer.series[e];
  factorise<Real>(n, factors);
  Matrix<Real> x;
  fill<Real>(n, layer.shunt, x);
  const Lanes<Real> both = Real(1) + passed;
  const auto thin = passed > Real(.5);
  for (int i = 0; i < n; ++i) {
    x[i][n] = thin ? both * layer.a[i] + lost * layer.b[i] : layer.at_bottom[i] + passed * (layer.a[i] - layer.b[i]);
    x[i][n + 1] = layer.mean[i];
  }
  forward<Real>(n, n + 2, factors, x);
  Triangle<Real> product;
  gram<Real>(n, n + 2, factors, x, product);

  layer.own_mean = Real(.5) * both * layer.own_mean - Real(.25) * product[place(n + 1, n)];
  layer.shade += Real(.5) * product[place(n + 1, 0)];
  for (int i = 0; i < n; ++i) {
    const Lanes<Real> a = layer.a[i];
    layer.a[i] = both * a - Real(.5) * product[place(n, i)];
    layer.b[i] = Real(.5) * (both * layer.b[i] - lost * a);
    layer.mean[i] -= Real(.5) * product[place(n + 1, i)];
  }
  for (int e = 0; e < entries(n); ++e) layer.shunt[e] += layer.shunt[e] - product[e];

  // L^-1 N = D L^T - L^-1 Z
  for (int k = 0; k < n; ++k) {
    const Lanes<Real> pivot = Real(1) / factors[place(k, k)];
    for (int j = 0; j < k; ++j) x[k][j] = -x[k][j];
    x[k][k] = pivot - x[k][k];
    for (int j = k + 1; j < n; ++j) x[k][j] = pivot * factors[place(j, k)] - x[k][j];
  }
  gram<Real>(n, n + 1, factors, x, layer.series);
  for (int e = 0; e < entries(n); ++e) layer.series[e] *= Real(.5);
  for (int i = 0; i < n; ++i) {
    const Lanes<Real> at_bottom = passed * layer.at_bottom[i] + Real(.5) * layer.series[place(n, i)];
    layer.at_bottom[i] = thin ? layer.a[i] + layer.b[i] : at_bottom;
    layer.a[i] = thin ? layer.a[i] : at_bottom - layer.b[i];
  }
}

/// Everything below a level, seen from above: d = G s + c.
template <class Real>
struct Below {
  Triangle<Real> conductance;  ///< G
  Vector<Real> source;         ///< c
};

/// Data of a layer for the pass downwards, H = G + Z. s2 = s1 - (N + H)^-1 (H s1 + r), or (N + H)^-1 (N s1 - r) in
/// lanes in which this is the smaller. Neither is then a difference of nearly equal numbers. The data lie in an array
/// of lanes.
template <class Real>
struct Passage {
  Passage(int n, Lanes<Real>* at)
      : factors(at),
        load(factors + entries(n)),
        source(load + entries(n)),
        mean(source + n),
        net(mean + n),
        own_mean(net + n),
        own_net(own_mean + 1),
        kept(own_net + 1) {}
  static constexpr std::size_t size(int n) { return 2 * entries(n) + 3 * n + 3; }

  Lanes<Real>* factors;  ///< of N + H
  Lanes<Real>* load;     ///< H or -N
  Lanes<Real>* source;   ///< r
  Lanes<Real>* mean;
  Lanes<Real>* net;  ///< net downward flux at face 2 is net . s2 + own_net
  Lanes<Real>* own_mean;
  Lanes<Real>* own_net;
  Lanes<Real>* kept;  ///< 1 if load is H, else 0
};

/// Adds the layer on top of the layers below (Eq. 40).
/// @param flux [n] downward flux from d
/// @param used lanes that have the layer; others stay unchanged
template <class Real, class Mask>
inline void stack(int n, const Layer<Real>& layer, const Lanes<Real>* flux, const Mask& used, Below<Real>& below,
                  const Passage<Real>& passage) {
  *passage.own_mean = layer.own_mean;
  *passage.own_net = Lanes<Real>{};
  for (int i = 0; i < n; ++i) {
    passage.mean[i] = layer.mean[i];
    passage.net[i] = Lanes<Real>{};
    *passage.own_net += flux[i] * below.source[i];
  }
  add_product<Real>(n, below.conductance, flux, passage.net);

  const auto thick = layer.series[0] < below.conductance[0] + layer.shunt[0];
  const Lanes<Real> zero{};
  *passage.kept = thick ? zero : zero + Real(1);
  for (int e = 0; e < entries(n); ++e) {
    const Lanes<Real> load = below.conductance[e] + layer.shunt[e];
    passage.factors[e] = layer.series[e] + load;
    passage.load[e] = thick ? -layer.series[e] : load;
  }
  factorise<Real>(n, passage.factors);
  Matrix<Real> x;
  fill<Real>(n, passage.load, x);
  for (int i = 0; i < n; ++i) x[i][n] = passage.source[i] = layer.at_bottom[i] + below.source[i];
  forward<Real>(n, n + 1, passage.factors, x);
  Triangle<Real> product;
  gram<Real>(n, n + 1, passage.factors, x, product);
  for (int i = 0; i < n; ++i) {
    const Lanes<Real> either = thick ? -layer.b[i] : layer.a[i] + below.source[i];
    const Lanes<Real> source = layer.a[i] + either - product[place(n, i)];
    below.source[i] = used ? source : below.source[i];
  }
  for (int e = 0; e < entries(n); ++e) {
    const Lanes<Real> either = thick ? layer.series[e] : passage.load[e];
    const Lanes<Real> conductance = layer.shunt[e] + (either - product[e]);
    below.conductance[e] = used ? conductance : below.conductance[e];
  }
}

/// s at face 2 from that at face 1.
template <class Real>
inline void pass(int n, const Passage<Real>& passage, const Lanes<Real>* above, Lanes<Real>* below) {
  Vector<Real> change;
  for (int i = 0; i < n; ++i) change[i] = passage.source[i];
  add_product<Real>(n, passage.load, above, change);
  solve<Real>(n, passage.factors, change);
  for (int i = 0; i < n; ++i) below[i] = *passage.kept * above[i] - change[i];
}

}  // namespace cloudbow::columns
