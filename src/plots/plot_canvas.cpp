#include "plots/plot_canvas.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "cloudbow/io/png_file.hpp"
#include "plots/plot_font.hpp"

namespace cloudbow {
namespace {

constexpr double text_stroke = 0.13;  // of the height of a capital

double distance_to_segment(PlotPoint p, PlotPoint a, PlotPoint b) {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const double square = dx * dx + dy * dy;
  const double t = square > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / square, 0.0, 1.0) : 0;
  return std::hypot(p.x - a.x - t * dx, p.y - a.y - t * dy);
}

/// Whole pixels that a box touches.
PlotBox pixels(const PlotBox& box) {
  return {std::floor(box.left), std::floor(box.top), std::ceil(box.right), std::ceil(box.bottom)};
}

PlotBox common(const PlotBox& a, const PlotBox& b) {
  return {std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right), std::min(a.bottom, b.bottom)};
}

PlotBox around(std::span<const PlotPoint> points, double margin) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  PlotBox box{infinity, infinity, -infinity, -infinity};
  for (const auto& [x, y] : points) {
    box = {std::min(box.left, x - margin), std::min(box.top, y - margin), std::max(box.right, x + margin),
           std::max(box.bottom, y + margin)};
  }
  return box;
}

/// The pieces of a line between the gaps of a dash pattern.
std::vector<std::vector<PlotPoint>> dashed(std::span<const PlotPoint> points, const std::vector<double>& dash) {
  std::vector<std::vector<PlotPoint>> pieces{{points.front()}};
  std::size_t part = 0;
  double left = dash[0];
  for (std::size_t i = 1; i < points.size(); ++i) {
    PlotPoint from = points[i - 1];
    double length = std::hypot(points[i].x - from.x, points[i].y - from.y);
    while (length > left) {
      const double t = left / length;
      from = {from.x + t * (points[i].x - from.x), from.y + t * (points[i].y - from.y)};
      length -= left;
      if (part % 2 == 0) {
        pieces.back().push_back(from);
      } else {
        pieces.push_back({from});
      }
      part = (part + 1) % dash.size();
      left = dash[part];
    }
    left -= length;
    if (part % 2 == 0) pieces.back().push_back(points[i]);
  }
  return pieces;
}

}  // namespace

PlotCanvas::PlotCanvas(int width, int height)
    : width_(width),
      height_(height),
      rgb_(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height), std::uint8_t{255}) {}

PlotColour PlotCanvas::colour_at(int x, int y) const {
  const std::uint8_t* pixel = &rgb_[3 * (static_cast<std::size_t>(y) * width_ + x)];
  return {pixel[0], pixel[1], pixel[2]};
}

void PlotCanvas::blend(int x, int y, PlotColour colour, double opacity) {
  std::uint8_t* pixel = &rgb_[3 * (static_cast<std::size_t>(y) * width_ + x)];
  for (int c = 0; c < 3; ++c) {
    pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + opacity * (colour[c] - pixel[c])));
  }
}

void PlotCanvas::fill(const PlotBox& box, PlotColour colour, double opacity) {
  const PlotBox inside = common(box, everything());
  const PlotBox touched = pixels(inside);
  for (int y = static_cast<int>(touched.top); y < touched.bottom; ++y) {
    for (int x = static_cast<int>(touched.left); x < touched.right; ++x) {
      const double area = std::max(0.0, std::min(inside.right, x + 1.0) - std::max(inside.left, x + 0.0)) *
                          std::max(0.0, std::min(inside.bottom, y + 1.0) - std::max(inside.top, y + 0.0));
      blend(x, y, colour, opacity * area);
    }
  }
}

void PlotCanvas::cover(PlotPoint a, PlotPoint b, double width, const PlotBox& clip, const PlotBox& bounds,
                       std::vector<float>& coverage) const {
  const std::array<PlotPoint, 2> ends{a, b};
  const PlotBox touched = pixels(common(around(ends, width / 2 + 1), clip));
  const auto columns = static_cast<std::size_t>(bounds.width());
  for (int y = static_cast<int>(touched.top); y < touched.bottom; ++y) {
    for (int x = static_cast<int>(touched.left); x < touched.right; ++x) {
      const double distance = distance_to_segment({x + 0.5, y + 0.5}, a, b);
      // Lines thinner than a pixel get paler, not thinner.
      const double here = std::clamp(0.5 + std::max(width, 1.0) / 2 - distance, 0.0, 1.0) * std::min(width, 1.0);
      float& there = coverage[static_cast<std::size_t>(y - static_cast<int>(bounds.top)) * columns +
                              static_cast<std::size_t>(x - static_cast<int>(bounds.left))];
      there = std::max(there, static_cast<float>(here));
    }
  }
}

void PlotCanvas::line(std::span<const PlotPoint> points, const Stroke& stroke, const PlotBox& clip) {
  if (points.empty()) return;
  const PlotBox bounds = pixels(common(common(around(points, stroke.width / 2 + 1), clip), everything()));
  if (bounds.width() <= 0 || bounds.height() <= 0) return;
  std::vector<float> coverage(static_cast<std::size_t>(bounds.width()) * static_cast<std::size_t>(bounds.height()), 0);
  const auto cover_all = [&](std::span<const PlotPoint> piece) {
    for (std::size_t i = 0; i + 1 < std::max<std::size_t>(piece.size(), 2); ++i) {
      cover(piece[i], piece[std::min(i + 1, piece.size() - 1)], stroke.width, bounds, bounds, coverage);
    }
  };
  if (stroke.dash.empty()) {
    cover_all(points);
  } else {
    for (const auto& piece : dashed(points, stroke.dash)) cover_all(piece);
  }
  std::size_t i = 0;
  for (int y = static_cast<int>(bounds.top); y < bounds.bottom; ++y) {
    for (int x = static_cast<int>(bounds.left); x < bounds.right; ++x, ++i) {
      if (coverage[i] > 0) blend(x, y, stroke.colour, stroke.opacity * coverage[i]);
    }
  }
}

void PlotCanvas::disc(PlotPoint centre, double radius, PlotColour colour, const PlotBox& clip) {
  line(std::span(&centre, 1), {colour, 2 * radius, {}, 1}, clip);
}

double PlotCanvas::text_width(std::string_view text, double size) { return size * outline(text).width; }

void PlotCanvas::text(std::string_view text, PlotPoint place, double size, TextAnchor anchor, TextTurn turn,
                      PlotColour colour) {
  const TextOutline letters = outline(text);
  const double along = anchor == TextAnchor::left     ? 0
                       : anchor == TextAnchor::centre ? letters.width / 2
                                                      : letters.width;
  const Stroke stroke{colour, std::max(1.0, text_stroke * size), {}, 1};
  for (std::vector<PlotPoint> line : letters.lines) {
    for (PlotPoint& p : line) {
      const double x = size * (p.x - along), y = size * (0.5 - p.y);
      p = turn == TextTurn::none ? PlotPoint{place.x + x, place.y + y} : PlotPoint{place.x + y, place.y - x};
    }
    this->line(line, stroke);
  }
}

void PlotCanvas::write_png(const std::filesystem::path& file) const {
  cloudbow::write_png(file, RgbImage{width_, height_, rgb_});
}

}  // namespace cloudbow
