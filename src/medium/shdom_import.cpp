// Input files of SHDOM (Evans 1998, doi 10.1175/1520-0469(1998)055<0429:TSHDOM>2.0.CO;2): property files with tabulated
// phase functions ("T", and the scalar part of polarised ones, "P") or extinction alone ("E"); liquid water files with
// one or two parameters; particle files. Values belong to points; here each is a cell centred on its point.
#include <algorithm>
#include <array>
#include <cctype>

#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr double metres = 1000;  // SHDOM's lengths are km
constexpr int most_phases = 100000;
constexpr int most_moments = 100000;

class ShdomReader {
 public:
  explicit ShdomReader(const CloudImportOptions& options) : options_(options), lines_(options.file) {}

  LevelledCloud read() {
    std::string first;
    lines_.next(first);
    const auto at = first.find_first_not_of(" \t");
    const char type = at == std::string::npos ? ' ' : first[at];
    switch (std::toupper(static_cast<unsigned char>(type))) {
      case 'T':
      case 'P':
        read_properties(type == 'P' || type == 'p');
        break;
      case 'E':
        read_extinctions();
        break;
      case '1':
      case '2':
      case '3':
        read_water(type);
        break;
      default:
        lines_.fail(
            "not a file of SHDOM that is read here (found a first line that begins with '{}', allowed T or P: property "
            "file with tabulated phase functions, E: extinction only, 1 or 2: LWC file, 3: particle file)",
            type < ' ' || type > '~' ? '?' : type);
    }
    cloud_.notes.emplace_back(
        "lengths of SHDOM files are taken for km, extinction for 1/km; points became cells centred on them");
    return std::move(cloud_);
  }

 private:
  std::vector<double> next_numbers(std::size_t least, const char* what) {
    std::string line;
    do {
      if (!lines_.next(line)) lines_.fail("the file ends before its {}", what);
    } while (split_words(line).empty());
    return lines_.numbers(line, least, what);
  }

  void read_counts() {
    const auto count = next_numbers(3, "numbers of points nx, ny, nz");
    check_import_size(options_, count[0], count[1], count[2]);
    cloud_.nx = static_cast<int>(count[0]);
    cloud_.ny = static_cast<int>(count[1]);
    levels_ = static_cast<int>(count[2]);
  }

  /// Levels at the points or, one more, between cells. Long lists go on over several lines.
  void take_spacing_and_levels(std::vector<double> number, const char* what) {
    while (number.size() < 2 + static_cast<std::size_t>(levels_)) {
      const auto more = next_numbers(1, what);
      number.insert(number.end(), more.begin(), more.end());
    }
    cloud_.dx_m = number[0] * metres;
    cloud_.dy_m = number[1] * metres;
    if (options_.voxel_size_m) {
      cloud_.dx_m = (*options_.voxel_size_m)[0];
      cloud_.dy_m = (*options_.voxel_size_m)[1];
    }
    if (!(cloud_.dx_m > 0 && cloud_.dy_m > 0 && cloud_.dx_m < largest_number && cloud_.dy_m < largest_number)) {
      lines_.fail("spacing of the points is {} and {} km (allowed: > 0)", number[0], number[1]);
    }
    std::vector<double> level(number.begin() + 2, number.end());
    for (double& z : level) z *= metres;
    for (std::size_t n = 1; n < level.size(); ++n) {
      if (!(level[n] > level[n - 1]) || !std::isfinite(level[n])) {
        lines_.fail("levels do not ascend (found {:.6g} km after {:.6g} km)", level[n] / metres, level[n - 1] / metres);
      }
    }
    if (level.size() == static_cast<std::size_t>(levels_) + 1) {
      cloud_.z_edge_m = level;  // the I3RC model's variant: cells
    } else if (level.size() == static_cast<std::size_t>(levels_) && levels_ >= 2) {
      cloud_.z_edge_m = edges_between(level);
    } else {
      lines_.fail("{} levels for {} points (allowed: as many, at least 2, or one more as edges of cells)", level.size(),
                  levels_);
    }
    if (options_.levels_by_voxel_size) set_levels_by_voxel_size(cloud_, options_);
    cloud_.allocate();
  }

  std::size_t cell_of(const std::vector<double>& line) const {
    return cloud_.cell(lines_.index(line[0], 1, cloud_.nx, "x"), lines_.index(line[1], 1, cloud_.ny, "y"),
                       lines_.index(line[2], 1, levels_, "z"));
  }

  /// Calls function(numbers) for each line of a point.
  template <class Function>
  void for_each_point(std::size_t least, Function function) {
    std::string line;
    while (lines_.next(line)) {
      if (!split_words(line).empty()) function(lines_.numbers(line, least, "point"));
    }
  }

  float extinction(double per_km) const {
    return lines_.in_range(per_km, 0, largest_number, "extinction [1/km]") / static_cast<float>(metres);
  }

  /// Coefficients with the factor 2l+1, the first of degree `first_degree`.
  std::vector<double> read_moments(std::vector<double> number, std::size_t count, std::size_t first_degree) {
    while (number.size() < count) {
      const auto more = next_numbers(1, "coefficients of a phase function");
      number.insert(number.end(), more.begin(), more.end());
    }
    std::vector<double> moments;
    if (first_degree == 1) moments.push_back(1);
    for (std::size_t n = 0; n < count; ++n)
      moments.push_back(number[n] / static_cast<double>(2 * (n + first_degree) + 1));
    return moments;
  }

  std::size_t count_of(double number, int most, const char* what) const {
    if (!(number >= 0 && number <= most) || number != std::floor(number)) {
      lines_.fail("{} is {} (allowed: 0 to {})", what, number, most);
    }
    return static_cast<std::size_t>(number);
  }

  void read_phase_functions(bool polarised) {
    const std::size_t phases =
        count_of(next_numbers(1, "number of phase functions")[0], most_phases, "number of phase functions");
    const int elements = polarised ? 6 : 1;
    for (std::size_t p = 0; p < phases; ++p) {
      for (int element = 0; element < elements; ++element) {
        std::vector<double> number = next_numbers(polarised ? 2 : 1, "phase function");
        if (polarised) number.erase(number.begin());
        const std::size_t last = count_of(number[0], most_moments, "number of coefficients");
        number.erase(number.begin());
        const auto moments = read_moments(std::move(number), polarised ? last + 1 : last, polarised ? 0 : 1);
        if (element == 0) cloud_.moments.push_back(moments);
      }
    }
  }

  void read_properties(bool polarised) {
    cloud_.quantity = "extinction";
    read_counts();
    take_spacing_and_levels(next_numbers(2, "spacing and levels"), "levels");
    read_phase_functions(polarised);
    cloud_.single_scattering_albedo.assign(cloud_.density.size(), 1);
    cloud_.phase_index.assign(cloud_.density.size(), 1);
    const auto phases = static_cast<int>(cloud_.moments.size());
    for_each_point(7, [&](const std::vector<double>& line) {
      const std::size_t cell = cell_of(line);
      cloud_.density[cell] = extinction(line[4]);
      cloud_.single_scattering_albedo[cell] = lines_.in_range(line[5], 0, 1, "single-scattering albedo");
      cloud_.phase_index[cell] = static_cast<float>(lines_.index(line[6], 1, phases, "the phase functions") + 1);
    });
  }

  void read_extinctions() {
    cloud_.quantity = "extinction";
    read_counts();
    take_spacing_and_levels(next_numbers(2, "spacing and levels"), "levels");
    for (std::size_t found = 0; found < static_cast<std::size_t>(levels_);) {
      found += next_numbers(1, "temperatures").size();
    }
    std::vector<double> number = next_numbers(2, "albedo and phase function");
    const float albedo = lines_.in_range(number[0], 0, 1, "single-scattering albedo");
    const std::size_t last = count_of(number[1], most_moments, "number of coefficients");
    number.erase(number.begin(), number.begin() + 2);
    cloud_.moments.push_back(read_moments(std::move(number), last, 1));
    cloud_.single_scattering_albedo.assign(cloud_.density.size(), albedo);
    cloud_.phase_index.assign(cloud_.density.size(), 1);
    for_each_point(4, [&](const std::vector<double>& line) { cloud_.density[cell_of(line)] = extinction(line[3]); });
  }

  /// LWC files ('1': water; '2': water and effective radius) and particle files ('3').
  void read_water(char type) {
    cloud_.quantity = "liquid_water_content";
    read_counts();
    auto spacing = next_numbers(2, "spacing");
    take_spacing_and_levels(std::move(spacing), "levels");
    for (std::size_t found = 0; found < static_cast<std::size_t>(levels_);) {
      found += next_numbers(1, "temperatures").size();
    }
    if (type != '1') cloud_.effective_radius_um.assign(cloud_.density.size(), 0);
    std::size_t others = 0;
    for_each_point(type == '3'   ? 4
                   : type == '2' ? 5
                                 : 4,
                   [&](const std::vector<double>& line) {
                     const std::size_t cell = cell_of(line);
                     if (type != '3') {
                       set_water(cell, line[3], type == '2' ? line[4] : 0);
                       return;
                     }
                     const std::size_t parts = count_of(line[3], 1000, "number of components");
                     if (line.size() < 4 + 3 * parts)
                       lines_.fail("{} numbers for {} components (allowed: 3 each)", line.size() - 4, parts);
                     for (std::size_t part = 0; part < parts; ++part) {
                       if (line[4 + 3 * part] == 1) {
                         set_water(cell, line[5 + 3 * part], line[6 + 3 * part]);
                       } else {
                         ++others;
                       }
                     }
                   });
    if (others > 0)
      cloud_.notes.push_back(
          fmt::format("components: type 1 taken for cloud water, {} entries of other types left out", others));
  }

  void set_water(std::size_t cell, double water, double radius) {
    cloud_.density[cell] = lines_.in_range(water, 0, largest_number, "liquid water content [g/m3]");
    if (cloud_.effective_radius_um.empty() || water == 0) return;
    cloud_.effective_radius_um[cell] = lines_.in_range(radius, 1e-6, largest_number, "effective radius [um]");
  }

  const CloudImportOptions& options_;
  TextLines lines_;
  LevelledCloud cloud_;
  int levels_ = 0;
};

}  // namespace

LevelledCloud import_shdom(const CloudImportOptions& options) { return ShdomReader(options).read(); }

}  // namespace cloudbow
