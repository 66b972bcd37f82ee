#include "cloudbow/medium/plausibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

namespace cloudbow {
namespace {

constexpr double doubtful_water_content_g_m3 = 20;  // several times what any cloud holds
constexpr double doubtful_optical_depth = 1e4;      // a cloud of a kilometre has 100

/// Without what the spellings of a unit differ in: "m^-1", "m**-1" and "m-1" are one.
std::string bare(const std::string& units) {
  std::string result = units;
  std::erase_if(result, [](char c) { return std::string_view(" ^*.{}").find(c) != std::string_view::npos; });
  return result;
}

std::string words_of(std::string quantity) {
  std::replace(quantity.begin(), quantity.end(), '_', ' ');
  return quantity;
}

}  // namespace

std::optional<std::string> doubt_water_content(double largest_g_m3, const std::string& quantity) {
  if (!(largest_g_m3 > doubtful_water_content_g_m3)) return std::nullopt;
  return fmt::format(
      "{} of {:.4g} g/m3 (clouds have up to about 5, above {} is doubted); is the grid in g/m3? "
      "cloud.scale makes it so",
      words_of(quantity), largest_g_m3, doubtful_water_content_g_m3);
}

std::optional<std::string> doubt_optical_depth(double largest_of_a_voxel) {
  if (!(largest_of_a_voxel > doubtful_optical_depth)) return std::nullopt;
  return fmt::format(
      "a voxel of optical depth {:.4g} (above {:g} is doubted); are extinction in 1/m and voxel sizes in m? "
      "cloud.scale "
      "and cloud.voxel_size_m make them so",
      largest_of_a_voxel, doubtful_optical_depth);
}

std::optional<std::string> doubt_effective_radius(double smallest_um, double largest_um) {
  if (smallest_um >= smallest_effective_radius_um && largest_um <= largest_effective_radius_um) return std::nullopt;
  return fmt::format(
      "effective radii that nothing in a cloud has (found {:.4g} to {:.4g}, allowed {} to {} um); write "
      "the radius in um",
      smallest_um, largest_um, smallest_effective_radius_um, largest_effective_radius_um);
}

std::optional<double> scale_of_units(const std::string& quantity, const std::string& units) {
  static const std::map<std::string, double> per_metre{{"1/m", 1},    {"/m", 1},      {"m-1", 1},    {"1/km", 1e-3},
                                                       {"/km", 1e-3}, {"km-1", 1e-3}, {"1/cm", 100}, {"cm-1", 100}};
  static const std::map<std::string, double> gram_per_cubic_metre{{"g/m3", 1},    {"gm-3", 1},     {"kg/m3", 1e3},
                                                                  {"kgm-3", 1e3}, {"mg/m3", 1e-3}, {"mgm-3", 1e-3}};
  const auto& known = quantity == "extinction" ? per_metre : gram_per_cubic_metre;
  if (quantity != "extinction" && !quantity.ends_with("_water_content")) return std::nullopt;
  const auto found = known.find(bare(units));
  return found == known.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace cloudbow
