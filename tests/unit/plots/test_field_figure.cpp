// Figures of fields. Truth: colours by hand; axes in the units that the extent asks for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "plots/colormap.hpp"
#include "plots/field_figure.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

constexpr float nothing = std::numeric_limits<float>::quiet_NaN();

TEST(ValueRange, IsThatOfTheValuesUnlessChosen) {
  const std::vector<float> values{3, nothing, -1, 7};
  EXPECT_EQ(value_range(values, {}), std::pair(-1.0, 7.0));
  EXPECT_EQ(value_range(values, {.range = std::pair(9.0, 2.0)}), std::pair(9.0, 2.0));
  EXPECT_EQ(value_range(values, {.min = 0}), std::pair(0.0, 7.0));
  EXPECT_EQ(value_range(values, {.max = 5}), std::pair(-1.0, 5.0));
  EXPECT_THROW(value_range(values, {.min = 8}), InputError);
  EXPECT_THROW(value_range(values, {.range = std::pair(2.0, 2.0)}), InputError);
  EXPECT_GT(value_range({nothing}, {}).first, value_range({nothing}, {}).second);
}

TEST(ColourScale, ZeroHasTheMiddleOfADivergingMap) {
  const std::vector<Rgb> map = make_colormap("blue-red", 511);
  const ColourScale scale = colour_scale("heating_rate", "K s-1", {-30, 10}, {});
  EXPECT_EQ(scale.colours.front(), map.front());
  // 0 is three quarters up the scale: the colour nearest to it is within a step of the middle.
  const Rgb& zero = scale.colours[static_cast<std::size_t>(0.75 * static_cast<double>(scale.colours.size() - 1))];
  EXPECT_NEAR(zero[0], map[255][0], 3);
  // 10 of 30 is a third of the way from the middle to red.
  EXPECT_EQ(scale.colours.back(), map[static_cast<std::size_t>(std::lround(255 + 255 / 3.))]);
  EXPECT_EQ(colour_scale("difference_direct_flux", "", {1, 2}, {}).colours.back(), map.back());
}

TEST(ColourScale, OneSignTakesViridisAndAChoiceIsKept) {
  std::vector<Rgb> every_second;
  const std::vector<Rgb> all = make_colormap("viridis", 511);
  for (std::size_t n = 0; n < all.size(); n += 2) every_second.push_back(all[n]);
  EXPECT_EQ(colour_scale("upwelling_flux", "", {0, 2}, {}).colours, every_second);
  // Rounding leaves values below 0, which count as 0.
  EXPECT_EQ(colour_scale("f", "", {-1e-6, 2}, {}).colours.front(), make_colormap("viridis", 2).front());
  EXPECT_EQ(colour_scale("f", "", {-1, 2}, {.colormap = "grey"}).colours.front(), (Rgb{0, 0, 0}));
}

TEST(ColourScale, OneValueIsWidened) {
  for (const double value : {0.0, 7.0, -1e-12, 1e12}) {
    const ColourScale scale = colour_scale("f", "", {value, value}, {});
    EXPECT_LT(scale.range.first, value);
    EXPECT_GT(scale.range.second, value);
  }
}

FluxImage sample_image(double cell_m) {
  FluxImage image;
  image.variable = "upwelling_flux";
  image.units = "W m-2";
  image.long_name = "upwelling diffuse flux";
  image.place = "z = 30 m";
  image.columns = 3;
  image.rows = 2;
  image.column_start_m = -cell_m;
  image.column_width_m = cell_m;
  image.row_edge_m = {0, cell_m, 2 * cell_m};
  image.value = {0, 1, 2, 3, nothing, 5};
  return image;
}

std::string all_text(const Drawing& drawing) {
  std::string all;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* text = std::get_if<DrawnText>(&shape)) all += text->markup + "|";
  }
  return all;
}

TEST(FieldFigure, PixelsAreTheCellsFromTheTop) {
  const FluxImage image = sample_image(100);
  const ColourScale scale = colour_scale(image.variable, image.units, {0, 5}, {});
  const Drawing drawing = field_figure(image, scale, "T");
  const auto& picture = std::get<DrawnPicture>(drawing.shapes[2]);  // after the titles
  ASSERT_EQ(picture.width, 3);
  ASSERT_EQ(picture.height, 2);
  EXPECT_NEAR(picture.box.height() / picture.box.width(), 2 / 3., 1e-9);
  const auto pixel = [&picture](std::size_t n) {
    return Rgb{picture.rgba[4 * n], picture.rgba[4 * n + 1], picture.rgba[4 * n + 2]};
  };
  EXPECT_EQ(pixel(2), scale.colours.back());   // 5, top right
  EXPECT_EQ(pixel(3), scale.colours.front());  // 0, bottom left
  EXPECT_EQ(picture.rgba[4 * 1 + 3], 0);       // no value
  EXPECT_EQ(picture.rgba[4 * 2 + 3], 255);
}

TEST(FieldFigure, LongDomainsAreInKilometres) {
  const auto text = [](double cell_m) {
    const FluxImage image = sample_image(cell_m);
    return all_text(field_figure(image, colour_scale(image.variable, image.units, {0, 5}, {}), "Scene"));
  };
  EXPECT_THAT(text(100), HasSubstr("x [m]"));
  EXPECT_THAT(text(100), HasSubstr("|200|"));
  EXPECT_THAT(text(1000), HasSubstr("y [km]"));
  EXPECT_THAT(text(1000), HasSubstr("|\u22121"));
  EXPECT_THAT(text(1000), HasSubstr("upwelling flux [W\u202fm<sup>\u22122</sup>]"));
  EXPECT_THAT(text(1000), HasSubstr("upwelling diffuse flux, z\u00a0=\u00a030\u00a0m"));
  EXPECT_THAT(text(1000), HasSubstr("Scene|"));
}

// One cloudy cell at the left has one face at its top and one at its right, drawn twice: a pale rim, and a line.
TEST(FieldFigure, SectionsOutlineTheClouds) {
  FluxImage image = sample_image(1000);
  image.rows_along = "z";
  image.clouds = SectionClouds{{2e-4F, 0, 0, 0, 0, 0}, {0, 1000, 2000}};
  const auto drawn = [&image](double outline_per_m) {
    return field_figure(image, colour_scale(image.variable, image.units, {0, 5}, {}), "", outline_per_m);
  };
  const auto lines = [](const Drawing& drawing) {
    std::vector<DrawnLine> found;
    for (const Shape& shape : drawing.shapes) {
      const auto* line = std::get_if<DrawnLine>(&shape);
      if (line != nullptr && line->clip) found.push_back(*line);
    }
    return found;
  };
  const Drawing drawing = drawn(1e-4);
  const std::vector<DrawnLine> outline = lines(drawing);
  ASSERT_EQ(outline.size(), 4U);
  const PlotBox& box = *outline[0].clip;
  EXPECT_NEAR(outline[0].points[1].x - outline[0].points[0].x, box.width() / 3, 1e-9) << "one of three columns";
  EXPECT_NEAR(outline[1].points[0].y - outline[1].points[1].y, box.height() / 2, 1e-9) << "one of two rows";
  EXPECT_THAT(all_text(drawing), HasSubstr("line:\u00a0extinction\u00a00.1\u00a0km\u207b\u00b9"));
  for (const double none : {0., 2.1e-4}) {
    EXPECT_TRUE(lines(drawn(none)).empty());
    EXPECT_THAT(all_text(drawn(none)), testing::Not(HasSubstr("line:")));
  }
}

TEST(FieldFigure, UnevenRowsHaveTheirHeightInPixels) {
  FluxImage image = sample_image(100);
  image.rows_along = "z";
  image.row_edge_m = {0, 50, 200};
  const Drawing drawing = field_figure(image, colour_scale(image.variable, image.units, {0, 5}, {}), "");
  const auto picture =
      std::ranges::find_if(drawing.shapes, [](const Shape& s) { return std::holds_alternative<DrawnPicture>(s); });
  const auto& pixels = std::get<DrawnPicture>(*picture);
  std::size_t lower = 0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(pixels.height); ++row)
    lower += pixels.rgba[4 * 3 * row + 1] == colour_scale("", "", {0, 5}, {}).colours.front()[1];
  EXPECT_NEAR(static_cast<double>(lower) / pixels.height, 0.25, 1. / pixels.height);
}

TEST(ProfileFigure, CurvesHaveValuesToTheRightAndHeightUpwards) {
  const FluxProfile up{"upwelling_flux", "W m-2", "", "", {}, {0, 1000, 3000}, {100, 200, 400}, 0, 3000};
  FluxProfile down = up;
  down.variable = "direct_flux";
  down.value = {0, 50, 100};
  const Drawing drawing = profile_figure({up, down}, "Scene");
  std::vector<DrawnLine> curves;
  for (const Shape& shape : drawing.shapes) {
    const auto* line = std::get_if<DrawnLine>(&shape);
    if (line != nullptr && line->clip) curves.push_back(*line);
  }
  ASSERT_EQ(curves.size(), 2u);
  const PlotBox frame = *curves[0].clip;
  EXPECT_DOUBLE_EQ(curves[0].points[0].y, frame.bottom);
  EXPECT_DOUBLE_EQ(curves[0].points[2].y, frame.top);
  EXPECT_NEAR(curves[0].points[1].y, frame.bottom - frame.height() / 3, 1e-9);
  // The axis goes from 0 to 400, with 3 % of that as margin at each side.
  const double left = frame.left + 0.03 / 1.06 * frame.width(), width = frame.width() / 1.06;
  EXPECT_NEAR(curves[0].points[2].x, left + width, 1e-9);      // 400
  EXPECT_NEAR(curves[1].points[2].x, left + width / 4, 1e-9);  // 100
  EXPECT_NEAR(curves[1].points[0].x, left, 1e-9);              // 0
  const std::string text = all_text(drawing);
  for (const char* part : {"z [km]", "flux [W", "upwelling flux|", "direct flux|", "domain mean", "Scene"})
    EXPECT_THAT(text, HasSubstr(part));
  EXPECT_THAT(all_text(profile_figure({up}, "")), testing::Not(HasSubstr("|upwelling flux|")));
}

TEST(ProfileFigure, CellsAreStairsFromFaceToFace) {
  const FluxProfile rate{"heating_rate", "K s-1", "", "", {}, {50, 200}, {1, 2}, 0, 300, {0, 100, 300}};
  const Drawing drawing = profile_figure({rate}, "");
  const auto line = std::ranges::find_if(drawing.shapes, [](const Shape& shape) {
    return std::holds_alternative<DrawnLine>(shape) && std::get<DrawnLine>(shape).clip;
  });
  ASSERT_NE(line, drawing.shapes.end());
  const auto& [points, stroke, clip] = std::get<DrawnLine>(*line);
  ASSERT_EQ(points.size(), 4u);
  EXPECT_NEAR(points[0].y, clip->bottom, 1e-9);
  EXPECT_NEAR(points[1].y, clip->bottom - clip->height() / 3, 1e-9);
  EXPECT_EQ(points[1].y, points[2].y);
  EXPECT_NEAR(points[3].y, clip->top, 1e-9);
  EXPECT_EQ(points[0].x, points[1].x);
  EXPECT_LT(points[1].x, points[2].x);
}

TEST(ProfileFigure, RefusesProfilesWithoutOneValuePerHeight) {
  FluxProfile profile{"direct_flux", "W m-2", "", "", {}, {0, 1000, 3000}, {1, 2, 3, 1, 2, 3}, 0, 3000};
  EXPECT_THROW(profile_figure({profile}, ""), InputError);
  profile.value = {1, 2};
  EXPECT_THROW(profile_figure({profile}, ""), InputError);
  profile.value = {1, 2, 3};
  profile.face_m = {0, 500, 3000};
  EXPECT_THROW(profile_figure({profile}, ""), InputError);
}

TEST(ColourScale, HasATickNearEachEnd) {
  for (const double last : {1.9, 2.4, 3.7, 5.3, 8.6, 9.9}) {
    const ColourScale scale = colour_scale("f", "1", {0.04, last}, {});
    const std::vector<double> ticks = axis_ticks(scale.axis, scale.range);
    EXPECT_LT(ticks.front() - 0.04, 0.21 * last) << last;  // the widest spacing is 2.5 twelfths
    EXPECT_LT(last - ticks.back(), 0.21 * last) << last;
  }
}

TEST(ReadableName, HasNoUnderscores) {
  EXPECT_EQ(readable_name("net_absorbed_power"), "net absorbed power");
  EXPECT_EQ(readable_name("difference_direct_flux"), "difference of direct flux");
  EXPECT_EQ(readable_name("camera_west"), "radiance");
  EXPECT_EQ(readable_name("reflectance_factor_nadir"), "reflectance factor");
}

}  // namespace
}  // namespace cloudbow
