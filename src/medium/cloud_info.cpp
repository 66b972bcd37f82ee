// The content of a cloud file, in numbers and as text.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/medium/plausibility.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

namespace {

class SpreadOf {
 public:
  void add(double number) {
    min_ = std::min(min_, number);
    max_ = std::max(max_, number);
    sum_ += number;
    ++count_;
  }
  Spread result() const { return count_ == 0 ? Spread{} : Spread{min_, sum_ / static_cast<double>(count_), max_}; }
  std::size_t count() const { return count_; }

 private:
  double min_ = std::numeric_limits<double>::infinity();
  double max_ = -std::numeric_limits<double>::infinity();
  double sum_ = 0;
  std::size_t count_ = 0;
};

std::string format_spread(const Spread& spread) {
  return fmt::format("min {:.6g}, mean {:.6g}, max {:.6g}", spread.min, spread.mean, spread.max);
}

std::string format_box(const std::array<double, 3>& min, const std::array<double, 3>& max) {
  return fmt::format("({:.10g}, {:.10g}, {:.10g}) to ({:.10g}, {:.10g}, {:.10g}) m", min[0], min[1], min[2], max[0],
                     max[1], max[2]);
}

/// Whether sums over a column mean anything.
bool is_content(const std::string& quantity) {
  return quantity != "effective_radius" && quantity != "single_scattering_albedo" && quantity != "phase_index" &&
         quantity != "temperature";
}

}  // namespace

std::string column_integral_name(const std::string& quantity, const std::string& units) {
  if (scale_of_units(quantity, units).value_or(1) != 1) return "vertical integral";
  if (quantity == "extinction") return "optical depth";
  constexpr std::string_view content = "_water_content";
  if (quantity.ends_with(content)) return quantity.substr(0, quantity.size() - content.size()) + " water path [g/m2]";
  return "vertical integral";
}

std::vector<double> column_integrals(const CloudField& field) {
  const auto nx = static_cast<std::size_t>(field.cells[0]), ny = static_cast<std::size_t>(field.cells[1]);
  std::vector<double> column(nx * ny, 0.0);
  for (std::size_t row = 0; row + 1 < field.row_begin.size(); ++row) {
    for (auto s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
      const RowSpan& span = field.spans[s];
      double* const first = column.data() + row % ny * nx + static_cast<std::size_t>(span.i);
      for (int n = 0; n < span.n; ++n) first[n] += field.value[span.offset + n] * field.cell_size_m[2];
    }
  }
  return column;
}

CloudSummary summarize(const CloudField& field) {
  CloudSummary summary{.cells = field.cells,
                       .cell_size_m = field.cell_size_m,
                       .domain_min_m = field.min_m,
                       .active_voxels = field.active_voxels()};
  const auto [nx, ny, nz] = field.cells;
  std::array<int, 3> low = field.cells;
  std::array<int, 3> high = {0, 0, 0};
  SpreadOf value;
  const std::vector<double> column = column_integrals(field);
  std::size_t row = 0;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j, ++row) {
      for (auto s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
        const auto& span = field.spans[s];
        const std::array<int, 3> first = {span.i, j, k};
        const std::array<int, 3> end = {span.i + span.n, j + 1, k + 1};
        for (int a = 0; a < 3; ++a) {
          low[a] = std::min(low[a], first[a]);
          high[a] = std::max(high[a], end[a]);
        }
        for (int i = 0; i < span.n; ++i) value.add(field.value[span.offset + static_cast<std::size_t>(i)]);
      }
    }
  }

  for (int a = 0; a < 3; ++a) {
    summary.domain_max_m[a] = field.max_m(a);
    summary.cloud_min_m[a] = field.min_m[a] + low[a] * field.cell_size_m[a];
    summary.cloud_max_m[a] = field.min_m[a] + high[a] * field.cell_size_m[a];
  }
  SpreadOf cloudy;
  for (const double integral : column) {
    if (integral > 0) cloudy.add(integral);
  }
  summary.value = value.result();
  summary.column = cloudy.result();
  summary.cover = static_cast<double>(cloudy.count()) / static_cast<double>(column.size());
  summary.fill = static_cast<double>(field.active_voxels()) / (static_cast<double>(column.size()) * nz);
  return summary;
}

std::string format_cloud_info(const CloudInfo& info) {
  std::string text = fmt::format("{}: {} bytes, {} grid{}\n", info.path.string(), info.bytes, info.grids.size(),
                                 info.grids.size() == 1 ? "" : "s");
  for (const auto& grid : info.grids) {
    const auto line = [&](const char* label, const std::string& content) {
      text += fmt::format("  {:<16}{}\n", label, content);
    };
    text += fmt::format("grid \"{}\"\n", printable(grid.name));
    line("type", printable(grid.type));
    if (!grid.quantity.empty())
      line("quantity", printable(fmt::format("{} [{}]", grid.quantity, grid.units.empty() ? "?" : grid.units)));
    if (!grid.cloud) {
      line("not a cloud", printable(grid.reason));
      continue;
    }
    const auto& cloud = *grid.cloud;
    line("cells", fmt::format("{} x {} x {} of {:.10g} x {:.10g} x {:.10g} m", cloud.cells[0], cloud.cells[1],
                              cloud.cells[2], cloud.cell_size_m[0], cloud.cell_size_m[1], cloud.cell_size_m[2]));
    line("domain", format_box(cloud.domain_min_m, cloud.domain_max_m));
    line("cloud", format_box(cloud.cloud_min_m, cloud.cloud_max_m));
    line("active voxels", fmt::format("{} (fill {:.4g} %)", cloud.active_voxels, 100 * cloud.fill));
    line("value", format_spread(cloud.value));
    line("cover", fmt::format("{:.4g} % of {} columns", 100 * cloud.cover,
                              static_cast<std::int64_t>(cloud.cells[0]) * cloud.cells[1]));
    for (const std::string& note : cloud.notes) line("note", printable(note));
    if (!is_content(grid.quantity)) continue;
    const std::string name = column_integral_name(grid.quantity, grid.units);
    line("cloudy columns", fmt::format("{}: {}", name, format_spread(cloud.column)));
    line("all columns", fmt::format("{}: mean {:.6g}", name, cloud.column.mean * cloud.cover));
    if (const auto& depth = grid.optical_depth) {
      line("cloudy columns", fmt::format("optical depth, by the effective radius: {}", format_spread(*depth)));
      line("all columns",
           fmt::format("optical depth, by the effective radius: mean {:.6g}", depth->mean * cloud.cover));
    }
  }
  return text;
}

std::vector<std::string> doubts_about(const CloudInfo& info) {
  std::vector<std::string> doubts;
  for (const auto& grid : info.grids) {
    const auto add = [&](const std::optional<std::string>& sentence) {
      if (sentence) doubts.push_back(fmt::format("{}: grid \"{}\": {}", info.path.string(), grid.name, *sentence));
    };
    if (!grid.cloud) continue;
    if (const auto scale = scale_of_units(grid.quantity, grid.units); scale && *scale != 1) {
      add(fmt::format("the numbers are in {}; a scene needs cloud.scale = {:g}", grid.units, *scale));
      continue;
    }
    if (grid.quantity == "liquid_water_content") add(doubt_water_content(grid.cloud->value.max));
    add(doubt_optical_depth(grid.largest_voxel_depth));
  }
  return doubts;
}

void check_effective_radii(const CloudInfo& info) {
  for (const auto& grid : info.grids) {
    if (!grid.cloud || grid.quantity != "effective_radius") continue;
    if (const auto doubt = doubt_effective_radius(grid.cloud->value.min, grid.cloud->value.max))
      throw InputError(fmt::format("{}: grid \"{}\": {}", info.path.string(), grid.name, *doubt));
  }
}

}  // namespace cloudbow
