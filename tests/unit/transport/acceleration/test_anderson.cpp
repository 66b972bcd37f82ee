#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "transport/acceleration/anderson.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// g(x) = A x + b with known fixed point; A symmetric, its eigenvalues spread evenly over [0, radius].
struct LinearMap {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  Eigen::VectorXd fixed;

  LinearMap(int n, double radius) : a(n, n), b(n), fixed(n) {
    Random random(1);
    for (int i = 0; i < n; ++i) {
      fixed[i] = random();
      for (int j = 0; j < n; ++j) a(i, j) = random() - .5;
    }
    const Eigen::MatrixXd turn = Eigen::HouseholderQR<Eigen::MatrixXd>(a).householderQ();
    a = turn * Eigen::VectorXd::LinSpaced(n, n > 1 ? 0 : radius, radius).asDiagonal() * turn.transpose();
    b = fixed - a * fixed;
  }
  template <class Real>
  std::vector<Real> operator()(const std::vector<Real>& x) const {
    Eigen::VectorXd in(a.rows());
    for (Eigen::Index i = 0; i < in.size(); ++i) in[i] = static_cast<double>(x[static_cast<std::size_t>(i)]);
    const Eigen::VectorXd out = a * in + b;
    return {out.begin(), out.end()};
  }
  template <class Real>
  double error(const std::vector<Real>& x) const {
    double sum = 0;
    for (Eigen::Index i = 0; i < fixed.size(); ++i)
      sum += std::pow(static_cast<double>(x[static_cast<std::size_t>(i)]) - fixed[i], 2);
    return std::sqrt(sum) / fixed.norm();
  }
};

TEST(AndersonMixer, SolvesALinearProblemInItsDimensionAndOneSteps) {
  // Then the changes span the whole space, as in Krylov's methods (Walker and Ni 2011). The exception is the 1e-7 that
  // keeps dependent changes solvable: it is multiplied by the square of their condition (1e2). Plain iteration would
  // leave .95^(n+1).
  for (const int n : {1, 2, 4}) {
    const LinearMap map(n, .95);
    AndersonMixer<double> mixer(5);
    std::vector<double> x(static_cast<std::size_t>(n), 0.);
    for (int step = 0; step < n + 1; ++step) mixer.advance(x, map(x));
    EXPECT_LT(map.error(x), 1e-3) << n;
  }
}

TEST(AndersonMixer, ConvergesWithLessMemoryThanTheProblemHasDimensions) {
  const LinearMap map(40, .98);
  AndersonMixer<float> mixer(5);
  std::vector<float> x(40, 0.F), plain(40, 0.F);
  for (int step = 0; step < 40; ++step) {
    mixer.advance(x, map(x));
    plain = map(plain);
  }
  EXPECT_LT(map.error(x), .01 * map.error(plain));  // measured .004
}

TEST(AndersonMixer, StaysAtTheFixedPoint) {
  // No change at all: the normal equations are 0 = 0, and must not turn the iterate into NaN.
  AndersonMixer<float> mixer(5);
  std::vector<float> x{1.F, 2.F, 3.F};
  const std::vector<float> g = x;
  for (int step = 0; step < 8; ++step) {
    mixer.advance(x, g);
    EXPECT_EQ(x, g);
  }
}

TEST(OrderedDot, IsTheDotProductWithTheSameBitsOnAnyThreads) {
  Random random(2);
  std::vector<float> a(10001), b(10001);
  long double truth = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = static_cast<float>(random() - .5);
    b[i] = static_cast<float>(random() - .5);
    truth += static_cast<long double>(a[i]) * static_cast<long double>(b[i]);
  }
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const double one = ordered_dot<float>(a, b);
  omp_set_num_threads(2);
  const double two = ordered_dot<float>(a, b);
  omp_set_num_threads(threads);
  EXPECT_EQ(one, two);
  EXPECT_NEAR(one, static_cast<double>(truth), 1e-12);  // ten thousand terms of 1/16, rounded to 1e-17 each
}

}  // namespace
}  // namespace cloudbow
