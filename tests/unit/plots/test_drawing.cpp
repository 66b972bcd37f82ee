// Drawings on paper. Truth: areas of ink in closed form; the boxes that texts are said to cover.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "cloudbow/core/error.hpp"
#include "plots/drawing.hpp"
#include "render_fixture.hpp"

namespace cloudbow {
namespace {

class DrawingTest : public testing::Test {
 protected:
  DrawingTest() {
    std::string name = (fs::temp_directory_path() / "cloudbow-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~DrawingTest() override { fs::remove_all(folder_); }

  /// One pixel per point.
  Picture paint(const Drawing& drawing) {
    write_drawing(folder_ / "d.png", drawing, static_cast<int>(drawing.width));
    return read_png(folder_ / "d.png");
  }

  fs::path folder_;
};

double ink(const Picture& picture) {
  double sum = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) sum += (255 - picture.channel(x, y, 1)) / 255.0;
  }
  return sum;
}

TEST_F(DrawingTest, ALineCoversLengthTimesWidthAndItsRoundEnds) {
  for (const double width : {0.5, 1.0, 3.0}) {
    Drawing drawing{.width = 300, .height = 200};
    drawing.add(DrawnLine{{{20.3, 30.7}, {260.1, 150.2}}, {{0, 0, 0}, width}});
    const double length = std::hypot(239.8, 119.5);
    // Pixels have 256 levels, which a line of half a pixel takes few of.
    EXPECT_NEAR(ink(paint(drawing)), length * width + std::acos(-1) / 4 * width * width, 0.02 * length * width);
  }
}

TEST_F(DrawingTest, DashesGapsAndClips) {
  Drawing drawing{.width = 120, .height = 20};
  drawing.add(DrawnLine{{{10, 10.5}, {110, 10.5}}, {{0, 0, 0}, 1, {10, 10}}, PlotBox{0, 0, 60, 20}});
  const Picture picture = paint(drawing);
  EXPECT_EQ(picture.red(15, 10), 0);
  EXPECT_EQ(picture.red(25, 10), 255);
  EXPECT_EQ(picture.red(35, 10), 0);
  EXPECT_EQ(picture.red(75, 10), 255);  // beyond the clip
}

TEST_F(DrawingTest, PicturesKeepTheirPixelsAndAlphaShowsThePaper) {
  Drawing drawing{.width = 40, .height = 20};
  drawing.add(DrawnPicture{{10, 5, 30, 15}, 2, 1, {200, 100, 50, 255, 1, 2, 3, 0}});
  const Picture picture = paint(drawing);
  for (const int x : {10, 15, 19}) {
    EXPECT_EQ(picture.channel(x, 9, 0), 200);
    EXPECT_EQ(picture.channel(x, 9, 1), 100);
    EXPECT_EQ(picture.channel(x, 9, 2), 50);
  }
  EXPECT_EQ(picture.red(20, 9), 255);
  EXPECT_EQ(picture.red(9, 9), 255);
}

TEST_F(DrawingTest, DiscsAndAreasHaveTheirSize) {
  Drawing drawing{.width = 100, .height = 100};
  drawing.add(DrawnDisc{{50, 50}, 20, {0, 0, 0}});
  EXPECT_NEAR(ink(paint(drawing)), std::acos(-1) * 400, 5);
  Drawing area{.width = 100, .height = 100};
  area.add(DrawnArea{{10, 10, 30.5, 20}, {0, 0, 0}, 0.5});
  EXPECT_NEAR(ink(paint(area)), 0.5 * 20.5 * 10, 1);
}

/// The box around all that is not white.
PlotBox inked(const Picture& picture) {
  PlotBox box{1e9, 1e9, -1, -1};
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      if (picture.red(x, y) == 255) continue;
      box = {std::min(box.left, x + 0.), std::min(box.top, y + 0.), std::max(box.right, x + 1.),
             std::max(box.bottom, y + 1.)};
    }
  }
  return box;
}

TEST_F(DrawingTest, TextLiesInsideItsBoxHoweverItIsPut) {
  for (const TextAnchor anchor : {TextAnchor::left, TextAnchor::centre, TextAnchor::right}) {
    for (const TextHold hold : {TextHold::middle, TextHold::top}) {
      for (const TextTurn turn : {TextTurn::none, TextTurn::upwards}) {
        for (const double max_width : {0., 60.}) {
          DrawnText text{.markup = "Hxg 10<sup>\u22126</sup> W m<sup>\u22122</sup>", .place = {200, 200}};
          text.anchor = anchor, text.hold = hold, text.turn = turn, text.max_width = max_width;
          Drawing drawing{.width = 400, .height = 400};
          drawing.add(text);
          const PlotBox box = text_box(text), there = inked(paint(drawing));
          const auto where = testing::Message() << static_cast<int>(anchor) << static_cast<int>(hold)
                                                << static_cast<int>(turn) << max_width;
          // Edges of letters may colour a pixel outside; nothing is further off than a letter's side bearing.
          EXPECT_GE(there.left, box.left - 1) << where;
          EXPECT_LE(there.right, box.right + 1) << where;
          EXPECT_GE(there.top, box.top - 1) << where;
          EXPECT_LE(there.bottom, box.bottom + 1) << where;
          const bool upwards = turn == TextTurn::upwards;
          EXPECT_NEAR(upwards ? there.height() : there.width(), upwards ? box.height() : box.width(), 3) << where;
        }
      }
    }
  }
}

TEST_F(DrawingTest, AnchorsAndHoldsAreWhereTheySay) {
  DrawnText text{.markup = "HHHH", .place = {100, 20}, .size = 14};
  const double width = measure_text(text).width;
  const auto box = [&](TextAnchor anchor) {
    text.anchor = anchor;
    Drawing drawing{.width = 200, .height = 40};
    drawing.add(text);
    return inked(paint(drawing));
  };
  EXPECT_NEAR(box(TextAnchor::left).left, 100, 2);
  EXPECT_NEAR(box(TextAnchor::left).right, 100 + width, 2);
  EXPECT_NEAR(box(TextAnchor::centre).left, 100 - width / 2, 2);
  EXPECT_NEAR(box(TextAnchor::right).right, 100, 2);
  const PlotBox capitals = box(TextAnchor::left);
  EXPECT_NEAR((capitals.top + capitals.bottom) / 2, 20, 0.6);  // the middle of the capitals
}

TEST_F(DrawingTest, LongTextsAreBrokenShrunkAndAtLastCut) {
  std::string words;
  for (int n = 0; n < 12; ++n) words += "cumulus ";
  DrawnText text{.markup = words, .place = {0, 0}, .size = 12, .max_width = 200};
  EXPECT_GT(measure_text(text).lines, 3);
  fit_text(text, 3, 6);
  EXPECT_LT(text.size, 12);
  EXPECT_EQ(measure_text(text).lines, 3);
  EXPECT_LE(measure_text(text).width, 200);
  for (int n = 0; n < 5; ++n) text.markup += text.markup;
  fit_text(text, 3, 6);
  EXPECT_EQ(measure_text(text).lines, 3);
  EXPECT_LE(measure_text(text).width, 200.5);
  DrawnText one_word{.markup = std::string(500, 'W'), .place = {0, 0}, .size = 12, .max_width = 200};
  fit_text(one_word, 3, 6);
  EXPECT_LE(measure_text(one_word).width, 200.5);
}

TEST_F(DrawingTest, SuperscriptsAreSmall) {
  const auto width = [](const char* markup) { return measure_text({.markup = markup, .place = {0, 0}}).width; };
  EXPECT_LT(width("10<sup>\u22123</sup>"), width("10\u22123"));
}

TEST_F(DrawingTest, AnyMarkupThatIsNoneIsShownAsNothing) {
  for (const char* markup : {"", "<sup>", "\xff\xfe", "&"}) {
    Drawing drawing{.width = 100, .height = 40};
    drawing.add(DrawnText{.markup = markup, .place = {5, 20}});
    EXPECT_EQ(ink(paint(drawing)), 0) << markup;
  }
}

TEST_F(DrawingTest, APageThatEndsWithinAPixelIsWhiteToTheEnd) {
  const Drawing drawing{.width = 90, .height = 30.4};
  EXPECT_EQ(ink(paint(drawing)), 0);
  write_drawing(folder_ / "wide.png", drawing, 257);
  EXPECT_EQ(ink(read_png(folder_ / "wide.png")), 0);
}

TEST_F(DrawingTest, FormatsByTheEnding) {
  Drawing drawing{.width = 90, .height = 30, .title = "T"};
  drawing.add(DrawnText{.markup = "text", .place = {5, 15}});
  EXPECT_EQ(write_drawing(folder_ / "a.png", drawing), (std::array{240, 80}));
  EXPECT_EQ(write_drawing(folder_ / "a.svg", drawing), (std::array{90, 30}));
  EXPECT_EQ(write_drawing(folder_ / "a.pdf", drawing), (std::array{90, 30}));
  std::ifstream svg(folder_ / "a.svg");
  const std::string text{std::istreambuf_iterator<char>(svg), {}};
  EXPECT_THAT(text, testing::HasSubstr("width=\"90pt\" height=\"30pt\""));
  EXPECT_THROW(write_drawing(folder_ / "a.gif", drawing), InputError);
  EXPECT_THROW(write_drawing("/nowhere/a.png", drawing), InputError);
}

}  // namespace
}  // namespace cloudbow
