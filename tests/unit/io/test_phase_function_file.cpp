// Files of a phase function. Truth: closed forms of the functions that the files are made of.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/phase_function_file.hpp"
#include "cloudbow/io/phase_set_file.hpp"
#include "phase_file_tools.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(PhaseFiles, TablesAreReadHoweverTheyAreWritten) {
  const auto exponent = [](double angle, double value) {
    std::string text = fmt::format("{} {:e}", angle, value);
    return text.replace(text.find('e'), 1, "D");
  };
  for (const std::string& text :
       {lines(180, plain), "! Fortran's comment\n" + lines(180, plain) + "# the end\n", lines(180, exponent),
        lines(180, [](double angle, double value) { return fmt::format("{}, {}  ! both", angle, value); }),
        lines(180, [](double angle, double value) { return fmt::format("+{}\t+{}\r", angle, value); }),
        lines(180, [](double angle, double value) {
          return plain(180 - angle, PhaseFunction::henyey_greenstein(0.5)(-std::cos(angle * degree)) + 0 * value);
        })}) {
    const PhaseFunctionFile read = table(text);
    expect_henyey_greenstein(read);
    EXPECT_THAT(read.notes, IsEmpty());
  }
}

TEST_F(PhaseFiles, RadiansCosinesAndOtherNormsAreTold) {
  const auto radians = [](double angle, double value) { return fmt::format("{:.4f} {}", angle * degree, value); };
  PhaseFunctionFile read = table(lines(180, radians));
  expect_henyey_greenstein(read);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("radians")));
  read = table(lines(
      180, [](double angle, double value) { return fmt::format("{:.12f} {}", std::cos(angle * degree), value); }));
  expect_henyey_greenstein(read);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("cosine")));
  read = table(lines(180, plain, 0.25 / std::numbers::pi));
  expect_henyey_greenstein(read);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("integral 1 over the sphere")));
  read = table(lines(180, plain, 0.5));
  expect_henyey_greenstein(read);
  EXPECT_THAT(read.notes, ElementsAre(HasSubstr("integral 1 over the cosine")));
}

TEST_F(PhaseFiles, AnIntegralThatIsOffIsToldOrRefused) {
  EXPECT_THAT(table(lines(180, plain, 1.0005)).notes, IsEmpty());
  EXPECT_THAT(table(lines(180, plain, 1.005)).notes, ElementsAre(HasSubstr("off by +0.5")));
  EXPECT_THAT(table(lines(180, plain, 0.995)).notes, ElementsAre(HasSubstr("off by -0.49")));
  EXPECT_NEAR(table(lines(180, plain, 1.005)).function.moment(1), 0.5, 1e-4);
  for (const double factor : {1.02, 0.98, 5.0, 4 * std::numbers::pi, 1e-300}) {
    EXPECT_THAT(table_message(lines(180, plain, factor)),
                AllOf(HasSubstr("table.txt: "), HasSubstr("wrong norm"), HasSubstr("divide")))
        << factor;
  }
  // 20 degrees are too coarse for the peak: the trapezoids' sum is 1.026.
  EXPECT_THAT(table_message(lines(9, plain)), AllOf(HasSubstr("wrong norm (found mean 1.0"), HasSubstr("more angles")));
}

TEST_F(PhaseFiles, OtherTablesAreRefusedWithTheLayout) {
  EXPECT_THAT(table_message("0 1\n90 1 1\n180 1\n"), AllOf(HasSubstr("table.txt:2"), HasSubstr("angle_deg value")));
  EXPECT_THAT(table_message("1\n1\n1\n"), AllOf(HasSubstr("table.txt:1"), HasSubstr("angle_deg value")));
  EXPECT_THAT(table_message("angle value\n0 1\n180 1\n"),
              AllOf(HasSubstr("table.txt:1"), HasSubstr("found 'angle value'")));
  EXPECT_THAT(table_message("0 1\n180 nan\n"), HasSubstr("table.txt:2"));
  EXPECT_THAT(table_message(""), HasSubstr("0 angles"));
  EXPECT_THAT(table_message("0 1\n90 1\n"), HasSubstr("angles run from 0 to 90"));
  EXPECT_THAT(table_message("0 1\n120 1\n90 1\n180 1\n"), HasSubstr("ascending"));
  EXPECT_THAT(table_message("0 1\n90 -0.1\n180 1\n"), HasSubstr("value -0.1 at 90 degrees"));
}

TEST_F(PhaseFiles, MomentsWithTheirDegreesOrAlone) {
  for (const char* text : {"0 1\n1 0.5\n2 0.25\n", "1.0\n0.5D0\n 2.5e-1\n", "0,1\n1,0.5 ! half\n2,0.25\n"}) {
    const PhaseFunctionFile read = legendre(text);
    EXPECT_EQ(read.function.moment(1), 0.5);
    EXPECT_EQ(read.function.moment(2), 0.25);
    EXPECT_EQ(read.function.moments().size(), 3u);
    EXPECT_THAT(read.notes, IsEmpty());
  }
  EXPECT_THAT(legendre_message("3\n1.0\n0.5\n"), HasSubstr("moment 0 is 3"));
  EXPECT_THAT(legendre_message("1.0\n1 0.5\n"), AllOf(HasSubstr("moments.txt:2"), HasSubstr("l chi_l")));
  EXPECT_THAT(legendre_message("0 1\n2 0.5\n"), HasSubstr("found l = 2, allowed l = 1"));
}

TEST_F(PhaseFiles, MomentsWithTheFactorAreRefused) {
  EXPECT_THAT(legendre_message("0 1\n1 2.55\n2 3.6125\n"), AllOf(HasSubstr("2.55"), HasSubstr("2l+1")));
  EXPECT_THAT(legendre_message("0 1\n1 0\n2 0.5\n"),
              AllOf(HasSubstr("moments.txt: "), HasSubstr("found -0.25 at 90 degrees"), HasSubstr("2l+1")));
  std::string cut;
  for (int l = 0; l < 64; ++l) cut += fmt::format("{} {}\n", l, std::pow(0.9, l));
  EXPECT_THAT(legendre(cut).notes, ElementsAre(HasSubstr("falls to -0.05")));
}

}  // namespace
}  // namespace cloudbow
