// Clouds as text below a head of sizes and levels: "at3d" (comma-separated, of pyshdom and AT3D) and "mystic"
// (libRadtran's three-dimensional clouds). Lengths are km, effective radii um.
#include <algorithm>

#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr double metres = 1000;

class TextGridReader {
 public:
  explicit TextGridReader(const CloudImportOptions& options) : options_(options), lines_(options.file) {}

  /// A comment, sizes, spacing, heights of points, names of columns, then cells counted from 0.
  LevelledCloud read_at3d() {
    cloud_.quantity = "liquid_water_content";
    set_sizes(next_numbers(3, "numbers of cells nx, ny, nz"));
    const std::vector<double> spacing = next_numbers(2, "spacing dx, dy");
    const std::vector<double> level = next_numbers(levels_, "heights of the points");
    if (level.size() != levels_ || levels_ < 2) {
      lines_.fail("{} heights for {} points (allowed: as many, at least 2)", level.size(), levels_);
    }
    check_ascent(level);
    set_box(spacing[0], spacing[1], edges_between(level));
    const std::string names = next_line("names of columns");
    const std::vector<std::string_view> column = split_words(names);
    const auto place = [&](std::string_view name) {
      const auto found = std::find(column.begin(), column.end(), name);
      return found == column.end() ? -1 : static_cast<int>(found - column.begin());
    };
    const int water = place("lwc"), radius = place("reff");
    if (column.size() < 4 || column[0] != "x" || column[1] != "y" || column[2] != "z" || water < 0) {
      lines_.fail("columns not known (found \"{}\", allowed x,y,z,lwc,reff)", names);
    }
    if (radius >= 0) cloud_.effective_radius_um.assign(cloud_.density.size(), 0);
    for_each_cell(column.size(), 0, [&](std::size_t cell, const std::vector<double>& number) {
      set_water(cell, number[static_cast<std::size_t>(water)],
                radius < 0 ? 0 : number[static_cast<std::size_t>(radius)]);
    });
    for (std::size_t n = 3; n < column.size(); ++n) {
      if (static_cast<int>(n) != water && static_cast<int>(n) != radius) note_left_out(column[n]);
    }
    cloud_.notes.emplace_back(
        "AT3D's text: lengths in km, lwc in g/m3, reff in um; points became cells centred on them");
    return std::move(cloud_);
  }

  /// Sizes and a flag for the columns, then spacing and edges of levels, then cells counted from 1.
  LevelledCloud read_mystic() {
    const std::vector<double> head = next_numbers(4, "nx, ny, nz and flag");
    set_sizes(head);
    const double flag = head[3];
    if (flag != 1 && flag != 2 && flag != 3) {
      lines_.fail(
          "flag of the columns is {} (allowed 1: extinction, asymmetry parameter, albedo; 2: extinction, "
          "effective radius; 3: liquid water, effective radius)",
          flag);
    }
    std::vector<double> edge = next_numbers(levels_ + 3, "dx, dy and edges of levels");
    if (edge.size() != levels_ + 3) {
      lines_.fail("{} edges for {} levels (allowed: one more than levels)", edge.size() - 2, levels_);
    }
    const double dx = edge[0], dy = edge[1];
    edge.erase(edge.begin(), edge.begin() + 2);
    check_ascent(edge);
    set_box(dx, dy, edge);
    cloud_.quantity = flag == 3 ? "liquid_water_content" : "extinction";
    auto& second = flag == 1 ? cloud_.single_scattering_albedo : cloud_.effective_radius_um;
    second.assign(cloud_.density.size(), flag == 1 ? 1.0F : 0.0F);
    for_each_cell(flag == 1 ? 6 : 5, 1, [&](std::size_t cell, const std::vector<double>& number) {
      if (flag == 3) return set_water(cell, number[3], number[4]);
      cloud_.density[cell] =
          lines_.in_range(number[3], 0, largest_number, "extinction [1/km]") / static_cast<float>(metres);
      second[cell] = flag == 1 ? lines_.in_range(number[5], 0, 1, "single-scattering albedo")
                               : lines_.in_range(number[4], 0, largest_number, "effective radius [um]");
    });
    if (flag == 1) note_left_out("asymmetry parameter");
    cloud_.notes.push_back(fmt::format("MYSTIC's text with flag {}: lengths in km, {}", flag,
                                       flag == 3   ? "liquid water in g/m3, effective radius in um"
                                       : flag == 2 ? "extinction in 1/km, effective radius in um"
                                                   : "extinction in 1/km"));
    return std::move(cloud_);
  }

 private:
  std::string next_line(const char* what) {
    std::string line;
    do {
      if (!lines_.next(line)) lines_.fail("the file ends before its {}", what);
    } while (is_comment(line));
    return line;
  }

  std::vector<double> next_numbers(std::size_t least, const char* what) {
    return lines_.numbers(next_line(what), least, what);
  }

  void set_sizes(const std::vector<double>& size) {
    check_import_size(options_, size[0], size[1], size[2]);
    cloud_.nx = static_cast<int>(size[0]);
    cloud_.ny = static_cast<int>(size[1]);
    levels_ = static_cast<std::size_t>(size[2]);
  }

  void check_ascent(const std::vector<double>& level) const {
    for (std::size_t n = 1; n < level.size(); ++n) {
      if (!(level[n] > level[n - 1]) || !std::isfinite(level[n]))
        lines_.fail("levels do not ascend (found {} km after {} km)", level[n], level[n - 1]);
    }
  }

  /// Lengths in km; a unit given by the user has priority.
  void set_box(double dx, double dy, const std::vector<double>& edge) {
    const auto& given = options_.voxel_size_m;
    cloud_.dx_m = given ? (*given)[0] : dx * metres;
    cloud_.dy_m = given ? (*given)[1] : dy * metres;
    if (!(cloud_.dx_m > 0 && cloud_.dy_m > 0 && cloud_.dx_m < largest_number && cloud_.dy_m < largest_number))
      lines_.fail("spacing is {} and {} km (allowed: > 0)", dx, dy);
    for (const double z : edge) cloud_.z_edge_m.push_back(z * metres);
    if (options_.levels_by_voxel_size) set_levels_by_voxel_size(cloud_, options_);
    cloud_.allocate();
    taken_.assign(cloud_.density.size(), false);
  }

  template <class Function>
  void for_each_cell(std::size_t columns, int first, Function function) {
    std::string line;
    std::size_t cells = 0;
    while (lines_.next(line)) {
      if (is_comment(line)) continue;
      const std::vector<double> number = lines_.numbers(line, columns, "cell");
      const std::size_t cell =
          cloud_.cell(lines_.index(number[0], first, cloud_.nx, "x"), lines_.index(number[1], first, cloud_.ny, "y"),
                      lines_.index(number[2], first, static_cast<int>(levels_), "z"));
      if (taken_[cell]) lines_.fail("cell ({}, {}, {}) is there twice", number[0], number[1], number[2]);
      taken_[cell] = true;
      function(cell, number);
      ++cells;
    }
    if (cells == 0) fail_import(options_.file, "no cells (allowed: at least one)");
  }

  void set_water(std::size_t cell, double water, double radius) {
    cloud_.density[cell] = lines_.in_range(water, 0, largest_number, "liquid water content [g/m3]");
    if (cloud_.effective_radius_um.empty() || water == 0) return;
    cloud_.effective_radius_um[cell] = lines_.in_range(radius, 0, largest_number, "effective radius [um]");
  }

  void note_left_out(std::string_view column) { cloud_.notes.push_back(fmt::format("NOT imported: {}", column)); }

  const CloudImportOptions& options_;
  TextLines lines_;
  LevelledCloud cloud_;
  std::size_t levels_ = 0;
  std::vector<bool> taken_;
};

}  // namespace

LevelledCloud import_at3d(const CloudImportOptions& options) { return TextGridReader(options).read_at3d(); }
LevelledCloud import_mystic(const CloudImportOptions& options) { return TextGridReader(options).read_mystic(); }

}  // namespace cloudbow
