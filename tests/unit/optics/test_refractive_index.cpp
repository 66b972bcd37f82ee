// Refractive indices of water and ice. Truth: the published rows, and a second compilation.
#include <gtest/gtest.h>

#include <cmath>

#include "../near_with_report.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/refractive_index.hpp"

namespace cloudbow {
namespace {

void expect_index(Substance substance, double um, double n, double n_slack, double k, double k_relative) {
  const auto m = refractive_index(substance, um);
  EXPECT_NEAR(m.real(), n, n_slack) << um;
  EXPECT_NEAR(m.imag() / k, 1, k_relative) << um;
}

// Rows of Segelstein (1981) that the table leaves out or rounds: the error of thinning.
TEST(RefractiveIndex, WaterKeepsToTheRowsLeftOut) {
  expect_index(Substance::water, 0.34514374, 1.359231, 2e-5, 2.6533231e-9, 0.01);
  expect_index(Substance::water, 0.46025657, 1.342858, 2e-5, 7.5995897e-10, 0.01);
  expect_index(Substance::water, 0.53456437, 1.336943, 2e-5, 1.8870793e-9, 0.03);
  expect_index(Substance::water, 0.67452802, 1.329690, 2e-5, 2.1766577e-8, 0.02);
  expect_index(Substance::water, 0.86496795, 1.324373, 2e-5, 3.5464198e-7, 0.01);
  expect_index(Substance::water, 2.1183611, 1.290795, 1e-4, 4.1762851e-4, 0.01);
  expect_index(Substance::water, 2.6363314, 1.215699, 2e-3, 4.3630495e-3, 0.03);
  expect_index(Substance::water, 2.9040227, 1.208002, 2e-3, 2.6472207e-1, 0.01);
  expect_index(Substance::water, 6.7452802, 1.304521, 2e-4, 3.3097115e-2, 0.01);
  expect_index(Substance::water, 15.100802, 1.251704, 1e-3, 4.0531264e-1, 0.01);
  expect_index(Substance::water, 89.949760, 1.874242, 1e-3, 4.6536117e-1, 0.01);
  expect_index(Substance::water, 159.95580, 1.941655, 1e-3, 4.3330145e-1, 0.01);
  expect_index(Substance::water, 950.60477, 2.385313, 5e-3, 1.0110908, 0.01);
}

// Hale & Querry, Appl. Opt. 12, 555 (1973), an independent compilation, at wavelengths of both. The slack is the
// difference of the two sources: k is least certain at its minimum in the visible.
TEST(RefractiveIndex, WaterAgreesWithHaleAndQuerry) {
  expect_index(Substance::water, 0.45, 1.337, 0.008, 1.02e-9, 0.25);
  expect_index(Substance::water, 0.55, 1.333, 0.004, 1.96e-9, 0.3);
  expect_index(Substance::water, 0.65, 1.331, 0.002, 1.64e-8, 0.05);
  expect_index(Substance::water, 0.9, 1.328, 0.005, 4.86e-7, 0.05);
  expect_index(Substance::water, 1.6, 1.317, 0.008, 8.55e-5, 0.12);
  expect_index(Substance::water, 2.2, 1.296, 0.012, 2.89e-4, 0.20);
  expect_index(Substance::water, 3.1, 1.467, 0.02, 0.192, 0.05);
  expect_index(Substance::water, 10, 1.218, 0.03, 0.0508, 0.02);
  expect_index(Substance::water, 12, 1.111, 0.03, 0.199, 0.05);
}

// Rows of Warren & Brandt (2008), and one between rows by hand.
TEST(RefractiveIndex, IceIsAsPublished) {
  expect_index(Substance::ice, 0.55, 1.3110, 1e-12, 2.289e-9, 1e-12);
  expect_index(Substance::ice, 1.65, 1.2879, 1e-12, 2.361e-4, 1e-12);
  expect_index(Substance::ice, 11, 1.0886, 1e-12, 0.248, 1e-12);
  expect_index(Substance::ice, 48, 1.5874, 1e-12, .8158, 1e-12);
  expect_index(Substance::ice, 500, 1.7908, 1e-12, .01405, 1e-12);
  const double t = std::log(3.9 / 3.847) / std::log(3.969 / 3.847);
  expect_index(Substance::ice, 3.9, 1.3750 + t * (1.3623 - 1.3750), 1e-12, 8.248e-3 * std::pow(1.112e-2 / 8.248e-3, t),
               1e-12);
}

TEST(RefractiveIndex, CoversItsRangeAndNoMore) {
  for (const Substance substance : {Substance::water, Substance::ice}) {
    double before = refractive_index(substance, shortest_index_wavelength).real();
    for (double um = shortest_index_wavelength; um <= longest_index_wavelength; um *= 1.002) {
      const auto m = refractive_index(substance, um);
      EXPECT_GT(m.imag(), 0);
      // No slip of the pen: n moves by less than 0.04 in a step of 0.2 % (the bands at 2.9 and 3.06 um are the
      // steepest).
      EXPECT_NEAR(m.real(), before, 0.04) << um;
      before = m.real();
    }
    EXPECT_NO_THROW(refractive_index(substance, longest_index_wavelength));
    EXPECT_THROW(refractive_index(substance, 0.1999), InputError);
    EXPECT_THROW(refractive_index(substance, 1001), InputError);
    EXPECT_THROW(refractive_index(substance, std::nan("")), InputError);
  }
}

}  // namespace
}  // namespace cloudbow
