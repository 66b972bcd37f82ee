#include "cloudbow/io/gas_optics_file.hpp"

#include <cassert>
#include <span>

#include "cloudbow/core/atomic_file.hpp"
#include "io/netcdf4_file.hpp"

namespace cloudbow {
namespace {

constexpr const char* point_name = "g_point";
constexpr const char* layer_name = "layer";
constexpr const char* edge_name = "z_edge";

std::vector<double> joined(const std::vector<std::vector<double>>& rows) {
  std::vector<double> all;
  for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
  return all;
}

void write_all(const std::filesystem::path& path, const GasOpticsData& data) {
  const bool is_solar = data.light == GasModel::Light::solar;
  hdf5::Handle file = hdf5::create_file(path);
  netcdf4::write_attributes(file, {{"Conventions", "CF-1.10"},
                                   {"title", "optical depths of the air by g-point"},
                                   {"light", is_solar ? "solar" : "longwave"},
                                   {"source", data.source},
                                   {"history", data.history}});
  std::vector<double> point(data.optics.absorption.size()), layer(data.height_m.size() - 1);
  for (std::size_t g = 0; g < point.size(); ++g) point[g] = static_cast<double>(g);
  for (std::size_t n = 0; n < layer.size(); ++n) layer[n] = (data.height_m[n] + data.height_m[n + 1]) / 2;
  netcdf4::write_coordinate(file, point_name, point, {{"units", "1"}, {"long_name", "number of the g-point"}});
  netcdf4::write_coordinate(file, edge_name, data.height_m,
                            {{"units", "m"}, {"long_name", "height of the interfaces"}, {"standard_name", "height"}});
  netcdf4::write_coordinate(file, layer_name, layer, {{"units", "m"}, {"long_name", "height of the layers' middle"}});
  const auto write = [&](const char* name, const std::vector<std::string>& dimensions, const std::vector<double>& value,
                         const char* units, const char* long_name) {
    netcdf4::write_variable(file, name, dimensions, std::span(value), {{"units", units}, {"long_name", long_name}});
  };
  write("pressure", {edge_name}, data.pressure_pa, "Pa", "pressure of the air");
  write("temperature", {edge_name}, data.temperature_k, "K", "temperature of the air");
  write("absorption_optical_depth", {point_name, layer_name}, joined(data.optics.absorption), "1",
        "vertical optical depth of absorption");
  if (is_solar) {
    write("rayleigh_optical_depth", {point_name, layer_name}, joined(data.optics.rayleigh), "1",
          "vertical optical depth of Rayleigh scattering");
    write("solar_share", {point_name}, data.solar_share, "1", "share of the total solar irradiance");
  } else {
    write("planck_radiance", {point_name, edge_name}, joined(data.planck), "W m-2 sr-1",
          "radiance of a black body with the temperature of the interface");
  }
  hdf5::finish_file(file);
}

}  // namespace

void write_gas_optics(const std::filesystem::path& file, const GasOpticsData& data) {
  assert(data.height_m.size() >= 2 && !data.optics.absorption.empty());
  AtomicFile target(file);
  try {
    write_all(target.temporary(), data);
  } catch (const hdf5::Error& error) {
    throw_unwritable(file, error.what());
  }
  target.commit();
}

}  // namespace cloudbow
