#include "plots/axis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "plots/figure_text.hpp"

namespace cloudbow {

namespace {

constexpr std::size_t most_decades_labelled = 8;
constexpr int most_digits = 7;

double nice_spacing(const PlotAxis& axis, double length) {
  const double raw = length / axis.wanted_ticks, power = std::pow(10, std::floor(std::log10(raw)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (raw <= 1.0001 * step * power) return step * power;
  }
  return 10 * power;
}

int decimal_exponent(double value) { return static_cast<int>(std::floor(std::log10(value) + 1e-9)); }

std::string decade_text(double value) {
  const auto exponent = static_cast<int>(std::lround(std::log10(value)));
  return exponent >= -1 && exponent <= 3 ? fmt::format("{:g}", std::pow(10, exponent)) : power_of_ten(exponent);
}

/// Powers of ten, as many as have room; between two of them their multiples.
AxisText logarithmic_text(const PlotAxis& axis, std::pair<double, double> range) {
  AxisText text{{}, {}, labelled_with_unit(axis.name, axis.unit)};
  const std::vector<double> decades = axis_ticks(axis, range);
  if (decades.size() < 2) {
    for (const bool minor : {false, true}) {
      for (const double tick : axis_ticks(axis, range, minor)) text.tick.push_back(tick);
    }
    std::sort(text.tick.begin(), text.tick.end());
    for (const double tick : text.tick) {
      const int exponent = decimal_exponent(tick);
      text.label.push_back(exponent >= -3 && exponent <= 3
                               ? fmt::format("{:g}", tick)
                               : fmt::format("{:.0f}\u00b7{}", tick / std::pow(10, exponent), power_of_ten(exponent)));
    }
    return text;
  }
  const std::size_t step = 1 + (decades.size() - 1) / most_decades_labelled;
  for (std::size_t n = (decades.size() - 1) % step; n < decades.size(); n += step) {
    text.tick.push_back(decades[n]);
    text.label.push_back(decade_text(decades[n]));
  }
  return text;
}

}  // namespace

bool can_show(const PlotAxis& axis, double value) { return std::isfinite(value) && (!axis.logarithmic || value > 0); }

double axis_fraction(const PlotAxis& axis, std::pair<double, double> range, double value) {
  const auto f = [&axis](double v) { return axis.logarithmic ? std::log10(v) : v; };
  return (f(value) - f(range.first)) / (f(range.second) - f(range.first));
}

std::vector<double> axis_ticks(const PlotAxis& axis, std::pair<double, double> range, bool minor) {
  const auto [least, largest] = std::minmax(range.first, range.second);
  std::vector<double> ticks;
  if (axis.logarithmic) {
    constexpr double rounding = 1 + 1e-9;
    for (int n = static_cast<int>(std::floor(std::log10(least))); std::pow(10, n) <= largest * rounding; ++n) {
      for (int digit = minor ? 2 : 1; digit <= (minor ? 9 : 1); ++digit) {
        const double tick = digit * std::pow(10, n);
        if (tick >= least / rounding && tick <= largest * rounding) ticks.push_back(tick);
      }
    }
    return ticks;
  }
  if (minor) return ticks;
  const double spacing = axis.tick_spacing.value_or(nice_spacing(axis, largest - least));
  const double first = std::ceil(least / spacing - 1e-6);
  constexpr int most_ticks = 1000;  // a spacing below that of doubles would never reach the end
  for (int n = 0; n < most_ticks && (first + n) * spacing <= largest + 1e-6 * spacing; ++n)
    ticks.push_back((first + n) * spacing);
  return ticks;
}

std::pair<double, double> axis_range(const PlotAxis& axis, const std::vector<double>& values) {
  if (axis.range) return *axis.range;
  double least = std::numeric_limits<double>::infinity(), largest = -least;
  for (const double v : values) {
    if (!can_show(axis, v)) continue;
    least = std::min(least, v);
    largest = std::max(largest, v);
  }
  if (least > largest) return axis.logarithmic ? std::pair(1.0, 10.0) : std::pair(0.0, 1.0);
  if (axis.logarithmic) {
    const double low = std::pow(10, std::floor(std::log10(least) + 1e-9));
    const double high = std::pow(10, std::ceil(std::log10(largest) - 1e-9));
    return {low, high > low ? high : 10 * low};
  }
  // The spacing of doubles is 1e-16 of their value. A hundred of them are no range that could be drawn.
  if (largest - least <= 1e-14 * std::max(std::abs(least), std::abs(largest))) {
    const double half = least == 0 ? 1 : 0.05 * std::abs(least);
    least -= half;
    largest += half;
  }
  const double spacing = axis.tick_spacing.value_or(nice_spacing(axis, largest - least));
  return {spacing * std::floor(least / spacing + 1e-6), spacing * std::ceil(largest / spacing - 1e-6)};
}

AxisText axis_text(const PlotAxis& axis, std::pair<double, double> range) {
  if (axis.logarithmic) return logarithmic_text(axis, range);
  AxisText text;
  text.tick = axis_ticks(axis, range);
  const double spacing =
      text.tick.size() > 1 ? text.tick[1] - text.tick[0] : nice_spacing(axis, std::abs(range.second - range.first));
  double offset = 0;
  const auto largest = [&] {
    double size = spacing;
    for (const double tick : text.tick) size = std::max(size, std::abs(tick - offset));
    return size;
  };
  const int digits = decimal_exponent(largest()) - decimal_exponent(spacing) + 1;
  if (digits > most_digits) offset = text.tick.front();
  const int exponent = decimal_exponent(largest());
  const int factor = exponent >= 5 || exponent < -3 ? 3 * static_cast<int>(std::floor(exponent / 3.0)) : 0;
  const double unit = std::pow(10, factor);
  const int decimals = std::max(0, factor - decimal_exponent(spacing));
  for (const double tick : text.tick) text.label.push_back(number_text((tick - offset) / unit, decimals));
  std::string name = axis.name;
  if (offset != 0) name += fmt::format(" {} {:.15g}", offset > 0 ? "\u2212" : "+", std::abs(offset));
  text.title = labelled_with_unit(name, axis.unit, factor);
  return text;
}

}  // namespace cloudbow
