#include "cloudbow/medium/cloud_amounts.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {
namespace {

constexpr double ice_density_g_cm3 = 0.917;

struct WaterContent {
  const char* quantity;
  double density_g_cm3;
};

constexpr std::array<WaterContent, 5> known_contents{{{"liquid_water_content", 1},
                                                      {"rain_water_content", 1},
                                                      {"ice_water_content", ice_density_g_cm3},
                                                      {"snow_water_content", ice_density_g_cm3},
                                                      {"graupel_water_content", ice_density_g_cm3}}};

}  // namespace

std::vector<std::string> water_contents() {
  std::vector<std::string> names;
  for (const WaterContent& content : known_contents) names.emplace_back(content.quantity);
  return names;
}

std::optional<double> density_of_water(const std::string& quantity) {
  for (const WaterContent& content : known_contents) {
    if (quantity == content.quantity) return content.density_g_cm3;
  }
  return std::nullopt;
}

void water_to_extinction(CloudField& field, std::span<const double> extinction_m2_per_g) {
  assert(extinction_m2_per_g.size() == field.value.size());
  for (std::size_t n = 0; n < field.value.size(); ++n)
    field.value[n] = static_cast<float>(field.value[n] * extinction_m2_per_g[n]);
}

void water_to_extinction_by_radius(CloudField& field, std::span<const float> effective_radius_um) {
  assert(effective_radius_um.size() == field.value.size());
  for (std::size_t n = 0; n < field.value.size(); ++n)
    field.value[n] = static_cast<float>(field.value[n] * extinction_per_liquid_water(effective_radius_um[n]));
}

ColumnFigures column_figures(const CloudField& field, double factor) {
  ColumnFigures figures;
  for (const double column : column_integrals(field)) {
    figures.sum += column * factor;
    figures.largest = std::max(figures.largest, column * factor);
  }
  return figures;
}

double largest_value(const CloudField& field) {
  return static_cast<double>(*std::max_element(field.value.begin(), field.value.end()));
}

}  // namespace cloudbow
