// Clouds as text: "columns" (i j k value) and "optics-csv" (cells with extinction, albedo and phase function).
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr int most_cells = 1000000;  // along an axis

struct Cell {
  int i, j, k;
  float value;
};

/// The number after `key`, as "dx=0.055 km" or "dx = 55 m": in metres.
std::optional<double> length_after(const std::string& comment, const std::string& key) {
  const auto at = comment.find(key);
  if (at == std::string::npos) return std::nullopt;
  std::string rest = comment.substr(at + key.size());
  std::replace(rest.begin(), rest.end(), '=', ' ');
  const auto words = split_words(rest);
  if (words.size() < 2) return std::nullopt;
  const auto number = number_in(words[0]);
  if (!number) return std::nullopt;
  if (words[1].starts_with("km")) return *number * 1000;
  return words[1].starts_with('m') ? number : std::nullopt;
}

/// Reads cells by named columns; see docs/formats.md, "optics-csv".
class OpticsCsvReader {
 public:
  explicit OpticsCsvReader(const CloudImportOptions& options) : options_(options), lines_(options.file) {}

  LevelledCloud read() {
    read_head();
    read_cells();
    check_cells();
    cloud_.quantity = "extinction";
    set_box();
    fill();
    return std::move(cloud_);
  }

 private:
  struct OpticsCell {
    int i, j, k;
    float extinction, albedo, index;
    double bottom_m, top_m;
  };

  void read_comment(const std::string& line) {
    if (const auto dx = length_after(line, "dx")) dx_m_ = *dx;
    if (const auto dy = length_after(line, "dy")) dy_m_ = *dy;
    if (const auto at = line.find("nx,ny,nz"); at != std::string::npos) {
      const auto equals = line.find('=', at);
      const auto words = equals == std::string::npos ? std::vector<std::string_view>{}
                                                     : split_words(std::string_view(line).substr(equals + 1));
      std::size_t numbers = 0;
      for (std::size_t n = 0; n < shape_.size() && n < words.size(); ++n) {
        const auto number = number_in(words[n]);
        shape_[n] = number.value_or(0);
        if (number) ++numbers;
      }
      const bool is_shape = std::ranges::all_of(
          shape_, [](double count) { return count >= 1 && count <= most_cells && count == std::floor(count); });
      if (numbers > 0 && !is_shape) {  // else the comment is prose
        lines_.fail("no numbers of cells nx,ny,nz (found {}, {}, {}, allowed whole numbers from 1 to {})", shape_[0],
                    shape_[1], shape_[2], most_cells);
      }
    }
    for (const auto& [key, unit] : {std::pair{"z levels km:", 1000.0}, std::pair{"z levels m:", 1.0}}) {
      const auto at = line.find(key);
      if (at == std::string::npos) continue;
      for (const double z : lines_.numbers(line.substr(at + std::string_view(key).size()), 2, "z levels")) {
        level_m_.push_back(z * unit);
      }
    }
  }

  void read_head() {
    std::string line;
    while (lines_.next(line)) {
      if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
      if (is_comment(line)) {
        read_comment(line);
        continue;
      }
      int column = 0;
      for (const std::string_view word : split_words(line)) column_.emplace(word, column++);
      break;
    }
    i_ = find({"i", "ix"});
    j_ = find({"j", "iy"});
    k_ = find({"k", "iz"});
    bottom_ = find({"z_bottom_km", "z_bottom_m"});
    top_ = find({"z_top_km", "z_top_m"});
    albedo_ = find({"ssa", "single_scattering_albedo"});
    index_ = find({"iphase", "phase_index"});
    extinction_ = find({"extinction_per_km", "extinction_per_m"});
    if (i_ < 0) lines_.fail("no column i or ix (allowed: a line that names the columns, then numbers)");
    if (extinction_ < 0) {
      lines_.fail("no column with extinction and its unit (allowed: extinction_per_km, extinction_per_m)");
    }
    if ((bottom_ < 0) != (top_ < 0)) lines_.fail("one of z_bottom, z_top is missing (allowed: both or none)");
    if (bottom_ < 0 && k_ < 0) lines_.fail("no heights (allowed: a column k, or z_bottom_km and z_top_km)");
    per_metre_ = column_.count("extinction_per_km") != 0 ? 1e-3 : 1;
    metres_ = column_.count("z_bottom_km") != 0 ? 1e3 : 1;
  }

  int find(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (const auto found = column_.find(name); found != column_.end()) return found->second;
    }
    return -1;
  }

  void read_cells() {
    std::string line;
    while (lines_.next(line)) {
      if (is_comment(line)) continue;
      const auto number = lines_.numbers(line, column_.size(), "cell");
      const auto at = [&](int column, double otherwise) { return column < 0 ? otherwise : number[column]; };
      OpticsCell cell{};
      cell.i = lines_.index(at(i_, 0), 0, shape_[0] > 0 ? static_cast<int>(shape_[0]) : most_cells, "x");
      cell.j = lines_.index(at(j_, 0), 0, shape_[1] > 0 ? static_cast<int>(shape_[1]) : most_cells, "y");
      cell.k = lines_.index(at(k_, 0), 0, shape_[2] > 0 && bottom_ < 0 ? static_cast<int>(shape_[2]) : most_cells, "z");
      cell.extinction = lines_.in_range(at(extinction_, 0) * per_metre_, 0, largest_number, "extinction [1/m]");
      cell.albedo = lines_.in_range(at(albedo_, 1), 0, 1, "single-scattering albedo");
      cell.index = static_cast<float>(lines_.index(at(index_, 1), 1, most_cells, "the phase functions") + 1);
      cell.bottom_m = at(bottom_, 0) * metres_;
      cell.top_m = at(top_, 0) * metres_;
      if (bottom_ >= 0 && !(cell.top_m > cell.bottom_m && std::abs(cell.top_m) < largest_number)) {
        lines_.fail("cell from {:.6g} m to {:.6g} m (allowed: top above bottom)", cell.bottom_m, cell.top_m);
      }
      cells_.push_back(cell);
    }
  }

  void check_cells() const {
    if (cells_.empty()) fail_import(options_.file, "no cells (allowed: at least one)");
  }

  int columns_along(int axis) const {
    int most = 0;
    for (const OpticsCell& cell : cells_) most = std::max(most, (axis == 0 ? cell.i : cell.j) + 1);
    const int given = options_.columns ? (*options_.columns)[axis] : static_cast<int>(shape_[axis]);
    if (given > 0 && given < most) {
      fail_import(options_.file, "cells outside the domain (found index {} along {}, allowed below {})", most - 1,
                  "xy"[axis], given);
    }
    return std::max(most, given);
  }

  void set_box() {
    if (shape_[0] > 0) check_import_size(options_, shape_[0], shape_[1], shape_[2]);
    cloud_.nx = columns_along(0);
    cloud_.ny = columns_along(1);
    if (shape_[0] <= 0 && !options_.columns) {
      cloud_.notes.push_back(fmt::format(
          "columns: {} x {}, as far as the cells reach; give --columns if the domain is larger", cloud_.nx, cloud_.ny));
    }
    cloud_.dx_m = options_.voxel_size_m ? (*options_.voxel_size_m)[0] : dx_m_;
    cloud_.dy_m = options_.voxel_size_m ? (*options_.voxel_size_m)[1] : dy_m_ > 0 ? dy_m_ : dx_m_;
    if (!(cloud_.dx_m > 0 && cloud_.dy_m > 0)) {
      fail_import(options_.file, "no cell size (found no 'dx=... km' in a comment, allowed with --voxel-size-m)");
    }
    if (options_.levels_by_voxel_size) use_level_numbers();
    if (bottom_ >= 0) {
      set_edges_of_cells();
    } else if (!level_m_.empty() && !options_.levels_by_voxel_size) {
      for (std::size_t n = 1; n < level_m_.size(); ++n) {
        if (!(level_m_[n] > level_m_[n - 1])) {
          fail_import(options_.file, "levels do not ascend (found {:.6g} m after {:.6g} m)", level_m_[n],
                      level_m_[n - 1]);
        }
      }
      cloud_.z_edge_m = edges_between(level_m_);
      cloud_.notes.emplace_back("levels are taken for the centres of cells that meet halfway");
    } else if (options_.voxel_size_m) {
      int levels = static_cast<int>(shape_[2]);
      for (const OpticsCell& cell : cells_) levels = std::max(levels, cell.k + 1);
      for (int k = 0; k <= levels; ++k) cloud_.z_edge_m.push_back(k * (*options_.voxel_size_m)[2]);
    } else {
      fail_import(options_.file,
                  "no heights (found neither z_bottom and z_top nor a comment 'z levels km: ...', allowed with "
                  "--voxel-size-m)");
    }
    check_import_size(options_, cloud_.nx, cloud_.ny, cloud_.nz());
  }

  /// The user gives the height of levels: the file's own heights do not count.
  void use_level_numbers() {
    if (k_ < 0) {
      fail_import(
          options_.file,
          "cells have heights and no level number, and --voxel-size-m says another height of levels (allowed: one "
          "number, or a column k)");
    }
    if (bottom_ >= 0 || !level_m_.empty()) {
      cloud_.notes.push_back(
          fmt::format("levels: of {:.6g} m from the ground, as --voxel-size-m says, in place of the "
                      "file's heights",
                      (*options_.voxel_size_m)[2]));
    }
    bottom_ = top_ = -1;
  }

  /// All edges that any cell has, those within a millimetre of each other made one; gaps become levels of clear air.
  void set_edges_of_cells() {
    std::vector<double>& edge = cloud_.z_edge_m;
    for (const OpticsCell& cell : cells_) {
      edge.push_back(cell.bottom_m);
      edge.push_back(cell.top_m);
    }
    std::sort(edge.begin(), edge.end());
    edge.erase(std::unique(edge.begin(), edge.end(), [](double a, double b) { return b - a < 1e-3; }), edge.end());
  }

  int edge_at(double z) const {
    const auto above = std::lower_bound(cloud_.z_edge_m.begin(), cloud_.z_edge_m.end(), z - 1e-3);
    return static_cast<int>(above - cloud_.z_edge_m.begin());
  }

  void fill() {
    cloud_.allocate();
    if (albedo_ >= 0) cloud_.single_scattering_albedo.assign(cloud_.density.size(), 1);
    if (index_ >= 0) cloud_.phase_index.assign(cloud_.density.size(), 1);
    std::vector<bool> taken(cloud_.density.size());
    for (const OpticsCell& cell : cells_) {
      const int first = bottom_ >= 0 ? edge_at(cell.bottom_m) : cell.k;
      const int end = bottom_ >= 0 ? edge_at(cell.top_m) : cell.k + 1;
      if (end > cloud_.nz()) {
        fail_import(options_.file, "cell above the levels (found k = {}, allowed 0 to {})", end - 1, cloud_.nz() - 1);
      }
      for (int k = first; k < end; ++k) {
        const std::size_t at = cloud_.cell(cell.i, cell.j, k);
        if (taken[at]) fail_import(options_.file, "cell ({}, {}, {}) is there twice", cell.i, cell.j, cell.k);
        taken[at] = true;
        cloud_.density[at] = cell.extinction;
        if (albedo_ >= 0) cloud_.single_scattering_albedo[at] = cell.albedo;
        if (index_ >= 0) cloud_.phase_index[at] = cell.index;
      }
    }
  }

  const CloudImportOptions& options_;
  TextLines lines_;
  LevelledCloud cloud_;
  std::map<std::string, int, std::less<>> column_;
  int i_ = -1, j_ = -1, k_ = -1, bottom_ = -1, top_ = -1, extinction_ = -1, albedo_ = -1, index_ = -1;
  double per_metre_ = 1, metres_ = 1;
  double dx_m_ = 0, dy_m_ = 0;
  std::array<double, 3> shape_{};
  std::vector<double> level_m_;
  std::vector<OpticsCell> cells_;
};

}  // namespace

LevelledCloud import_columns(const CloudImportOptions& options) {
  if (!options.voxel_size_m) {
    fail_import(options.file, "text columns i j k value do not say how large cells are (allowed: with --voxel-size-m)");
  }
  LevelledCloud cloud;
  cloud.quantity = options.quantity.empty() ? "extinction" : options.quantity;
  TextLines lines(options.file);
  std::vector<Cell> cells;
  std::string line;
  int levels = 0;
  bool may_be_head = true;
  while (lines.next(line)) {
    if (is_comment(line)) continue;
    if (std::exchange(may_be_head, false) && !repeated_number_in(split_words(line)[0])) continue;
    const auto number = lines.numbers(line, 0, "cell");
    if (number.size() != 4 || !repeated_number_in(split_words(line).back())) {
      lines.fail("not four numbers i j k value (found {} words)", split_words(line).size());
    }
    const Cell cell{lines.index(number[0], 0, most_cells, "x"), lines.index(number[1], 0, most_cells, "y"),
                    lines.index(number[2], 0, most_cells, "z"), lines.in_range(number[3], 0, largest_number, "value")};
    cloud.nx = std::max(cloud.nx, cell.i + 1);
    cloud.ny = std::max(cloud.ny, cell.j + 1);
    levels = std::max(levels, cell.k + 1);
    cells.push_back(cell);
  }
  if (cells.empty()) fail_import(options.file, "no cells (allowed: lines i j k value)");
  if (options.columns) {
    if ((*options.columns)[0] < cloud.nx || (*options.columns)[1] < cloud.ny) {
      fail_import(options.file, "cells outside the domain (found {} x {} columns, allowed {} x {})", cloud.nx, cloud.ny,
                  (*options.columns)[0], (*options.columns)[1]);
    }
    cloud.nx = (*options.columns)[0];
    cloud.ny = (*options.columns)[1];
  } else {
    cloud.notes.push_back(fmt::format(
        "columns: {} x {}, as far as the cells reach; give --columns if the domain is larger", cloud.nx, cloud.ny));
  }
  check_import_size(options, cloud.nx, cloud.ny, levels);
  cloud.dx_m = (*options.voxel_size_m)[0];
  cloud.dy_m = (*options.voxel_size_m)[1];
  for (int k = 0; k <= levels; ++k) cloud.z_edge_m.push_back(k * (*options.voxel_size_m)[2]);
  cloud.allocate();
  for (const Cell& cell : cells) {
    float& value = cloud.density[cloud.cell(cell.i, cell.j, cell.k)];
    if (value > 0) fail_import(options.file, "cell ({}, {}, {}) is there twice", cell.i, cell.j, cell.k);
    value = cell.value;
  }
  cloud.notes.push_back(
      fmt::format("{} in {}, indices from 0", cloud.quantity, cloud.quantity == "extinction" ? "1/m" : "g/m3"));
  return cloud;
}

LevelledCloud import_optics_csv(const CloudImportOptions& options) { return OpticsCsvReader(options).read(); }

}  // namespace cloudbow
