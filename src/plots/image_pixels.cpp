#include "plots/image_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace cloudbow {

std::vector<std::size_t> cells_of_pixels(const FluxImage& image, int width, int height) {
  std::vector<std::size_t> cell;
  cell.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const double bottom = image.row_edge_m.front();
  const double top = image.row_edge_m.back();
  for (int py = 0; py < height; ++py) {
    const double at = top - (py + 0.5) / height * (top - bottom);
    const auto above = std::upper_bound(image.row_edge_m.begin() + 1, image.row_edge_m.end() - 1, at);
    const auto row = static_cast<std::size_t>(above - image.row_edge_m.begin() - 1);
    for (int px = 0; px < width; ++px) {
      const auto column = static_cast<std::size_t>(static_cast<std::int64_t>(px) * image.columns / width);
      cell.push_back(row * static_cast<std::size_t>(image.columns) + column);
    }
  }
  return cell;
}

std::vector<float> values_of_pixels(const FluxImage& image, int width, int height) {
  const std::vector<std::size_t> cell = cells_of_pixels(image, width, height);
  const std::vector<double>& level = image.level_m;
  const double bottom = image.row_edge_m.front(), top = image.row_edge_m.back();
  const auto columns = static_cast<std::size_t>(image.columns);
  std::vector<float> value(cell.size());
  for (std::size_t pixel = 0; pixel < cell.size(); ++pixel) {
    value[pixel] = image.value[cell[pixel]];
    if (level.size() < 2) continue;
    const std::size_t line = pixel / static_cast<std::size_t>(width);
    const double row = static_cast<double>(line) + 0.5;
    const double at = top - row / height * (top - bottom);
    const auto above = std::upper_bound(level.begin() + 1, level.end() - 1, at);
    const auto upper = static_cast<std::size_t>(above - level.begin());
    const double share = std::clamp((at - *(above - 1)) / (*above - *(above - 1)), 0.0, 1.0);
    const std::size_t column = cell[pixel] % columns;
    const double low = image.value[(upper - 1) * columns + column], high = image.value[upper * columns + column];
    if (std::isfinite(low) && std::isfinite(high)) value[pixel] = static_cast<float>(low + share * (high - low));
  }
  return value;
}

bool is_map(const FluxImage& image) { return image.rows_along == "y"; }

double aspect_of(const FluxImage& image) {
  constexpr double section_aspect = 4;
  if (image.place == "column") return 1;
  const double aspect = (image.row_edge_m.back() - image.row_edge_m.front()) / (image.columns * image.column_width_m);
  return is_map(image) ? aspect : std::clamp(aspect, 1 / section_aspect, section_aspect);
}

}  // namespace cloudbow
