// monte_carlo JOB: the solver of monte_carlo.hpp on a job in text; the result goes to stdout as JSON. A job is a list
// of keys with their values, in any order; `columns` and `z_edges` come before `medium` and `emission`:
//   columns NX NY DX DY            cells of DX x DY metres
//   z_edges NZ Z0 ... Z_NZ         metres, ascending
//   open_sides 0|1    absorption 0|1    surface_albedo A    sun ZENITH AZIMUTH    view ZENITH AZIMUTH (repeatable)
//   levels N L1 ... LN             indices of z_edges, from 0
//   medium SSA isotropic | rayleigh | henyey-greenstein G | table N ANGLE VALUE ... ANGLE VALUE, and then its
//   extinction:
//          profile E1 ... E_NZ  or  cells E1 ... E_(NX*NY*NZ), x fastest, the lowest layer first [1/m].
//   sun_flux F (1)    sky_radiance B (0)    circumsolar DEG (0).
//   emission planck CELLS | step CELLS | surface B1 ... B_(NX*NY):
//          mean Planck radiance of the cells; its increase from the lower to the upper face; of the surface.
//          CELLS as the extinction of a medium: profile or cells.
//   photons N    batches N    seed N    threads N    backward 0|1
#include <ctime>
#include <exception>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <string>

#include "reference/monte_carlo.hpp"

namespace {

using namespace cloudbow::reference;

template <class T>
T get(std::istream& in, const std::string& what) {
  T value{};
  if (!(in >> value)) throw std::runtime_error("the job lacks or misspells " + what);
  return value;
}

std::vector<double> get_numbers(std::istream& in, std::size_t count, const std::string& what) {
  std::vector<double> values(count);
  for (double& value : values) value = get<double>(in, what);
  return values;
}

Scatterer get_scatterer(std::istream& in) {
  const auto type = get<std::string>(in, "medium");
  if (type == "isotropic") return Scatterer::isotropic();
  if (type == "rayleigh") return Scatterer::rayleigh();
  if (type == "henyey-greenstein") return Scatterer::henyey_greenstein(get<double>(in, type));
  if (type != "table") throw std::runtime_error("the job has an unknown scatterer " + type);
  std::vector<double> angle(get<std::size_t>(in, type)), value(angle.size());
  for (std::size_t n = 0; n < angle.size(); ++n) {
    angle[n] = get<double>(in, type);
    value[n] = get<double>(in, type);
  }
  return Scatterer::table(angle, value);
}

std::size_t columns_of(const MonteCarloScene& scene) {
  return static_cast<std::size_t>(scene.columns[0]) * scene.columns[1];
}

/// A number for each cell: all of them, or one for each layer.
std::vector<double> get_cells(std::istream& in, const MonteCarloScene& scene) {
  const auto form = get<std::string>(in, "cells");
  const std::size_t columns = columns_of(scene), layers = scene.z_edge_m.size() - 1;
  if (form == "cells") return get_numbers(in, columns * layers, form);
  if (form != "profile") throw std::runtime_error("the job has an unknown form of cells " + form);
  std::vector<double> values;
  for (std::size_t k = 0; k < layers; ++k) values.insert(values.end(), columns, get<double>(in, form));
  return values;
}

Medium get_medium(std::istream& in, const MonteCarloScene& scene) {
  Medium medium;
  medium.single_scattering_albedo = get<double>(in, "medium");
  medium.scatterer = get_scatterer(in);
  medium.extinction = get_cells(in, scene);
  return medium;
}

void get_emission(std::istream& in, MonteCarloScene& scene) {
  const auto what = get<std::string>(in, "emission");
  if (what == "planck") {
    scene.emission.planck = get_cells(in, scene);
  } else if (what == "step") {
    scene.emission.step = get_cells(in, scene);
  } else if (what == "surface") {
    scene.emission.surface = get_numbers(in, columns_of(scene), what);
  } else {
    throw std::runtime_error("the job has an unknown emission " + what);
  }
}

void read_job(std::istream& in, MonteCarloScene& scene, MonteCarloEffort& effort) {
  std::string key;
  while (in >> key) {
    if (key == "columns") {
      scene.columns = {get<int>(in, key), 0};
      scene.columns[1] = get<int>(in, key);
      scene.column_size_m = {get<double>(in, key), 0};
      scene.column_size_m[1] = get<double>(in, key);
    } else if (key == "z_edges") {
      const auto layers = get<std::size_t>(in, key);
      scene.z_edge_m = get_numbers(in, layers + 1, key);
    } else if (key == "open_sides") {
      scene.open_sides = get<int>(in, key) != 0;
    } else if (key == "absorption") {
      scene.absorption = get<int>(in, key) != 0;
    } else if (key == "surface_albedo") {
      scene.surface_albedo = get<double>(in, key);
    } else if (key == "emission") {
      get_emission(in, scene);
    } else if (key == "sun_flux") {
      scene.sun_flux = get<double>(in, key);
    } else if (key == "sky_radiance") {
      scene.sky_radiance = get<double>(in, key);
    } else if (key == "sun") {
      scene.sun_zenith_deg = get<double>(in, key);
      scene.sun_azimuth_deg = get<double>(in, key);
    } else if (key == "circumsolar") {
      scene.circumsolar_deg = get<double>(in, key);
    } else if (key == "view") {
      const auto zenith = get<double>(in, key);
      scene.views.push_back({zenith, get<double>(in, key)});
    } else if (key == "levels") {
      const auto count = get<std::size_t>(in, key);
      for (const double level : get_numbers(in, count, key)) scene.levels.push_back(static_cast<int>(level));
    } else if (key == "medium") {
      scene.media.push_back(get_medium(in, scene));
    } else if (key == "photons") {
      effort.photons = get<std::int64_t>(in, key);
    } else if (key == "batches") {
      effort.batches = get<int>(in, key);
    } else if (key == "seed") {
      effort.seed = get<std::uint64_t>(in, key);
    } else if (key == "threads") {
      effort.threads = get<int>(in, key);
    } else if (key == "backward") {
      effort.backward = get<int>(in, key) != 0;
    } else {
      throw std::runtime_error("the job has an unknown key " + key);
    }
  }
  if (effort.batches < 2 || effort.photons < effort.batches) {
    throw std::runtime_error("a job needs two batches and a photon in each");
  }
}

void write_numbers(const char* name, const std::vector<double>& values) {
  std::cout << '"' << name << "\": [";
  for (std::size_t n = 0; n < values.size(); ++n) std::cout << (n > 0 ? "," : "") << values[n];
  std::cout << ']';
}

void write_planes(const char* name, const std::vector<Plane>& planes) {
  std::cout << ",\n\"" << name << "\": [";
  for (std::size_t n = 0; n < planes.size(); ++n) {
    const Plane& plane = planes[n];
    std::cout << (n > 0 ? ",\n" : "\n") << "{\"mean\": " << plane.mean
              << ", \"mean_standard_error\": " << plane.mean_standard_error << ", ";
    write_numbers("value", plane.value);
    std::cout << ", ";
    write_numbers("standard_error", plane.standard_error);
    std::cout << '}';
  }
  std::cout << ']';
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: monte_carlo JOB\n";
    return 2;
  }
  try {
    MonteCarloScene scene;
    MonteCarloEffort effort;
    std::ifstream job(argv[1]);
    read_job(job, scene, effort);
    const std::clock_t begin = std::clock();
    const MonteCarloResult result = solve_by_monte_carlo(scene, effort);
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    std::cout << std::setprecision(9) << "{\"cpu_seconds\": " << seconds
              << ", \"photons\": " << effort.photons / effort.batches * effort.batches;
    write_planes("up", result.up);
    write_planes("down", result.down);
    write_planes("circumsolar", result.circumsolar);
    write_planes("absorbed", result.absorbed);
    write_planes("radiance", result.radiance);
    std::cout << "}\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
