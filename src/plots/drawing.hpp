// The content of a figure before a library draws it: lines, areas, texts and pictures, in the order in which they are
// drawn. Lengths are points (1/72 inch), x to the right, y down.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace cloudbow {

using PlotColour = std::array<std::uint8_t, 3>;  ///< sRGB

struct PlotPoint {
  double x, y;
};

struct PlotBox {
  double left, top, right, bottom;
  double width() const { return right - left; }
  double height() const { return bottom - top; }
};

struct Stroke {
  PlotColour colour{0, 0, 0};
  double width = 1;
  std::vector<double> dash{};  ///< lengths of line and gap in turn; empty: unbroken
  double opacity = 1;
};

struct DrawnLine {
  std::vector<PlotPoint> points;
  Stroke stroke;
  std::optional<PlotBox> clip{};
};

struct DrawnArea {
  PlotBox box;
  PlotColour colour;
  double opacity = 1;
};

struct DrawnDisc {
  PlotPoint centre;
  double radius;
  PlotColour colour;
  std::optional<PlotBox> clip{};
};

/// Pixels stretched over a box, without interpolation.
struct DrawnPicture {
  PlotBox box;
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< [row][column][channel], row 0 on top; alpha is 0 or 255
};

/// The point of a text that is put at its place. Across: left, centre or right.
enum class TextAnchor { left, centre, right };
/// Along the height: the middle of the capitals (of several lines: of all), or the upper edge.
enum class TextHold { middle, top };
enum class TextTurn { none, upwards };

struct DrawnText {
  std::string markup;  ///< Pango's, in UTF-8; see plain_text()
  PlotPoint place;
  double size = 9;  ///< of the font
  TextAnchor anchor = TextAnchor::left;
  TextHold hold = TextHold::middle;
  TextTurn turn = TextTurn::none;
  PlotColour colour{30, 30, 30};
  double max_width = 0;  ///< > 0: longer lines are broken
  int max_lines = 0;     ///< > 0: with max_width, an ellipsis ends the last line
};

using Shape = std::variant<DrawnLine, DrawnArea, DrawnDisc, DrawnPicture, DrawnText>;

struct Drawing {
  double width = 0, height = 0;
  std::string title{};  ///< plain text, for the properties of SVG and PDF files
  std::vector<Shape> shapes{};

  /// @tparam Kind one of the shapes, made in its place: g++ 12 warns with -O3 if a Shape is moved there.
  template <class Kind>
  void add(Kind shape) {
    shapes.emplace_back(std::in_place_type<Kind>, std::move(shape));
  }
};

struct TextSize {
  double width = 0, height = 0;  ///< along and across the lines
  int lines = 0;
};

/// @throws InputError if the drawing module cannot be loaded or the machine has no font.
TextSize measure_text(const DrawnText& text);

/// The box that a text covers, turned and put in its place.
PlotBox text_box(const DrawnText& text);

/// The smallest size, not below `least_size`, is taken at which the text has at most `lines` lines; if it has more even
/// then, the rest is cut and an ellipsis shows it. @param text with max_width
void fit_text(DrawnText& text, int lines, double least_size);

/// Writes PNG, SVG or PDF by the ending of the name, atomically. The same drawing gives the same bytes.
/// @param pixel_width of PNG; 0: as many pixels per point as the default of figures. SVG and PDF are as large as the
/// drawing.
/// @returns width and height in pixels, or in points.
/// @throws InputError if the file cannot be written, or its name has another ending.
std::array<int, 2> write_drawing(const std::filesystem::path& file, const Drawing& drawing, int pixel_width = 0);

}  // namespace cloudbow
