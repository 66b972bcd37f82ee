#include "cloudbow/medium/spectral_albedo.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/text_case.hpp"
#include "cloudbow/medium/spectral_weight.hpp"
#include "les_vocabulary.hpp"
#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr double shortest_um = .1, longest_um = 1000;
constexpr double cm1_um = 1e4;  // wavenumber [cm-1] times wavelength [um]
constexpr std::size_t most_rows = 1000000;
constexpr std::uintmax_t most_text_bytes = 100000000;

const UnitTable wavelength_units{"um, nm, m",
                                 {{"um", 1},
                                  {"micron", 1},
                                  {"microns", 1},
                                  {"micrometer", 1},
                                  {"micrometers", 1},
                                  {"micrometre", 1},
                                  {"micrometres", 1},
                                  {"nm", 1e-3},
                                  {"nanometer", 1e-3},
                                  {"nanometers", 1e-3},
                                  {"nanometre", 1e-3},
                                  {"nanometres", 1e-3},
                                  {"m", 1e6}}};
const UnitTable albedo_units{"1, %", {{"1", 1}, {"-", 1}, {"%", 1e-2}, {"percent", 1e-2}}};

/// Text in brackets behind a word: "nm" of "wavelength(nm)" or "wavelength (nm)"; none if the word is not there.
std::optional<std::string> unit_behind(const std::string& line, const char* word) {
  const auto at = lower_case(line).find(word);
  if (at == std::string::npos) return std::nullopt;
  const auto open = line.find_first_not_of(" \t", at + std::string_view(word).size());
  if (open == std::string::npos || (line[open] != '(' && line[open] != '[')) return std::nullopt;
  const auto close = line.find_first_of(")]", open);
  if (close == std::string::npos) return std::nullopt;
  return line.substr(open + 1, close - open - 1);
}

class AlbedoReader {
 public:
  explicit AlbedoReader(const std::filesystem::path& file) : file_(file), lines_(file) {}

  SpectralAlbedo read() {
    std::string line;
    while (lines_.next(line)) {
      if (is_comment(line)) {
        if (result_.albedo.empty()) read_heading(line);
      } else {
        read_row(line);
      }
    }
    if (result_.albedo.size() > 1 && result_.wavelength_um.front() > result_.wavelength_um.back()) {
      std::reverse(result_.wavelength_um.begin(), result_.wavelength_um.end());
      std::reverse(result_.albedo.begin(), result_.albedo.end());
    }
    check_spectral_albedo(result_, file_.string());
    return std::move(result_);
  }

 private:
  double factor(const std::string& line, const char* word, const UnitTable& units, double usual) const {
    const auto unit = unit_behind(line, word);
    if (!unit) return usual;
    if (const auto factor = factor_of(units, *unit)) return *factor;
    lines_.fail("column {}: unit not known (found \"{}\", allowed {}); write it as in \"# wavelength(nm) albedo(%)\"",
                word, *unit, units.allowed);
  }

  void read_heading(const std::string& line) {
    um_ = factor(line, "wavelength", wavelength_units, um_);
    one_ = factor(line, "albedo", albedo_units, one_);
  }

  void read_row(const std::string& line) {
    const auto words = split_words(line);
    if (words.size() != 2) lines_.fail("not two columns (found {}, allowed wavelength and albedo)", words.size());
    std::vector<double> value;
    for (const std::string_view word : words) {
      const auto number = number_in(word);
      if (!number) lines_.fail("not a number (found \"{}\", allowed a number) comments begin with #", word);
      value.push_back(*number);
    }
    if (result_.albedo.size() == most_rows) lines_.fail("too many lines (found more, allowed {})", most_rows);
    result_.wavelength_um.push_back(value[0] * um_);
    result_.albedo.push_back(value[1] * one_);
  }

  const std::filesystem::path& file_;
  TextLines lines_;
  SpectralAlbedo result_;
  double um_ = 1;
  double one_ = 1;
};

/// The albedo by wavenumber. Nodes so near that linear in wavenumber is linear in wavelength, to 2e-5 of a step.
struct ByWavenumber {
  std::vector<double> wavenumber_cm1;
  std::vector<double> albedo;
};

ByWavenumber by_wavenumber(const SpectralAlbedo& given) {
  constexpr double largest_ratio = 1.0125;
  ByWavenumber result;
  const auto add = [&](double wavelength, double albedo) {
    result.wavenumber_cm1.push_back(cm1_um / wavelength);
    result.albedo.push_back(albedo);
  };
  for (std::size_t n = given.albedo.size() - 1; n > 0; --n) {
    const double shorter = given.wavelength_um[n - 1], longer = given.wavelength_um[n];
    const int pieces = given.albedo[n] == given.albedo[n - 1]
                           ? 1
                           : static_cast<int>(std::ceil(std::log(longer / shorter) / std::log(largest_ratio)));
    for (int piece = 0; piece < pieces; ++piece) {
      const double wavelength = longer * std::pow(shorter / longer, static_cast<double>(piece) / pieces);
      const double t = (longer - wavelength) / (longer - shorter);
      add(wavelength, (1 - t) * given.albedo[n] + t * given.albedo[n - 1]);
    }
  }
  add(given.wavelength_um.front(), given.albedo.front());
  return result;
}

double integral_of(const SpectralWeight& weight) {
  double sum = 0;
  for (std::size_t n = 1; n < weight.weight.size(); ++n) {
    sum += (weight.wavenumber_cm1[n] - weight.wavenumber_cm1[n - 1]) * (weight.weight[n] + weight.weight[n - 1]) / 2;
  }
  return sum;
}

}  // namespace

void check_spectral_albedo(const SpectralAlbedo& given, const std::string& name) {
  const auto fail = [&](const std::string& text) { throw InputError(name + ": " + text); };
  if (given.albedo.empty() || given.wavelength_um.size() != given.albedo.size()) {
    fail(fmt::format(
        "spectral albedo: no pairs (found {} wavelengths and {} albedos, allowed as many of both, 1 or more)",
        given.wavelength_um.size(), given.albedo.size()));
  }
  for (std::size_t n = 0; n < given.albedo.size(); ++n) {
    const double wavelength = given.wavelength_um[n], albedo = given.albedo[n];
    if (!(wavelength >= shortest_um && wavelength <= longest_um)) {
      fail(fmt::format("wavelength out of range (found {:.6g} um, allowed {} to {} um); look at its unit", wavelength,
                       shortest_um, longest_um));
    }
    if (n > 0 && !(wavelength > given.wavelength_um[n - 1])) {
      fail(fmt::format("wavelengths do not ascend (found {:.6g} after {:.6g} um, allowed each once, in order)",
                       wavelength, given.wavelength_um[n - 1]));
    }
    if (!(albedo >= 0 && albedo <= 1)) {
      fail(fmt::format("albedo out of range (found {:.6g} at {:.6g} um, allowed 0 to 1); look at its unit", albedo,
                       wavelength));
    }
  }
}

SpectralAlbedo read_spectral_albedo(const std::filesystem::path& file) {
  check_input(file, "wavelength and albedo as text columns", most_text_bytes);
  return AlbedoReader(file).read();
}

std::vector<double> albedo_of_points(const GasModel& model, const SpectralAlbedo& albedo, const std::string& name) {
  check_spectral_albedo(albedo, name);
  const ByWavenumber nodes = by_wavenumber(albedo);
  std::vector<double> result;
  double power = 0, beyond = 0;
  for (int point = 0; point < model.points(); ++point) {
    const SpectralWeight weight = weight_of_point(model, point);
    const NodeShares shares = node_shares(nodes.wavenumber_cm1, weight.wavenumber_cm1, weight.weight, name);
    double mean = 0;
    for (std::size_t n = 0; n < nodes.albedo.size(); ++n) mean += shares.share[n] * nodes.albedo[n];
    result.push_back(std::clamp(mean, 0.0, 1.0));
    const double of_point = integral_of(weight);
    power += of_point;
    beyond += of_point * (shares.below + shares.above);
  }
  // A single pair is an albedo of all wavelengths.
  if (albedo.albedo.size() > 1 && beyond > largest_power_beyond_albedo * power) {
    const auto range = wavelengths_of(model);
    throw InputError(
        fmt::format("{}: lacks {:.3g} to {:.3g} um (found {:.6g} to {:.6g}, {:.0f} % beyond, "
                    "allowed {:.0f}); repeat the last albedo",
                    name, range[0], range[1], albedo.wavelength_um.front(), albedo.wavelength_um.back(),
                    100 * beyond / power, 100 * largest_power_beyond_albedo));
  }
  return result;
}

}  // namespace cloudbow
