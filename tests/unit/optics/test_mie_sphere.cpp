// Single spheres: closed forms, then published tables.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "../near_with_report.hpp"
#include "cloudbow/optics/mie_sphere.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

using Complex = std::complex<double>;

MieEfficiencies efficiencies(double x, Complex m) { return mie_efficiencies(mie_coefficients(x, m)); }

double intensity(const MieCoefficients& sphere, double cos_angle) {
  const MieAmplitudes s = mie_amplitudes(sphere, cos_angle);
  return (std::norm(s.s1) + std::norm(s.s2)) / 2;
}

// Closed form: Rayleigh's limit with its next term, Q_sca = 8/3 x^4 |K|^2 (1 + 6/5 x^2 (m^2 - 2)/(m^2 + 2)) for real m
// (van de Hulst 1957, section 6.31). The next terms are of order x^4; x^3 for the scattering loss.
TEST(MieSphere, SmallSpheresScatterAsRayleigh) {
  for (const double n : {1.05, 1.33, 2.5}) {
    const double k = (n * n - 1) / (n * n + 2);
    for (const double x : {1e-6, 1e-4, 1e-3, 1e-2}) {
      const double expected = 8.0 / 3 * std::pow(x, 4) * k * k * (1 + 1.2 * x * x * (n * n - 2) / (n * n + 2));
      const MieEfficiencies q = efficiencies(x, n);
      EXPECT_NEAR(q.scattering / expected, 1, 2e-13 / (n - 1) + 10 * x * x * x * x) << n << " " << x;
      EXPECT_EQ(q.absorption, 0);
      EXPECT_EQ(q.extinction, q.scattering);
      // Backscatter of a dipole: 3/2 Q_sca to the order x^2.
      EXPECT_NEAR(q.backscatter / (1.5 * expected), 1, 1e-12 + 5 * x * x);
    }
  }
}

// Closed form: g is of order x^2 with the same coefficient for all small spheres of one index. Thus g/x^2 at 1e-3 and
// 1e-2 agree to x^2. Digits lost by cancellation (1e-16/x^2 with textbook recurrences) would show.
TEST(MieSphere, AsymmetryOfSmallSpheresKeepsItsDigits) {
  const double coarse = efficiencies(1e-2, 1.33).asymmetry_parameter / 1e-4;
  EXPECT_NEAR(efficiencies(1e-3, 1.33).asymmetry_parameter / 1e-6, coarse, 1e-3 * coarse);
  const double fine = efficiencies(1e-3, 1.33).asymmetry_parameter / 1e-6;
  EXPECT_NEAR(efficiencies(1e-4, 1.33).asymmetry_parameter / 1e-8, fine, 2e-6 * fine);
  EXPECT_NEAR(efficiencies(1e-5, 1.33).asymmetry_parameter / 1e-10, fine, 2e-6 * fine);
}

// Closed form: Q_abs = 4 x Im[(m^2-1)/(m^2+2)] (Bohren & Huffman Eq. 5.11), the corrections being of order x^2.
TEST(MieSphere, AbsorptionOfSmallSpheresIsExactHoweverWeak) {
  const double x = 1e-4;
  for (const double k : {1e-12, 1e-9, 1e-4, 0.1, 1.0}) {
    const Complex m(1.33, k), m2 = m * m;
    // Im[(m^2-1)/(m^2+2)] = 3 Im m^2 / |m^2+2|^2, free of cancellation.
    const double expected = 4 * x * 3 * m2.imag() / std::norm(m2 + 2.0);
    EXPECT_NEAR(efficiencies(x, m).absorption / expected, 1, 1e-7) << k;
  }
}

// Closed form: a weakly absorbing sphere absorbs in proportion to k.
TEST(MieSphere, WeakAbsorptionIsLinearInK) {
  for (const double x : {1.0, 30.0, 1000.0}) {
    const double strong = efficiencies(x, {1.33, 1e-9}).absorption;
    const double weak = efficiencies(x, {1.33, 1e-13}).absorption;
    // The deviation is 4 k x at most but for resonances; measured 1e-6.
    EXPECT_NEAR(weak * 1e4 / strong, 1, 1e-5) << x;
  }
}

// The optical theorem (Bohren & Huffman Eq. 4.62): Q_ext = 4/x^2 Re S(0), by two different sums; S_1(0) = S_2(0) and
// S_1(180) = -S_2(180).
TEST(MieSphere, ObeysTheOpticalTheorem) {
  for (const double x : {0.01, 0.7, 5.0, 77.3, 1234.5, 1e4}) {
    for (const Complex m : {Complex(1.33, 0), Complex(1.5, 1e-3), Complex(1.5, 1), Complex(0.75, 0), Complex(10, 10)}) {
      const MieCoefficients sphere = mie_coefficients(x, m);
      const MieEfficiencies q = mie_efficiencies(sphere);
      const MieAmplitudes forward = mie_amplitudes(sphere, 1), backward = mie_amplitudes(sphere, -1);
      // If x is small, Re a_n is found against |a_n| of order x^3 / x^6: that is the theorem's cancellation, not Q's.
      const double slack = x < 0.1 ? 1e-6 : 1e-10;
      EXPECT_NEAR(4 / (x * x) * forward.s1.real() / q.extinction, 1, slack) << x << " " << m;
      EXPECT_LE(std::abs(forward.s1 - forward.s2), 1e-12 * std::abs(forward.s1));
      EXPECT_LE(std::abs(backward.s1 + backward.s2), 1e-10 * std::abs(forward.s1));
      EXPECT_NEAR(4 * std::norm(backward.s1) / (x * x) / q.backscatter, 1, 1e-9);
    }
  }
}

// Sum rules: the scattered intensity over all directions is Q_sca, its first moment Q_sca g. Gauss-Legendre is exact.
TEST(MieSphere, IntensityIntegratesToScatteringAndAsymmetry) {
  for (const double x : {0.001, 1.0, 40.0, 300.0}) {
    for (const Complex m : {Complex(1.33, 0), Complex(1.5, 0.1)}) {
      const MieCoefficients sphere = mie_coefficients(x, m);
      const GaussLegendre rule = make_gauss_legendre(static_cast<int>(2 * sphere.a.size()) + 2);
      double zeroth = 0, first = 0;
      for (std::size_t n = 0; n < rule.node.size(); ++n) {
        const double weighted = rule.weight[n] * intensity(sphere, rule.node[n]);
        zeroth += weighted;
        first += weighted * rule.node[n];
      }
      const MieEfficiencies q = mie_efficiencies(sphere);
      EXPECT_NEAR(2 / (x * x) * zeroth / q.scattering, 1, 1e-10) << x << " " << m;
      EXPECT_NEAR(first / zeroth, q.asymmetry_parameter, 1e-10) << x << " " << m;
    }
  }
}

// Closed form: anomalous diffraction, Q = 2 - 4/rho sin rho + 4/rho^2 (1 - cos rho), rho = 2x (m-1), m -> 1 (van de
// Hulst 1957, section 11.22). The error is of the order of m - 1.
TEST(MieSphere, SoftSpheresDiffractAnomalously) {
  const double n = 1.0005;
  for (const double rho : {1.0, 4.1, 10.0}) {
    const double q = 2 - 4 / rho * std::sin(rho) + 4 / (rho * rho) * (1 - std::cos(rho));
    EXPECT_NEAR(efficiencies(rho / (2 * (n - 1)), n).extinction / q, 1, 3 * (n - 1));
  }
}

// Geometric limit: Q_ext -> 2 with an edge term 1.9924 x^(-2/3) for absorbing spheres (Nussenzveig & Wiscombe 1980,
// Phys. Rev. Lett. 45, 1490); the next is of order 1/x.
TEST(MieSphere, LargeSpheresExtinguishTwiceTheirSection) {
  for (const double x : {1e3, 1e4, 1e5}) {
    EXPECT_NEAR(efficiencies(x, {1.33, 0.1}).extinction, 2 + 1.9924 * std::pow(x, -2.0 / 3), 2 / x) << x;
  }
}

struct Published {
  double x;
  Complex m;
  double extinction, scattering, asymmetry;  // NaN: not given
  double last_digit;
};

constexpr double none = std::numeric_limits<double>::quiet_NaN();

void expect_published(const Published& table) {
  const MieEfficiencies q = efficiencies(table.x, table.m);
  const std::string where = "x = " + std::to_string(table.x);
  const double slack = 0.51 * table.last_digit;
  if (!std::isnan(table.extinction)) {
    EXPECT_NEAR(q.extinction, table.extinction, slack) << where;
  }
  if (!std::isnan(table.scattering)) {
    EXPECT_NEAR(q.scattering, table.scattering, slack) << where;
  }
  if (!std::isnan(table.asymmetry)) {
    EXPECT_NEAR(q.asymmetry_parameter, table.asymmetry, slack) << where;
  }
}

// Wiscombe, "Mie scattering calculations", NCAR/TN-140+STR (1979), appendix; the output of the test problems of his
// MIEV0 (version of 1996). They are quoted by the tests of the public repositories scottprahl/miepython and miex. Every
// printed digit, but for x = 10000, m = 1.5 + i: the last digit of Q_sca and g differs by one.
TEST(MieSphere, AgreesWithWiscombesTestCases) {
  constexpr double digit = 1e-6;
  for (const Published& table : {
           Published{10, 1.5, 2.881999, 2.881999, 0.742913, digit},
           Published{100, 1.5, 2.094388, 2.094388, 0.818246, digit},
           Published{1000, 1.5, 2.013945, 2.013945, 0.827882, digit},
           Published{5000, 1.5, 2.008650, 2.008650, 0.829592, digit},
           Published{0.099, 0.75, 0.000007, 0.000007, 0.001448, digit},
           Published{0.101, 0.75, 0.000008, 0.000008, 0.001507, digit},
           Published{10, 0.75, 2.232265, 2.232265, 0.896473, digit},
           Published{1000, 0.75, 1.997908, 1.997908, 0.844944, digit},
           Published{1, {1.33, 1e-5}, none, 0.093923, 0.184517, digit},
           Published{100, {1.33, 1e-5}, none, 2.096594, 0.868959, digit},
           Published{10000, {1.33, 1e-5}, none, 1.723857, 0.907840, digit},
           Published{0.055, {1.5, 1}, 0.101491, 0.000011, 0.000491, digit},
           Published{0.056, {1.5, 1}, 0.103347, 0.000012, 0.000509, digit},
           Published{1, {1.5, 1}, 2.336321, 0.663454, 0.192136, digit},
           Published{100, {1.5, 1}, 2.097502, 1.283697, 0.850252, digit},
           Published{10000, {1.5, 1}, 2.004368, 1.236575, 0.846309, 2 * digit},
           Published{1, {10, 10}, none, 2.049405, -0.110664, digit},
           Published{100, {10, 10}, none, 1.836785, 0.556215, digit},
           Published{10000, {10, 10}, none, 1.795393, 0.548194, digit},
       }) {
    expect_published(table);
  }
}

// Bohren & Huffman (1983), appendix A, page 482: water-like sphere of radius 0.525 um and m = 1.55 at 0.6328 um. S_11
// relative to the forward direction at 0, 9, ... 180 degrees.
TEST(MieSphere, AgreesWithBohrenAndHuffmansExample) {
  const double x = 2 * std::numbers::pi * 0.525 / 0.6328;
  const MieCoefficients sphere = mie_coefficients(x, 1.55);
  const MieEfficiencies q = mie_efficiencies(sphere);
  EXPECT_NEAR(q.extinction, 3.10543, 5.1e-6);
  EXPECT_NEAR(q.backscatter, 2.92534, 5.1e-6);
  const std::vector<double> s11 = {1,          0.785390,   0.356897,  0.0766119, 0.0355355,  0.0701845,  0.0574313,
                                   0.0219660,  0.0125959,  0.0173750, 0.0124601, 0.00679093, 0.00954239, 0.00863419,
                                   0.00227421, 0.00543998, 0.0160243, 0.0188852, 0.0195254,  0.0301676,  0.0383189};
  for (std::size_t n = 0; n < s11.size(); ++n) {
    const double mu = std::cos(static_cast<double>(n) * 9 * std::numbers::pi / 180);
    EXPECT_NEAR(intensity(sphere, mu) / intensity(sphere, 1) / s11[n], 1, 1e-5) << 9 * n << " degrees";
  }
}

// Intensities (|S_1|^2 + |S_2|^2)/2 and polarisation of Wiscombe (1979), appendix, every 20 or 30 degrees; six digits
// and four.
TEST(MieSphere, AgreesWithWiscombesIntensities) {
  struct Row {
    double x, angle_deg, intensity, polarisation;
  };
  for (const Row& row :
       {Row{10, 0, 0.520856e4, 0}, Row{10, 5, 0.428132e4, -0.0239}, Row{10, 30, 0.768071e2, 0.0005},
        Row{10, 90, 0.917521e1, -0.0269}, Row{10, 180, 0.423766e2, 0}, Row{100, 0, 0.275508e8, 0},
        Row{100, 5, 0.106440e6, -0.0107}, Row{100, 90, 0.505356e3, -0.0016}, Row{100, 180, 0.434048e4, 0},
        Row{1000, 0, 0.253568e12, 0}, Row{1000, 5, 0.482785e7, -0.0455}, Row{1000, 90, 0.248427e5, 0.0127},
        Row{1000, 180, 0.257577e7, 0}, Row{5000, 0, 0.157609e15, 0}, Row{5000, 90, 0.567675e6, 2}}) {
    const MieAmplitudes s =
        mie_amplitudes(mie_coefficients(row.x, 1.5), std::cos(row.angle_deg * std::numbers::pi / 180));
    const double mean = (std::norm(s.s1) + std::norm(s.s2)) / 2;
    EXPECT_NEAR(mean / row.intensity, 1, 1e-5) << row.x << " " << row.angle_deg;
    if (row.polarisation < 2) {
      EXPECT_NEAR((std::norm(s.s2) - std::norm(s.s1)) / 2 / mean, row.polarisation, 1e-4)
          << row.x << " " << row.angle_deg;
    }
  }
}

// Amplitudes of MIEV0's problem x = 1, m = 1.5 - 1i (Wiscombe's sign of the imaginary parts: conjugate to ours).
TEST(MieSphere, AgreesWithWiscombesAmplitudes) {
  const MieCoefficients sphere = mie_coefficients(1, {1.5, 1});
  const Complex s1[] = {{0.584080, 0.190515}, {0.565702, 0.187200}, {0.517525, 0.178443}, {0.456340, 0.167167},
                        {0.400212, 0.156643}, {0.362157, 0.149391}, {0.348844, 0.146829}};
  const Complex s2[] = {{0.584080, 0.190515},   {0.500161, 0.145611},   {0.287964, 0.041054},  {0.036228, -0.061826},
                        {-0.174875, -0.122959}, {-0.305682, -0.143846}, {-0.348844, -0.146829}};
  for (int n = 0; n <= 6; ++n) {
    const MieAmplitudes s = mie_amplitudes(sphere, std::cos(n * std::numbers::pi / 6));
    EXPECT_NEAR(std::abs(std::conj(s.s1) - s1[n]), 0, 2e-6) << n;
    EXPECT_NEAR(std::abs(std::conj(s.s2) - s2[n]), 0, 2e-6) << n;
  }
}

// Ten to sixteen digits of an independent program: scattnlay 2.4 (as quoted by the tests of miepython). At x = 2 pi the
// recurrences start at sin x = 0.
TEST(MieSphere, AgreesWithScattnlayToTenDigits) {
  const double x = 2 * std::numbers::pi;
  const MieEfficiencies clear = efficiencies(x, 1.5), dark = efficiencies(x, {1.5, 0.1});
  EXPECT_NEAR(clear.extinction / 2.351382357157882, 1, 1e-12);
  EXPECT_NEAR(clear.backscatter / 2.53277025110356, 1, 1e-10);
  EXPECT_NEAR(clear.asymmetry_parameter / 0.583423159613144, 1, 1e-12);
  EXPECT_NEAR(dark.extinction / 2.5837269073859774, 1, 1e-12);
  EXPECT_NEAR(dark.scattering / 1.3566707303067342, 1, 1e-12);
  EXPECT_NEAR(dark.asymmetry_parameter / 0.8266873213103347, 1, 1e-12);
}

}  // namespace
}  // namespace cloudbow
