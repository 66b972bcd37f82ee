// Axes of figures: their range, the numbers at which ticks stand, and what is written beside them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace cloudbow {

struct PlotAxis {
  std::string name;  ///< plain text
  std::string unit;  ///< as in files ("W m-2"); "1" or empty: none
  bool logarithmic = false;
  std::optional<std::pair<double, double>> range{};  ///< default: of the data, widened to ticks
  std::optional<double> tick_spacing{};              ///< linear axes; default: 1, 2 or 5 times 10^n
  int wanted_ticks = 7;                              ///< intervals of linear axes without tick_spacing: at most as many
};

/// The range of an axis that shows these values. Values that are not finite, or not positive on a logarithmic axis, do
/// not count.
std::pair<double, double> axis_range(const PlotAxis& axis, const std::vector<double>& values);

/// Whether an axis can show a value.
bool can_show(const PlotAxis& axis, double value);

/// Location of a value, 0 at the first end of the range and 1 at the other.
double axis_fraction(const PlotAxis& axis, std::pair<double, double> range, double value);

/// Values of the ticks, from least to largest, inside the range. Logarithmic: powers of ten, or with `minor` their
/// multiples 2 to 9.
std::vector<double> axis_ticks(const PlotAxis& axis, std::pair<double, double> range, bool minor = false);

struct AxisText {
  std::vector<double> tick;        ///< those that have a label
  std::vector<std::string> label;  ///< markup
  std::string title;               ///< markup: name, power of ten that the labels leave out, unit
};

/// Labels that are short and differ: with the decimals of the spacing; without a common power of ten if numbers are
/// from 100 000 on or below 0.001; without a common part, which the title subtracts, if more than seven digits would
/// agree.
AxisText axis_text(const PlotAxis& axis, std::pair<double, double> range);

}  // namespace cloudbow
