// A drawing surface for plots: anti-aliased lines, areas and text, written as PNG. Lengths are pixels, x to the right,
// y down, whole numbers between pixels.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
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
  double width = 1.5;
  std::vector<double> dash;  ///< lengths of line and gap in turn; empty: unbroken
  double opacity = 1;
};

/// The point of a text that is put at the place given: left, middle or right of it; baseline, or half the height of a
/// capital.
enum class TextAnchor { left, centre, right };
enum class TextTurn { none, upwards };

class PlotCanvas {
 public:
  PlotCanvas(int width, int height);

  int width() const { return width_; }
  int height() const { return height_; }
  void fill(const PlotBox& box, PlotColour colour, double opacity = 1);
  /// A line through the points, with round ends and corners, nowhere drawn twice.
  void line(std::span<const PlotPoint> points, const Stroke& stroke, const PlotBox& clip);
  void line(std::span<const PlotPoint> points, const Stroke& stroke) { line(points, stroke, everything()); }
  void disc(PlotPoint centre, double radius, PlotColour colour, const PlotBox& clip);
  /// @param place of the anchor, at half the height of a capital
  /// @param text UTF-8; "^{...}" is raised, "_{...}" is lowered
  /// @param size height of a capital letter
  void text(std::string_view text, PlotPoint place, double size, TextAnchor anchor = TextAnchor::left,
            TextTurn turn = TextTurn::none, PlotColour colour = {30, 30, 30});
  static double text_width(std::string_view text, double size);

  PlotBox everything() const { return {0, 0, static_cast<double>(width_), static_cast<double>(height_)}; }
  PlotColour colour_at(int x, int y) const;
  /// @throws InputError if the file can't be written, or its name has the ending of another kind of picture.
  void write_png(const std::filesystem::path& file) const;

 private:
  void blend(int x, int y, PlotColour colour, double opacity);
  void cover(PlotPoint a, PlotPoint b, double width, const PlotBox& clip, const PlotBox& bounds,
             std::vector<float>& coverage) const;

  int width_, height_;
  std::vector<std::uint8_t> rgb_;  // [row][column][channel]
};

}  // namespace cloudbow
