#include "cloudbow/io/boundary_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "io/hdf5_handle.hpp"
#include "io/open_result.hpp"

namespace cloudbow {
namespace {

using hdf5::attribute_numbers;
using hdf5::exists;
using hdf5::Handle;

std::vector<double> read_coordinate(hid_t file, const char* name) {
  return hdf5::read_all<double>(hdf5::open_dataset(file, name));
}

/// @param path of the file, for messages
SolveCost read_cost(hid_t file, const std::string& path) {
  const Handle group = hdf5::open_group(file, "solver");
  const auto amounts = [&](const char* name, double most) {
    const std::vector<double> value = attribute_numbers(group, name);
    double sum = 0;
    for (const double one : value) {
      sum += one;
      if (one >= 0 && sum <= most) continue;
      throw InputError(fmt::format("{}: attribute {} of /solver is damaged (found {}, allowed 0 to {} in all)", path,
                                   name, one, most));
    }
    return value;
  };
  const auto sum = [&](const char* name, double most) {
    const std::vector<double> value = amounts(name, most);
    return std::accumulate(value.begin(), value.end(), 0.0);
  };
  const auto largest = [&](const char* name, double most) {
    const std::vector<double> value = amounts(name, most);
    return value.empty() ? 0 : *std::max_element(value.begin(), value.end());
  };
  // More than any run takes; an int holds the first.
  constexpr double most_counted = 1e9, most = 1e18;
  SolveCost cost;
  cost.cpu_seconds = sum("cpu_seconds", most);
  cost.wall_seconds = sum("seconds_total", most);
  cost.table_seconds = sum("seconds_tables", most);
  cost.peak_memory_bytes = largest("peak_memory_bytes", most);
  cost.sweeps = static_cast<int>(sum("sweeps", most_counted));
  cost.control_points = static_cast<int>(largest("control_points", most_counted));
  cost.estimated_error = largest("estimated_error", most);
  const std::vector<double> converged = attribute_numbers(group, "converged");
  cost.converged = std::all_of(converged.begin(), converged.end(), [](double one) { return one > 0; });
  return cost;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path.string()), file_(open_result(path)) {}

  BoundaryResult read() const {
    for (const char* name :
         {"x", "y", "z_edge", "upwelling_flux", "downwelling_diffuse_flux", "direct_flux", "summary", "solver"}) {
      if (!exists(file_, name)) fail(fmt::format("it is not a result file of cloudbow run (found no {})", name));
    }
    BoundaryResult result{path_, read_coordinate(file_, "x"), read_coordinate(file_, "y"), {},
                          {},    read_cost(file_, path_)};
    if (result.x_m.empty() || result.y_m.empty()) fail("it holds no column (found an empty coordinate x or y)");
    if (exists(file_, "wavelength")) result.wavelengths_um = read_coordinate(file_, "wavelength");

    const hsize_t levels = check_levels();
    const hsize_t columns = result.x_m.size() * result.y_m.size();
    const Handle summary = hdf5::open_group(file_, "summary");
    const bool emits = exists(file_, "thermal");
    const std::vector<double> reflectance = emits ? shares("upwelling_top") : attribute_numbers(summary, "reflectance");
    const std::vector<double> transmittance =
        emits ? shares("downwelling_bottom") : attribute_numbers(summary, "transmittance");
    const std::size_t wavelengths = std::max<std::size_t>(result.wavelengths_um.size(), 1);
    if (reflectance.size() != wavelengths || transmittance.size() != wavelengths) fail("its summary is damaged");
    const std::vector<hsize_t> shape = {levels, result.y_m.size(), result.x_m.size()};
    for (std::size_t w = 0; w < wavelengths; ++w) {
      BoundaryFluxes fluxes{reflectance[w], transmittance[w], {}, {}};
      const auto plane = [&](const char* name, hsize_t level) {
        return read_plane(name, result.wavelengths_um.empty() ? std::nullopt : std::optional(w), level, shape);
      };
      fluxes.up_at_top = plane("upwelling_flux", levels - 1);
      fluxes.down_at_bottom = plane("downwelling_diffuse_flux", 0);
      const std::vector<double> direct = plane("direct_flux", 0);
      for (std::size_t c = 0; c < columns; ++c) fluxes.down_at_bottom[c] += direct[c];
      result.fluxes.push_back(std::move(fluxes));
    }
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw InputError(fmt::format("{}: {}", path_, problem)); }

  /// Terms of the ledger as fractions of its power, for scenes that emit.
  std::vector<double> shares(const char* term) const {
    const Handle ledger = hdf5::open_group(file_, "ledger");
    const std::vector<double> flux = attribute_numbers(ledger, term), power = attribute_numbers(ledger, "power");
    std::vector<double> share;
    for (std::size_t n = 0; n < std::min(flux.size(), power.size()); ++n)
      share.push_back(power[n] > 0 ? flux[n] / power[n] : 0);
    return share;
  }

  /// Number of levels with fluxes; the first and the last are the domain's.
  hsize_t check_levels() const {
    const std::vector<double> edge = read_coordinate(file_, "z_edge");
    const std::vector<double> level = read_coordinate(file_, exists(file_, "z_flux") ? "z_flux" : "z_edge");
    const hsize_t count = level.size();
    // Copies of the same numbers: no tolerance.
    if (count == 0 || edge.empty() || level.front() > edge.front() || level.back() < edge.back()) {
      fail(
          "its fluxes do not reach from the bottom to the top (run with output.flux_levels = \"all\" or "
          "\"boundaries\")");
    }
    return count;
  }

  std::vector<double> read_plane(const char* name, std::optional<std::size_t> wavelength, hsize_t level,
                                 const std::vector<hsize_t>& shape) const {
    hdf5::Block block{{level, 0, 0}, {1, shape[1], shape[2]}};
    if (wavelength) {
      block.start.insert(block.start.begin(), *wavelength);
      block.size.insert(block.size.begin(), 1);
    }
    const Handle dataset = hdf5::open_dataset(file_, name);
    const std::vector<hsize_t> found = hdf5::shape_of(dataset);
    if (found.size() != block.start.size() || !std::equal(shape.rbegin(), shape.rend(), found.rbegin()))
      fail(fmt::format("{} is damaged (its shape does not fit the coordinates)", name));
    return hdf5::read_block<double>(dataset, block);
  }

  std::string path_;
  Handle file_;
};

}  // namespace

BoundaryResult read_boundary_result(const std::filesystem::path& file) {
  return after_sandbox(file, {.library = "HDF5"}, [&] {
    try {
      return Reader(file).read();
    } catch (const hdf5::Error& error) {
      throw InputError(fmt::format("{}: can't be read ({})", file.string(), error.what()));
    }
  });
}

}  // namespace cloudbow
