// Files of sets of phase functions. Truth: the moments of the functions that the files are made of.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
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

TEST_F(PhaseFiles, SetsTellTheFactorByTheirSignToo) {
  const auto set = [&](const std::string& text, MomentFactor factor) {
    return read_phase_set_file(folder_.write("set.csv", text), factor);
  };
  const std::string rayleigh = "l,a,b\n0,1,1\n1,0,0.3\n2,0.5,0.1\n";  // times 2l+1: a is negative otherwise
  const PhaseSetFile read = set(rayleigh, MomentFactor::automatic);
  EXPECT_TRUE(read.factor_was_included);
  EXPECT_THAT(read.moments, ElementsAre(ElementsAre(1, 0, 0.1), ElementsAre(1, 0.3 / 3, 0.1 / 5)));
  EXPECT_THAT(message([&] { set(rayleigh, MomentFactor::excluded); }),
              AllOf(HasSubstr("set.csv: function 1"), HasSubstr("-0.25 at 90")));
  EXPECT_FALSE(set("0 1 1\n1 0.5 0\n2 0.25 0.1\n", MomentFactor::automatic).factor_was_included);
  EXPECT_TRUE(set("0 1 1\n1 1.5 0\n2 1.25 0.1\n", MomentFactor::automatic).factor_was_included);
  std::string cut = "l,smooth,cut\n";
  for (int l = 0; l < 64; ++l) cut += fmt::format("{},{},{}\n", l, std::pow(0.5, l), std::pow(0.9, l));
  EXPECT_THAT(set(cut, MomentFactor::excluded).note, AllOf(HasSubstr("function 2"), HasSubstr("-0.05")));
}

}  // namespace
}  // namespace cloudbow
