// Results read back. Truth: the solution that was written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloudbow/core/error.hpp"
#include "io/result_input.hpp"
#include "sample_solution.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class ResultInputTest : public testing::Test {
 protected:
  std::filesystem::path written(const Solution& solution) const {
    write_result(folder_ / "a.h5", solution, sample::info());
    return folder_ / "a.h5";
  }
  const TemporaryFolder folder_;
};

TEST_F(ResultInputTest, HasTheGridAndTheFieldsOfTheSolution) {
  const Solution solution = sample::solution(3, 2, 4);
  const ResultInput input(written(solution));
  EXPECT_EQ(input.box().nx, 3);
  EXPECT_EQ(input.box().ny, 2);
  EXPECT_EQ(input.box().z_edge_m, solution.box.z_edge_m);
  EXPECT_NEAR(input.box().dx_m, 25, 1e-9);
  EXPECT_NEAR(input.box().x_min_m, 100, 1e-9);
  EXPECT_NEAR(input.box().y_min_m, -50, 1e-9);
  EXPECT_EQ(input.cell_field("absorbed_power", "absorption"), solution.absorbed_power);
  EXPECT_EQ(input.units("absorbed_power", "none"), "W m-3");
  EXPECT_FALSE(input.has("heating_rate"));
}

TEST_F(ResultInputTest, WhatIsMissingIsNamedWithTheFieldThatMakesIt) {
  Solution solution = sample::solution(3, 2, 4);
  solution.actinic_flux.clear();
  const auto file = written(solution);
  EXPECT_THAT([&] { ResultInput(file).cell_field("actinic_flux", "actinic"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("a.h5"), HasSubstr("actinic"))));
  EXPECT_THAT([&] { RadianceFieldInput{ResultInput(file)}; }, ThrowsMessage<InputError>(HasSubstr("radiance_field")));
}

TEST_F(ResultInputTest, RadiancesAreThoseOfTheStencil) {
  const ControlPoints points(42);
  Solution solution = sample::solution(3, 2, 4);
  solution.radiance_field = sample::radiance_field(points, {{0, 1, 2}, {2, 0, 3}});
  const ResultInput result(written(solution));
  const RadianceFieldInput field(result);
  EXPECT_EQ(field.cells(), (std::vector<CellIndex>{{0, 1, 2}, {2, 0, 3}}));
  ASSERT_EQ(field.directions().size(), 42U);
  for (const Direction& travel : sample::directions()) {
    const std::vector<float> radiance = field.radiance(field.stencil(travel));
    for (std::size_t c = 0; c < 2; ++c)
      EXPECT_NEAR(radiance[c], sample::queried(points, *solution.radiance_field, c, travel), 1e-4);  // floats up to 300
  }
}

}  // namespace
}  // namespace cloudbow
