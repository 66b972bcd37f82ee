#include "plots/plot_font.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

namespace cloudbow {
namespace {

constexpr double capital = 7;  // height of a capital in units of the table
constexpr double space = 2.6;
constexpr double between_letters = 1.7;
constexpr double script_size = 0.7;

struct Letter {
  char32_t code;
  /// M x y: begin a line; L x y: straight on; Q cx cy x y: a quarter of an ellipse inside the corner c.
  const char* path;
};

constexpr Letter letters[] = {
    {U'0', "M 0 3.5 Q 0 7 2.2 7 Q 4.4 7 4.4 3.5 Q 4.4 0 2.2 0 Q 0 0 0 3.5"},
    {U'1', "M .8 5.6 L 2.5 7 L 2.5 0 M .8 0 L 4.2 0"},
    {U'2', "M .2 5.2 Q .2 7 2.2 7 Q 4.2 7 4.2 5.2 Q 4.2 4 3 2.9 L 0 0 L 4.4 0"},
    {U'3',
     "M .2 5.6 Q .4 7 2.1 7 Q 4.1 7 4.1 5.3 Q 4.1 3.7 2.1 3.7 L 1.5 3.7 M 2.1 3.7 Q 4.4 3.7 4.4 1.85 Q 4.4 0 2.1 0 "
     "Q .2 0 0 1.5"},
    {U'4', "M 3.4 0 L 3.4 7 L 0 2 L 4.6 2"},
    {U'5', "M 4 7 L .7 7 L .4 3.9 Q 1.1 4.5 2.1 4.5 Q 4.4 4.5 4.4 2.25 Q 4.4 0 2.1 0 Q .3 0 0 1.4"},
    {U'6', "M 3.9 6.2 Q 3.5 7 2.4 7 Q 0 7 0 3 L 0 2.2 Q 0 4.4 2.2 4.4 Q 4.4 4.4 4.4 2.2 Q 4.4 0 2.2 0 Q 0 0 0 2.2"},
    {U'7', "M 0 7 L 4.4 7 L 1.6 0"},
    {U'8',
     "M .3 5.35 Q .3 7 2.2 7 Q 4.1 7 4.1 5.35 Q 4.1 3.7 2.2 3.7 Q .3 3.7 .3 5.35 M 0 1.85 Q 0 3.7 2.2 3.7 Q 4.4 3.7 "
     "4.4 1.85 Q 4.4 0 2.2 0 Q 0 0 0 1.85"},
    {U'9', "M .5 .8 Q .9 0 2 0 Q 4.4 0 4.4 4 L 4.4 4.8 Q 4.4 2.6 2.2 2.6 Q 0 2.6 0 4.8 Q 0 7 2.2 7 Q 4.4 7 4.4 4.8"},
    {U'A', "M 0 0 L 2.6 7 L 5.2 0 M .85 2.3 L 4.35 2.3"},
    {U'B',
     "M 0 0 L 0 7 L 2.4 7 Q 4.2 7 4.2 5.35 Q 4.2 3.7 2.4 3.7 L 0 3.7 M 2.4 3.7 Q 4.6 3.7 4.6 1.85 Q 4.6 0 2.4 0 L 0 0"},
    {U'C', "M 5 5.4 Q 4.4 7 2.8 7 Q 0 7 0 3.5 Q 0 0 2.8 0 Q 4.4 0 5 1.6"},
    {U'D', "M 0 0 L 0 7 L 2 7 Q 5 7 5 3.5 Q 5 0 2 0 L 0 0"},
    {U'E', "M 4.2 7 L 0 7 L 0 0 L 4.2 0 M 0 3.7 L 3.7 3.7"},
    {U'F', "M 4.2 7 L 0 7 L 0 0 M 0 3.6 L 3.6 3.6"},
    {U'G', "M 5 5.4 Q 4.4 7 2.8 7 Q 0 7 0 3.5 Q 0 0 2.8 0 Q 5.2 0 5.2 2.6 L 5.2 3.1 L 3 3.1"},
    {U'H', "M 0 0 L 0 7 M 5 0 L 5 7 M 0 3.7 L 5 3.7"},
    {U'I', "M .3 0 L .3 7"},
    {U'J', "M 3.2 7 L 3.2 2 Q 3.2 0 1.6 0 Q 0 0 0 1.9"},
    {U'K', "M 0 0 L 0 7 M 4.6 7 L 0 2.5 M 1.6 4 L 4.8 0"},
    {U'L', "M 0 7 L 0 0 L 4 0"},
    {U'M', "M 0 0 L 0 7 L 2.9 1.2 L 5.8 7 L 5.8 0"},
    {U'N', "M 0 0 L 0 7 L 5 0 L 5 7"},
    {U'O', "M 0 3.5 Q 0 7 2.8 7 Q 5.6 7 5.6 3.5 Q 5.6 0 2.8 0 Q 0 0 0 3.5"},
    {U'P', "M 0 0 L 0 7 L 2.4 7 Q 4.5 7 4.5 5.1 Q 4.5 3.2 2.4 3.2 L 0 3.2"},
    {U'Q', "M 0 3.5 Q 0 7 2.8 7 Q 5.6 7 5.6 3.5 Q 5.6 0 2.8 0 Q 0 0 0 3.5 M 3.4 1.7 L 5.5 -.5"},
    {U'R', "M 0 0 L 0 7 L 2.4 7 Q 4.5 7 4.5 5.1 Q 4.5 3.2 2.4 3.2 L 0 3.2 M 2.3 3.2 L 4.6 0"},
    {U'S', "M 4.3 5.6 Q 4 7 2.3 7 Q .2 7 .2 5.3 Q .2 4 2.3 3.6 Q 4.6 3.2 4.6 1.8 Q 4.6 0 2.4 0 Q .3 0 0 1.6"},
    {U'T', "M 0 7 L 4.8 7 M 2.4 7 L 2.4 0"},
    {U'U', "M 0 7 L 0 2.4 Q 0 0 2.4 0 Q 4.8 0 4.8 2.4 L 4.8 7"},
    {U'V', "M 0 7 L 2.5 0 L 5 7"},
    {U'W', "M 0 7 L 1.8 0 L 3.6 6.6 L 5.4 0 L 7.2 7"},
    {U'X', "M 0 7 L 4.8 0 M 4.8 7 L 0 0"},
    {U'Y', "M 0 7 L 2.4 3.4 L 4.8 7 M 2.4 3.4 L 2.4 0"},
    {U'Z', "M 0 7 L 4.6 7 L 0 0 L 4.6 0"},
    {U'a', "M .3 4.1 Q .7 5 2 5 Q 3.7 5 3.7 3.4 L 3.7 0 M 3.7 2.9 L 2 2.7 Q 0 2.5 0 1.3 Q 0 0 1.5 0 Q 3.7 0 3.7 2"},
    {U'b', "M 0 7 L 0 0 M 0 2.5 Q 0 5 2 5 Q 4 5 4 2.5 Q 4 0 2 0 Q 0 0 0 2.5"},
    {U'c', "M 3.7 3.9 Q 3.3 5 2.1 5 Q 0 5 0 2.5 Q 0 0 2.1 0 Q 3.3 0 3.7 1.1"},
    {U'd', "M 4 7 L 4 0 M 4 2.5 Q 4 5 2 5 Q 0 5 0 2.5 Q 0 0 2 0 Q 4 0 4 2.5"},
    {U'e', "M 0 2.6 L 4 2.6 Q 4 5 2.05 5 Q 0 5 0 2.5 Q 0 0 2.1 0 Q 3.4 0 3.8 1.1"},
    {U'f', "M 2.6 6.9 Q 1.1 7.2 1.1 5.5 L 1.1 0 M 0 4.7 L 2.4 4.7"},
    {U'g', "M 4 5 L 4 -.2 Q 4 -2 2 -2 Q .6 -2 .2 -1 M 4 2.5 Q 4 5 2 5 Q 0 5 0 2.5 Q 0 0 2 0 Q 4 0 4 2.5"},
    {U'h', "M 0 7 L 0 0 M 0 3 Q 0 5 2 5 Q 3.7 5 3.7 3.2 L 3.7 0"},
    {U'i', "M .2 5 L .2 0 M .2 6.8 L .2 6.9"},
    {U'j', "M .9 5 L .9 -.7 Q .9 -2 -.3 -1.9 M .9 6.8 L .9 6.9"},
    {U'k', "M 0 7 L 0 0 M 3.4 5 L 0 1.8 M 1.2 2.9 L 3.6 0"},
    {U'l', "M .2 7 L .2 0"},
    {U'm', "M 0 5 L 0 0 M 0 3.2 Q 0 5 1.6 5 Q 3.1 5 3.1 3.3 L 3.1 0 M 3.1 3.2 Q 3.1 5 4.7 5 Q 6.2 5 6.2 3.3 L 6.2 0"},
    {U'n', "M 0 5 L 0 0 M 0 3 Q 0 5 2 5 Q 3.7 5 3.7 3.2 L 3.7 0"},
    {U'o', "M 0 2.5 Q 0 5 2.1 5 Q 4.2 5 4.2 2.5 Q 4.2 0 2.1 0 Q 0 0 0 2.5"},
    {U'p', "M 0 5 L 0 -2 M 0 2.5 Q 0 5 2 5 Q 4 5 4 2.5 Q 4 0 2 0 Q 0 0 0 2.5"},
    {U'q', "M 4 5 L 4 -2 M 4 2.5 Q 4 5 2 5 Q 0 5 0 2.5 Q 0 0 2 0 Q 4 0 4 2.5"},
    {U'r', "M 0 5 L 0 0 M 0 2.9 Q 0 5 2.3 4.9"},
    {U's', "M 3.2 4.1 Q 2.9 5 1.7 5 Q .2 5 .2 3.8 Q .2 2.8 1.7 2.55 Q 3.4 2.3 3.4 1.3 Q 3.4 0 1.8 0 Q .3 0 0 1"},
    {U't', "M 1.1 6.4 L 1.1 1.3 Q 1.1 0 2.5 .1 M 0 4.8 L 2.4 4.8"},
    {U'u', "M 0 5 L 0 1.9 Q 0 0 1.8 0 Q 3.7 0 3.7 2 M 3.7 5 L 3.7 0"},
    {U'v', "M 0 5 L 1.9 0 L 3.8 5"},
    {U'w', "M 0 5 L 1.4 0 L 2.8 4.6 L 4.2 0 L 5.6 5"},
    {U'x', "M 0 5 L 3.6 0 M 3.6 5 L 0 0"},
    {U'y', "M 0 5 L 1.9 0 M 3.8 5 L 1.6 -1 Q 1.2 -2 0 -1.9"},
    {U'z', "M 0 5 L 3.4 5 L 0 0 L 3.4 0"},
    {U'.', "M .2 .05 L .2 .15"},
    {U',', "M .5 .2 L .1 -1.2"},
    {U':', "M .2 .05 L .2 .15 M .2 3.9 L .2 4"},
    {U';', "M .5 .2 L .1 -1.2 M .5 3.9 L .5 4"},
    {U'!', "M .2 7 L .2 2.2 M .2 .05 L .2 .15"},
    {U'?', "M 0 5.4 Q 0 7 1.9 7 Q 3.8 7 3.8 5.3 Q 3.8 4.3 2.7 3.6 Q 1.8 3 1.8 2 M 1.8 .05 L 1.8 .15"},
    {U'-', "M 0 2.7 L 2.4 2.7"},
    {U'+', "M 0 3 L 4 3 M 2 1 L 2 5"},
    {U'=', "M 0 4 L 4 4 M 0 2 L 4 2"},
    {U'(', "M 1.5 8 Q 0 6 0 3 Q 0 0 1.5 -2"},
    {U')', "M 0 8 Q 1.5 6 1.5 3 Q 1.5 0 0 -2"},
    {U'[', "M 1.4 8 L 0 8 L 0 -1.6 L 1.4 -1.6"},
    {U']', "M 0 8 L 1.4 8 L 1.4 -1.6 L 0 -1.6"},
    {U'|', "M .2 8 L .2 -1.6"},
    {U'/', "M 0 -1 L 3 7.6"},
    {U'\\', "M 0 7.6 L 3 -1"},
    {U'%',
     "M 0 5.4 Q 0 7 1.3 7 Q 2.6 7 2.6 5.4 Q 2.6 3.8 1.3 3.8 Q 0 3.8 0 5.4 M 3.6 1.6 Q 3.6 3.2 4.9 3.2 Q 6.2 3.2 6.2 "
     "1.6 "
     "Q 6.2 0 4.9 0 Q 3.6 0 3.6 1.6 M 5.3 7 L .9 0"},
    {U'<', "M 4 5.4 L 0 3 L 4 .6"},
    {U'>', "M 0 5.4 L 4 3 L 0 .6"},
    {U'*', "M 1.5 7 L 1.5 4 M .2 6.2 L 2.8 4.8 M 2.8 6.2 L .2 4.8"},
    {U'_', "M 0 -1.2 L 4 -1.2"},
    {U'\'', "M .2 7 L .2 5.2"},
    {U'"', "M .2 7 L .2 5.2 M 1.6 7 L 1.6 5.2"},
    {U'#', "M 1.2 0 L 2 7 M 3 0 L 3.8 7 M .3 4.7 L 4.8 4.7 M 0 2.3 L 4.5 2.3"},
    {U'&',
     "M 5 0 L 1.2 4.6 Q .8 5.1 .8 5.6 Q .8 7 2.2 7 Q 3.6 7 3.6 5.6 Q 3.6 4.6 2 3.8 Q 0 3 0 1.7 Q 0 0 2.1 0 Q 4.4 0 4.7 "
     "2.8"},
    {U'~', "M 0 2.6 Q 0 3.4 1 3.4 Q 1.6 3.4 2.1 2.9 Q 2.6 2.4 3.2 2.4 Q 4.2 2.4 4.2 3.2"},
    {U'^', "M 0 5 L 1.5 7 L 3 5"},
    {U'\u00b0', "M 0 5.8 Q 0 7 1.2 7 Q 2.4 7 2.4 5.8 Q 2.4 4.6 1.2 4.6 Q 0 4.6 0 5.8"},
    {U'\u00b5', "M 0 5 L 0 -2 M 0 1.9 Q 0 0 1.8 0 Q 3.7 0 3.7 2 M 3.7 5 L 3.7 0"},
    {U'\u03bc', "M 0 5 L 0 -2 M 0 1.9 Q 0 0 1.8 0 Q 3.7 0 3.7 2 M 3.7 5 L 3.7 0"},
    {U'\u00d7', "M .2 4.8 L 3.8 1.2 M 3.8 4.8 L .2 1.2"},
    {U'\u03b8', "M 0 3.5 Q 0 7 2 7 Q 4 7 4 3.5 Q 4 0 2 0 Q 0 0 0 3.5 M 0 3.6 L 4 3.6"},
    {U'\u03c4', "M 0 4.6 Q 0 5 .6 5 L 3.8 5 M 1.9 5 L 1.9 1.3 Q 1.9 0 3.1 .1"},
    {U'\u03bb', "M 0 7 Q .9 7 1.3 5.6 L 3.2 0 M 1.8 4 L 0 0"},
};
constexpr const char* box_glyph = "M 0 0 L 4 0 L 4 7 L 0 7 L 0 0";

struct Glyph {
  std::vector<std::vector<PlotPoint>> lines;
  double width = 0;
};

Glyph parsed(const char* path) {
  constexpr int quarter_steps = 8;
  Glyph glyph;
  std::istringstream in(path);
  std::string command;
  while (in >> command) {
    PlotPoint corner{}, to{};
    if (command == "Q") in >> corner.x >> corner.y;
    in >> to.x >> to.y;
    if (command == "M") {
      glyph.lines.push_back({to});
    } else if (command == "L") {
      glyph.lines.back().push_back(to);
    } else {
      const PlotPoint from = glyph.lines.back().back();
      for (int i = 1; i <= quarter_steps; ++i) {
        const double t = std::numbers::pi / 2 * i / quarter_steps;
        const double a = 1 - std::sin(t), b = 1 - std::cos(t);
        glyph.lines.back().push_back({corner.x + a * (from.x - corner.x) + b * (to.x - corner.x),
                                      corner.y + a * (from.y - corner.y) + b * (to.y - corner.y)});
      }
    }
    glyph.width = std::max(glyph.width, to.x);
  }
  return glyph;
}

const Glyph& glyph_of(char32_t code) {
  static const std::map<char32_t, Glyph> glyphs = [] {
    std::map<char32_t, Glyph> all;
    for (const auto& [letter, path] : letters) all.emplace(letter, parsed(path));
    return all;
  }();
  static const Glyph box = parsed(box_glyph);
  const auto found = glyphs.find(code);
  return found == glyphs.end() ? box : found->second;
}

/// Takes one character off the front. Bytes that are not UTF-8 are returned as they are.
char32_t take_character(std::string_view& text) {
  const auto byte = [&text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : byte(0) >= 0xc0 ? 2 : 1;
  char32_t code = byte(0);
  if (length > 1 && text.size() >= length) {
    code = byte(0) & (0xffu >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) code = (code << 6) | (byte(i) & 0x3fu);
    text.remove_prefix(length);
  } else {
    text.remove_prefix(1);
  }
  return code;
}

void append(TextOutline& outline, std::string_view text, double size, double raise) {
  const double unit = size / capital;
  while (!text.empty()) {
    if (text.size() > 2 && (text[0] == '^' || text[0] == '_') && text[1] == '{') {
      const auto end = std::min(text.find('}'), text.size());
      append(outline, text.substr(2, end - 2), script_size * size,
             text[0] == '^' ? raise + 0.5 * size : raise - 0.25 * size);
      text.remove_prefix(std::min(end + 1, text.size()));
      continue;
    }
    const char32_t code = take_character(text);
    if (code == U' ') {
      outline.width += space * unit;
      continue;
    }
    const Glyph& glyph = glyph_of(code);
    for (const auto& line : glyph.lines) {
      std::vector<PlotPoint>& placed = outline.lines.emplace_back();
      for (const PlotPoint& p : line) placed.push_back({outline.width + p.x * unit, raise + p.y * unit});
    }
    outline.width += (glyph.width + between_letters) * unit;
  }
}

}  // namespace

TextOutline outline(std::string_view text) {
  TextOutline result;
  append(result, text, 1, 0);
  result.width = std::max(0.0, result.width - between_letters / capital);
  return result;
}

}  // namespace cloudbow
