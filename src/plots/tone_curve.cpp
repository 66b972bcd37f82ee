#include "plots/tone_curve.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "cloudbow/core/error.hpp"
#include "cloudbow/plots/render.hpp"

namespace cloudbow {

std::vector<std::string> tone_names() { return {"filmic", "linear"}; }

double display_level(const std::string& tone, double x) {
  if (tone == "linear") return std::clamp(x, 0., 1.);
  if (tone == "filmic") return 1 - std::pow(5., -std::max(x, 0.));
  throw InputError(fmt::format("tone: \"{}\" is not one of {}", tone, fmt::join(tone_names(), ", ")));
}

double automatic_exposure(std::vector<float> luminance) {
  std::erase_if(luminance, [](float value) { return !std::isfinite(value); });
  if (luminance.empty()) return 1;
  const auto place = static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(luminance.size() - 1));
  std::nth_element(luminance.begin(), luminance.begin() + place, luminance.end());
  const double bright = luminance[static_cast<std::size_t>(place)];
  return bright > 0 ? 1 / bright : 1;
}

}  // namespace cloudbow
