// plane_parallel KEY VALUE ...: layers of air and cloud solved by adding and doubling; the case goes to stdout as JSON,
// in the form of the reference files that tests/validation/plane_parallel.py reads. Keys in any order:
//   id NAME
//   layer TAU SSA isotropic | rayleigh | henyey-greenstein G | legendre FILE     top first, repeatable; FILE: l chi_l
//   sun MU0    irradiance F0    sky RADIANCE    surface_albedo A
//   source_at_interfaces B0 ... BN    Planck radiances from the top of the N layers to the bottom, after the layers
//   surface_source B    Planck radiance of the surface
//   angles N (per hemisphere)    slices N (of each layer, with fluxes between)    radiances 0|1
// "est" in the case is the difference to a solution with two thirds of the angles: an upper estimate of its own error.
#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "reference/plane_parallel.hpp"

namespace {

using namespace cloudbow::reference;

/// Cosines and azimuths of the tables in reference files.
const std::vector<double> view_cosines = {0.1, 0.3, 0.5, 0.7, 0.9, 1.0}, view_azimuth = {0, 90, 180};

struct Case {
  std::string id = "case";
  PlaneParallelScene scene;
  PlaneParallelEffort effort;
  std::vector<std::string> phase;  // of each layer, as JSON
  bool thermal = false;
};

template <class T>
T get(std::istream& in, const std::string& what) {
  T value{};
  if (!(in >> value)) throw std::runtime_error("lacks or misspells the value of " + what);
  return value;
}

std::string number(double value) {
  std::ostringstream text;
  text << std::setprecision(10) << value;
  return text.str();
}

Moments read_moments(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<double> moments;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::size_t l = 0;
    double chi = 0;
    if (line.starts_with('#') || !(words >> l >> chi)) continue;
    moments.resize(std::max(moments.size(), l + 1));
    moments[l] = chi;
  }
  return [moments](int l) { return static_cast<std::size_t>(l) < moments.size() ? moments[l] : 0.0; };
}

void get_layer(std::istream& in, Case& c) {
  PlaneParallelLayer layer;
  layer.optical_depth = get<double>(in, "layer");
  layer.single_scattering_albedo = get<double>(in, "layer");
  const auto type = get<std::string>(in, "layer");
  if (type == "isotropic") {
    layer.moments = [](int l) { return l == 0 ? 1.0 : 0.0; };
    c.phase.emplace_back(R"({"type": "iso"})");
  } else if (type == "rayleigh") {
    layer.moments = [](int l) { return l == 0 ? 1.0 : l == 2 ? 0.1 : 0.0; };
    c.phase.emplace_back(R"({"type": "rayleigh"})");
  } else if (type == "henyey-greenstein") {
    const auto g = get<double>(in, type);
    layer.moments = [g](int l) { return std::pow(g, l); };
    c.phase.push_back(R"({"type": "hg", "g": )" + number(g) + "}");
  } else if (type == "legendre") {
    const auto path = get<std::string>(in, type);
    layer.moments = read_moments(path);
    c.phase.push_back(R"({"type": "legendre", "file": ")" + path + "\"}");
  } else {
    throw std::runtime_error("unknown phase function " + type);
  }
  if (!(layer.optical_depth >= 0) || !(layer.single_scattering_albedo >= 0 && layer.single_scattering_albedo <= 1))
    throw std::runtime_error("a layer needs an optical depth >= 0 and an albedo from 0 to 1");
  c.scene.layers.push_back(layer);
}

Case read_case(std::istream& in) {
  Case c;
  for (std::string key; in >> key;) {
    if (key == "layer") {
      get_layer(in, c);
    } else if (key == "id") {
      c.id = get<std::string>(in, key);
    } else if (key == "sun") {
      c.scene.sun_mu = get<double>(in, key);
    } else if (key == "irradiance") {
      c.scene.irradiance = get<double>(in, key);
    } else if (key == "sky") {
      c.scene.sky_radiance = get<double>(in, key);
    } else if (key == "surface_albedo") {
      c.scene.surface_albedo = get<double>(in, key);
    } else if (key == "source_at_interfaces") {
      double planck = get<double>(in, key);
      for (PlaneParallelLayer& layer : c.scene.layers) {
        layer.planck_top = planck;
        layer.planck_bottom = planck = get<double>(in, key);
      }
      c.thermal = true;
    } else if (key == "surface_source") {
      c.scene.surface_planck = get<double>(in, key);
      c.thermal = true;
    } else if (key == "angles") {
      c.effort.angles = get<int>(in, key);
    } else if (key == "slices") {
      c.effort.slices = get<int>(in, key);
    } else if (key == "radiances") {
      if (get<int>(in, key) != 0) c.effort.view_mu = view_cosines, c.effort.view_azimuth_deg = view_azimuth;
    } else {
      throw std::runtime_error("unknown key " + key);
    }
  }
  if (c.scene.layers.empty()) throw std::runtime_error("no layer");
  if (!(c.scene.sun_mu > 0 && c.scene.sun_mu <= 1)) throw std::runtime_error("sun needs a cosine above 0, up to 1");
  if (c.effort.angles < 3 || c.effort.slices < 1) throw std::runtime_error("angles from 3, slices from 1");
  return c;
}

double flux_difference(const PlaneParallelSolution& a, const PlaneParallelSolution& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.levels.size(); ++k) {
    worst = std::max({worst, std::abs(a.levels[k].up - b.levels[k].up),
                      std::abs(a.levels[k].down_diffuse - b.levels[k].down_diffuse)});
  }
  return worst;
}

double radiance_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return ((a - b).cwiseAbs().array() / a.cwiseAbs().array().max(1e-12)).maxCoeff();
}

void write_table(const char* name, const Eigen::MatrixXd& table) {
  std::cout << ", \"" << name << "\": [";
  for (Eigen::Index i = 0; i < table.rows(); ++i) {
    std::cout << (i > 0 ? ", [" : "[");
    for (Eigen::Index j = 0; j < table.cols(); ++j) std::cout << (j > 0 ? ", " : "") << table(i, j);
    std::cout << ']';
  }
  std::cout << ']';
}

std::string thermal_text(const Case& c) {
  if (!c.thermal) return "null";
  std::string text = R"({"source_at_interfaces": [)" + number(c.scene.layers.front().planck_top);
  for (const PlaneParallelLayer& layer : c.scene.layers) text += ", " + number(layer.planck_bottom);
  return text + R"(], "surface_source": )" + number(c.scene.surface_planck) + "}";
}

void write(const Case& c, const PlaneParallelSolution& solution, const PlaneParallelSolution& coarser) {
  std::cout << std::setprecision(10) << "{\"cases\": [\n {\"id\": \"" << c.id << "\", \"layers\": [";
  for (std::size_t n = 0; n < c.phase.size(); ++n) {
    const PlaneParallelLayer& layer = c.scene.layers[n];
    std::cout << (n > 0 ? ", " : "") << "{\"tau\": " << layer.optical_depth
              << ", \"ssa\": " << layer.single_scattering_albedo << ", \"phase\": " << c.phase[n] << '}';
  }
  std::cout << "],\n  \"mu0\": " << c.scene.sun_mu << ", \"phi0\": 0, \"F0\": " << c.scene.irradiance
            << ", \"isotropic_top\": " << c.scene.sky_radiance << ", \"surface_albedo\": " << c.scene.surface_albedo
            << ", \"thermal\": " << thermal_text(c) << ",\n  \"results\": {\"levels\": [";
  for (std::size_t k = 0; k < solution.levels.size(); ++k) {
    const PlaneParallelLevel& level = solution.levels[k];
    std::cout << (k > 0 ? ",\n   " : "") << "{\"tau\": " << level.optical_depth << ", \"flux_up\": " << level.up
              << ", \"flux_down_diffuse\": " << level.down_diffuse << ", \"flux_down_direct\": " << level.down_direct
              << '}';
  }
  std::cout << ']';
  const bool has_radiances = solution.radiance_up_top.size() > 0;
  if (has_radiances) {
    write_table("radiance_up_top", solution.radiance_up_top);
    write_table("radiance_down_bottom", solution.radiance_down_bottom);
  }
  std::cout << "},\n  \"est\": {\"flux_abs\": " << flux_difference(solution, coarser);
  if (has_radiances) {
    std::cout << ", \"rad_rel\": "
              << std::max(radiance_difference(solution.radiance_up_top, coarser.radiance_up_top),
                          radiance_difference(solution.radiance_down_bottom, coarser.radiance_down_bottom));
  }
  std::cout << "}}\n]}\n";
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::stringstream words;
    for (int n = 1; n < argc; ++n) words << argv[n] << ' ';
    const Case c = read_case(words);
    PlaneParallelEffort less = c.effort;
    less.angles = 2 * c.effort.angles / 3;
    write(c, solve_plane_parallel(c.scene, c.effort), solve_plane_parallel(c.scene, less));
  } catch (const std::exception& error) {
    std::cerr << "plane_parallel: " << error.what() << '\n';
    return 2;
  }
}
