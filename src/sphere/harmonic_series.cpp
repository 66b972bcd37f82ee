#include "cloudbow/sphere/harmonic_series.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "cloudbow/sphere/spherical_function.hpp"

namespace cloudbow {
namespace {

/// Rotation matrix of one degree from that of the degree below and that of degree 1.
class NextBlock {
 public:
  NextBlock(const Eigen::MatrixXd& first, const Eigen::MatrixXd& below)
      : first_(first), below_(below), l_(static_cast<int>(below.rows() + 1) / 2) {}

  Eigen::MatrixXd matrix() const {
    Eigen::MatrixXd next(2 * l_ + 1, 2 * l_ + 1);
    for (int m = -l_; m <= l_; ++m) {
      for (int n = -l_; n <= l_; ++n) next(m + l_, n + l_) = element(m, n);
    }
    return next;
  }

 private:
  double below(int m, int n) const { return below_(m + l_ - 1, n + l_ - 1); }

  // P of Table 2: degree 1, row i, times degree l-1, row m.
  double product(int i, int m, int n) const {
    const auto row = first_.row(i + 1);
    if (n == l_) return row[2] * below(m, l_ - 1) - row[0] * below(m, 1 - l_);
    if (n == -l_) return row[2] * below(m, 1 - l_) + row[0] * below(m, l_ - 1);
    return row[1] * below(m, n);
  }

  double element(int m, int n) const {
    const int size = std::abs(m);
    const double scale = std::abs(n) == l_ ? 2.0 * l_ * (2 * l_ - 1) : 1.0 * (l_ + n) * (l_ - n);
    // u, v, w of Table 1; a factor that vanishes guards rows that do not exist.
    double sum = 0;
    if (size < l_) sum += std::sqrt((l_ + m) * (l_ - m) / scale) * product(0, m, n);
    const double v = 0.5 * std::sqrt((l_ + size - 1) * (l_ + size) / scale);
    if (m == 0) {
      sum -= std::numbers::sqrt2 * v * (product(1, 1, n) + product(-1, -1, n));
    } else if (size == 1) {
      sum += std::numbers::sqrt2 * v * product(m, 0, n);
    } else if (m > 0) {
      sum += v * (product(1, m - 1, n) - product(-1, 1 - m, n));
    } else {
      sum += v * (product(1, m + 1, n) + product(-1, -m - 1, n));
    }
    if (m != 0 && size < l_ - 1) {
      const double w = 0.5 * std::sqrt((l_ - size - 1) * (l_ - size) / scale);
      sum -= w * (m > 0 ? product(1, m + 1, n) + product(-1, -m - 1, n) : product(1, m - 1, n) - product(-1, 1 - m, n));
    }
    return sum;
  }

  const Eigen::MatrixXd& first_;
  const Eigen::MatrixXd& below_;
  int l_;
};

}  // namespace

template <class Real>
void query_harmonics(std::span<const double> basis, std::span<const Real> coefficients, std::span<Real> result) {
  const std::size_t functions = result.size();
  assert(coefficients.size() == basis.size() * functions);
  if (functions == 1) {
    double sum = 0;
    for (std::size_t k = 0; k < basis.size(); ++k) sum += basis[k] * coefficients[k];
    result[0] = static_cast<Real>(sum);
    return;
  }
  constexpr std::size_t block = 4096;  // sums stay in the first-level cache, rows are read in long runs
  for (std::size_t first = 0; first < functions; first += block) {
    const std::size_t count = std::min(block, functions - first);
    Real* sum = result.data() + first;
    std::fill_n(sum, count, Real(0));
    std::size_t k = 0;
    // Four rows at a time: sums are loaded and stored a quarter as often.
    for (; k + 4 <= basis.size(); k += 4) {
      const Real b0 = static_cast<Real>(basis[k]), b1 = static_cast<Real>(basis[k + 1]),
                 b2 = static_cast<Real>(basis[k + 2]), b3 = static_cast<Real>(basis[k + 3]);
      const Real* c0 = coefficients.data() + k * functions + first;
      const Real *c1 = c0 + functions, *c2 = c1 + functions, *c3 = c2 + functions;
      for (std::size_t n = 0; n < count; ++n) sum[n] += (b0 * c0[n] + b1 * c1[n]) + (b2 * c2[n] + b3 * c3[n]);
    }
    for (; k < basis.size(); ++k) {
      const Real b = static_cast<Real>(basis[k]);
      const Real* c = coefficients.data() + k * functions + first;
      for (std::size_t n = 0; n < count; ++n) sum[n] += b * c[n];
    }
  }
}

template void query_harmonics(std::span<const double>, std::span<const float>, std::span<float>);
template void query_harmonics(std::span<const double>, std::span<const double>, std::span<double>);

HarmonicRotation::HarmonicRotation(const Eigen::Matrix3d& rotation, int degree) {
  block_.emplace_back(Eigen::MatrixXd::Ones(1, 1));
  if (degree == 0) return;
  Eigen::MatrixXd first(3, 3);
  constexpr int axis[] = {1, 2, 0};  // m = -1, 0, 1 go with y, z, x
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) first(i, j) = rotation(axis[i], axis[j]);
  }
  block_.push_back(first);
  while (this->degree() < degree) block_.push_back(NextBlock(first, block_.back()).matrix());
}

template <class Real>
void HarmonicRotation::apply(std::span<const Real> coefficients, std::span<Real> rotated) const {
  assert(coefficients.size() == rotated.size() && coefficients.size() % harmonic_count(degree()) == 0);
  const Eigen::Index functions = coefficients.size() / harmonic_count(degree());
  using Rows = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  using ColumnMajor = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  for (int l = 0; l <= degree(); ++l) {
    const Eigen::Index first = harmonic_index(l, -l) * functions;
    const ColumnMajor turn = block_[l].cast<Real>();
    Eigen::Map<Rows>(rotated.data() + first, 2 * l + 1, functions).noalias() =
        turn * Eigen::Map<const Rows>(coefficients.data() + first, 2 * l + 1, functions);
  }
}

template void HarmonicRotation::apply(std::span<const float>, std::span<float>) const;
template void HarmonicRotation::apply(std::span<const double>, std::span<double>) const;

HarmonicSeries::HarmonicSeries(int degree, std::vector<double> coefficients)
    : basis_(degree), coefficients_(std::move(coefficients)) {
  assert(static_cast<int>(coefficients_.size()) == harmonic_count(degree));
}

HarmonicSeries::HarmonicSeries(int degree, const OrdinateSet& quadrature,
                               const std::function<double(const Direction&)>& f)
    : basis_(degree), coefficients_(harmonic_count(degree)) {
  std::vector<double> harmonics(coefficients_.size());
  for (int d = 0; d < quadrature.size(); ++d) {
    basis_.evaluate(quadrature.direction[d], harmonics);
    add_scaled<double>(quadrature.weight[d] * f(quadrature.direction[d]), harmonics, coefficients_);
  }
}

double HarmonicSeries::operator()(const Direction& direction) const {
  std::vector<double> harmonics(coefficients_.size());
  basis_.evaluate(direction, harmonics);
  double value = 0;
  query_harmonics<double>(harmonics, coefficients_, std::span(&value, 1));
  return value;
}

std::vector<double> HarmonicSeries::operator()(std::span<const Direction> directions) const {
  std::vector<double> result;
  for (const Direction& d : directions) result.push_back((*this)(d));
  return result;
}

HarmonicSeries& HarmonicSeries::operator*=(double factor) {
  for (double& c : coefficients_) c *= factor;
  return *this;
}

HarmonicSeries& HarmonicSeries::operator+=(const HarmonicSeries& other) {
  assert(degree() == other.degree());
  add_scaled<double>(1, other.coefficients_, coefficients_);
  return *this;
}

HarmonicSeries HarmonicSeries::rotated(const HarmonicRotation& rotation) const {
  std::vector<double> coefficients(coefficients_.size());
  rotation.apply<double>(coefficients_, coefficients);
  return {degree(), std::move(coefficients)};
}

}  // namespace cloudbow
