#include "transport/driver/carried_light.hpp"

#include <array>
#include <cstdint>
#include <utility>

#include "transport/grid/cells.hpp"

namespace cloudbow {
namespace {

// Cells of a plan's problem, and the cells of the collapsed one that they are parts of.
struct Parts {
  std::vector<std::uint32_t> whole;        // [n]
  std::vector<float> volume;               // [n] in all its places, as a fraction of one of the whole's
  std::array<std::vector<float>, 3> size;  // [n] along x, y, z, as a fraction of the whole's
};

Parts parts_of(const SolvePlan& plan) {
  const OpticalGrid &grid = plan.problem().grid, &whole = plan.collapsed().grid;
  const std::size_t columns = whole.box.columns();
  const SubdividedColumns across = plan.column_parts();
  const bool has_parts = plan.added_levels() > 0;
  std::vector<std::uint32_t> cell_at(columns);  // of a level of the whole
  Parts parts;
  const std::size_t n = grid.active_cells();
  parts.whole.resize(n);
  parts.volume.resize(n);
  for (auto& axis : parts.size) axis.resize(n);
  int level_at = -1;
  for (int k = 0; k < grid.box.nz(); ++k) {
    const int level = has_parts ? plan.levels().level[static_cast<std::size_t>(k)] : k;
    if (level != level_at) {
      whole.for_each_place_of(
          level, [&](std::size_t column, std::size_t cell) { cell_at[column] = static_cast<std::uint32_t>(cell); });
      level_at = level;
    }
    const auto height = static_cast<float>(grid.box.thickness_m(k) / whole.box.thickness_m(level));
    const float width_x = 1.F / static_cast<float>(across.x), width_y = 1.F / static_cast<float>(across.y);
    grid.for_each_place_of(k, [&](std::size_t column, std::size_t cell) {
      const std::size_t i = column % static_cast<std::size_t>(grid.box.nx) / static_cast<std::size_t>(across.x);
      const std::size_t j = column / static_cast<std::size_t>(grid.box.nx) / static_cast<std::size_t>(across.y);
      parts.whole[cell] = cell_at[j * static_cast<std::size_t>(whole.box.nx) + i];
      parts.volume[cell] += height * width_x * width_y;
      parts.size[0][cell] = width_x;
      parts.size[1][cell] = width_y;
      parts.size[2][cell] = height;
    });
  }
  return parts;
}

// Values of parts, in the parts of another plan.
class Carrier {
 public:
  Carrier(const SolvePlan& from, const SolvePlan& to)
      : from_(parts_of(from)), to_(parts_of(to)), volume_(from.collapsed().grid.active_cells()) {
    for (std::size_t c = 0; c < from_.whole.size(); ++c) volume_[from_.whole[c]] += from_.volume[c];
  }

  std::size_t cells() const { return from_.whole.size(); }
  std::size_t new_cells() const { return to_.whole.size(); }

  void carry(const float* from, float* to) {
    mean_.assign(volume_.size(), 0.F);
    for (std::size_t c = 0; c < cells(); ++c) mean_[from_.whole[c]] += from_.volume[c] * from[c];
    for (std::size_t v = 0; v < mean_.size(); ++v) mean_[v] = volume_[v] > 0 ? mean_[v] / volume_[v] : 0.F;
    for (std::size_t c = 0; c < new_cells(); ++c) to[c] = mean_[to_.whole[c]];
  }
  // Differences from face to face along an axis.
  void carry_slope(std::size_t axis, float* from, float* to) {
    for (std::size_t c = 0; c < cells(); ++c) from[c] /= from_.size[axis][c];
    carry(from, to);
    for (std::size_t c = 0; c < new_cells(); ++c) to[c] *= to_.size[axis][c];
  }

 private:
  Parts from_, to_;
  std::vector<float> volume_;  // [cells of the whole]
  std::vector<float> mean_;
};

}  // namespace

bool can_carry(const CellLight& light, const SolvePlan& plan) {
  return light.plan && &light.plan->collapsed() == &plan.collapsed();
}

CellLight carried_light(CellLight&& light, const SolvePlan& plan) {
  const SolvePlan from = *std::exchange(light.plan, std::nullopt);
  Carrier carrier(from, plan);
  const std::size_t moments = light.moments.size() / carrier.cells();
  CellLight there{plan, std::vector<float>(moments * carrier.new_cells()), {}};
  for (std::size_t m = 0; m < moments; ++m)
    carrier.carry(light.moments.data() + m * carrier.cells(), there.moments.data() + m * carrier.new_cells());
  light.moments = {};
  for (std::size_t n = 0; n < light.slopes.size(); ++n) {
    if (light.slopes[n].empty()) {  // another rank has them
      there.slopes.emplace_back();
      continue;
    }
    std::vector<float> slopes(carrier.new_cells() + lane_padding);
    carrier.carry_slope(n % 3, light.slopes[n].data(), slopes.data());
    light.slopes[n] = {};
    there.slopes.push_back(std::move(slopes));
  }
  light.slopes.clear();
  return there;
}

}  // namespace cloudbow
