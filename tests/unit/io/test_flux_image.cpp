// Maps out of a result. Truth: the solution that was written, whose numbers encode their location.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/flux_image.hpp"
#include "sample_solution.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

TEST(FluxImage, IsTheLevelThatIsAskedFor) {
  const TemporaryFolder folder;
  const auto file = folder / "a.h5";
  write_result(file, sample::solution(3, 2, 4), sample::info());
  const auto expect_level = [&](const std::string& level, int k) {
    const FluxImage image = read_flux_image(file, "upwelling_flux", {level, std::nullopt});
    ASSERT_EQ(image.columns, 3);
    ASSERT_EQ(image.rows, 2);
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i)
        EXPECT_EQ(image.value[static_cast<std::size_t>(3 * j + i)], sample::field_value(1, k, j, i)) << level;
    }
  };
  expect_level("top", 4);
  expect_level("bottom", 0);
  expect_level("528", 1);  // interfaces at 510, 530, 560, ...
}

TEST(FluxImage, WithoutALevelIsTheTopOrForLightThatTravelsDownTheBottom) {
  const TemporaryFolder folder;
  const auto file = folder / "a.h5";
  Solution solution = sample::solution(3, 2, 4);
  solution.circumsolar_flux = solution.direct_flux;
  const std::vector<Solution> columns{sample::solution(3, 2, 4)};
  write_result(file, {&solution, 1}, sample::info(), columns);
  const auto place = [&](const std::string& variable) { return read_flux_image(file, variable, {}).place; };
  for (const char* variable : {"upwelling_flux", "difference_upwelling_flux"})
    EXPECT_EQ(place(variable), "z = 650 m") << variable;
  EXPECT_EQ(place("absorbed_power"), "z = 625 m") << "the middle of the highest cell";
  for (const char* variable : {"downwelling_diffuse_flux", "direct_flux", "direct_normal_flux", "circumsolar_flux",
                               "difference_direct_flux", "independent_columns_direct_flux"})
    EXPECT_EQ(place(variable), "z = 510 m") << variable;
  EXPECT_EQ(read_flux_image(file, "direct_flux", {"top", std::nullopt}).place, "z = 650 m") << "if it is asked for";
}

TEST(FluxImage, OneRowOfCellsIsASection) {
  const TemporaryFolder folder;
  const auto file = folder / "a.h5";
  write_result(file, sample::solution(3, 1, 4), sample::info());
  const FluxImage image = read_flux_image(file, "absorbed_power", {});
  EXPECT_EQ(image.columns, 3);
  EXPECT_EQ(image.rows, 4);
  EXPECT_EQ(image.value[3 * 2 + 1], sample::field_value(4, 2, 0, 1));
  EXPECT_EQ(image.row_edge_m, sample::solution(3, 1, 4).box.z_edge_m);
}

TEST(FluxImage, ListsWhatCanBeShownAndNamesItIfAnotherIsAskedFor) {
  const TemporaryFolder folder;
  const auto file = folder / "a.h5";
  write_result(file, sample::solution(3, 2, 4), sample::info());
  const std::vector<std::string> names = list_flux_images(file);
  for (const char* name : {"upwelling_flux", "downwelling_diffuse_flux", "direct_flux", "absorbed_power"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
  EXPECT_EQ(std::count(names.begin(), names.end(), "z_edge"), 0);
  EXPECT_THAT([&] { read_flux_image(file, "flux", {}); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("upwelling_flux")));
}

}  // namespace
}  // namespace cloudbow
