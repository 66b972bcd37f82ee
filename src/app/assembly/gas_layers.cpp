#include "app/assembly/gas_layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "app/assembly/open_cloud.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

// Layers are even in themselves, so they must be thin compared with the scale heights of water vapour and air.
constexpr double thickest_below_m = 250;  // up to
constexpr double dense_air_m = 12000;     // this height
constexpr double thickest_above_m = 1000;
constexpr double thinnest_in_cloud_m = 100;  // every face of a voxel plane need not end a layer
constexpr double least_distance_m = 1;

double thickest_at(double height_m) { return height_m < dense_air_m ? thickest_below_m : thickest_above_m; }

struct Span {
  double bottom_m, top_m;
};

/// Faces between the cloud's lowest and highest voxel, every few.
std::vector<double> faces_of(const CloudField& field, const Span& domain) {
  const double dz = field.cell_size_m[2];
  const int stride = std::max(1, static_cast<int>(std::lround(thinnest_in_cloud_m / dz)));
  const auto rows = static_cast<std::size_t>(field.cells[1]);
  int low = field.cells[2], high = 0;
  for (int k = 0; k < field.cells[2]; ++k) {
    const std::size_t row = static_cast<std::size_t>(k) * rows;
    if (field.row_begin[row] == field.row_begin[row + rows]) continue;
    low = std::min(low, k);
    high = k + 1;
  }
  std::vector<double> faces;
  for (int k = low; k <= high; ++k) {
    const double z = field.min_m[2] + k * dz;
    if ((k == low || k == high || (k - low) % stride == 0) && z > domain.bottom_m && z < domain.top_m)
      faces.push_back(z);
  }
  return faces;
}

/// Ends of the layers, ascending.
std::vector<double> layer_edges(const Atmosphere& air, const CloudField* field, const Span& domain) {
  std::vector<double> given{domain.bottom_m, domain.top_m};
  std::optional<Span> cloud;
  if (field != nullptr) {
    const std::vector<double> faces = faces_of(*field, domain);
    if (!faces.empty()) cloud = Span{faces.front(), faces.back()};
    given.insert(given.end(), faces.begin(), faces.end());
  }
  const auto in_cloud = [&](double z) { return cloud && z > cloud->bottom_m && z < cloud->top_m; };
  for (const double z : air.height_m) {
    if (!(z > domain.bottom_m && z < domain.top_m) || in_cloud(z)) continue;
    // Faces and ends of the domain stay; heights of the profile beside them are not needed.
    const auto near = [z](double other) { return std::abs(z - other) < least_distance_m; };
    if (std::none_of(given.begin(), given.end(), near)) given.push_back(z);
  }
  std::sort(given.begin(), given.end());
  std::vector<double> edges{given.front()};
  for (std::size_t e = 1; e < given.size(); ++e) {
    const double from = edges.back(), to = given[e];
    const int parts = in_cloud(.5 * (from + to))
                          ? 1
                          : std::max(1, static_cast<int>(std::ceil((to - from) / thickest_at(from) - 1e-9)));
    for (int n = 1; n < parts; ++n) edges.push_back(from + (to - from) * n / parts);
    edges.push_back(to);
  }
  return edges;
}

}  // namespace

void add_gas_layers(const CloudField* field, Scene& scene) {
  const Atmosphere& air = scene.atmosphere->air;
  const GasModel& model = *scene.broadband->model;
  Span domain{field != nullptr ? std::min(0., field->min_m[2]) : 0., air.height_m.back()};
  if (field != nullptr) domain.top_m = std::max(domain.top_m, field->max_m(2));
  const auto corner = [&](const std::array<double, 3>& of) {
    return field != nullptr ? onto_face(*field, 2, of[2]) : of[2];
  };
  if (scene.domain.min_m) domain.bottom_m = corner(*scene.domain.min_m);
  if (scene.domain.max_m) domain.top_m = corner(*scene.domain.max_m);
  const std::vector<double> edges = layer_edges(air, field, domain);
  GasModel::LayerOptics optics;
  try {
    optics = gas_optics(model, air, edges);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", scene.where("atmosphere"), error.what()));
  }
  const auto point = static_cast<std::size_t>(scene.gas_point);
  // Layers without any optical depth too, so that all g-points have the same domain.
  const auto add = [&](const std::vector<double>& depth, double single_scattering_albedo) {
    for (std::size_t l = 0; l < depth.size(); ++l)
      scene.layers.push_back(
          {edges[l], edges[l + 1], depth[l], single_scattering_albedo, scene.broadband->molecules_phase_function});
  };
  add(optics.absorption[point], 0);
  if (!optics.rayleigh.empty()) add(optics.rayleigh[point], 1);
}

}  // namespace cloudbow
