#include "cloudbow/io/droplet_table_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <fstream>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/file_library_lock.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "io/droplet_table_readers.hpp"
#include "io/netcdf4_file.hpp"

namespace cloudbow {

namespace {

constexpr const char* wavelength_name = "wavelength";
constexpr const char* radius_name = "effective_radius";
constexpr const char* extinction_name = "extinction_per_water_content";
constexpr const char* albedo = "single_scattering_albedo";
constexpr const char* moments_name = "legendre_moment";
constexpr std::size_t largest_table = std::size_t{1} << 27;  // values

/// Numbers of all tables, one after the other.
template <class Numbers>
auto joined(std::span<const DropletTable> tables, const Numbers& numbers_of) {
  auto all = numbers_of(tables.front());
  for (const DropletTable& table : tables.subspan(1)) {
    const auto numbers = numbers_of(table);
    all.insert(all.end(), numbers.begin(), numbers.end());
  }
  return all;
}

/// Moments of all rows, filled up with zeros.
std::vector<double> moments_of(const DropletTable& table, std::size_t count) {
  std::vector<double> moments(table.size() * count, 0.0);
  for (std::size_t n = 0; n < table.size(); ++n) {
    std::copy(table.moments[n].begin(), table.moments[n].end(),
              moments.begin() + static_cast<std::ptrdiff_t>(n * count));
  }
  return moments;
}

std::vector<float> phase_functions_of(const DropletTable& table, std::span<const double> angle_deg) {
  std::vector<float> phase;
  for (const auto& row : table.moments) {
    const PhaseFunction function = PhaseFunction::legendre(row);
    for (const double a : angle_deg)
      phase.push_back(static_cast<float>(function(std::cos(a * std::numbers::pi / 180))));
  }
  return phase;
}

std::vector<double> asymmetry_of(const DropletTable& table) {
  std::vector<double> asymmetry;
  for (const auto& row : table.moments) asymmetry.push_back(row.size() > 1 ? row[1] : 0);
  return asymmetry;
}

void write_all(const std::filesystem::path& path, std::span<const DropletTable> tables,
               std::span<const DropletTableInfo> infos) {
  const bool spectral = tables.size() > 1;
  const DropletTableInfo& info = infos.front();
  std::vector<double> wavelength, real, imaginary;
  for (std::size_t n = 0; n < tables.size(); ++n) {
    wavelength.push_back(tables[n].wavelength_um);
    real.push_back(infos[n].refractive_index.real());
    imaginary.push_back(infos[n].refractive_index.imag());
  }
  const auto each = [spectral](const std::vector<double>& numbers) {
    return spectral ? netcdf4::AttributeValue(numbers) : netcdf4::AttributeValue(numbers.front());
  };
  const auto dimensions = [spectral](std::vector<std::string> names) {
    if (spectral) names.insert(names.begin(), wavelength_name);
    return names;
  };
  hdf5::Handle file = hdf5::create_file(path);
  netcdf4::write_attributes(
      file, {{"Conventions", "CF-1.10"},
             {"title", spectral ? "scattering by droplets, by wavelength and effective radius"
                                : fmt::format("scattering by droplets at {} um, by effective radius", wavelength[0])},
             {"source", info.source},
             {"history", info.history},
             {"wavelength_um", each(wavelength)},
             {"refractive_index_real", each(real)},
             {"refractive_index_imaginary", each(imaginary)},
             {"refractive_index_source", info.refractive_index_source},
             {"density_g_cm3", info.density_g_cm3},
             {"size_distribution", info.distribution},
             {"effective_variance", info.effective_variance}});

  std::size_t moment_count = 0;
  for (const DropletTable& table : tables) {
    for (const auto& row : table.moments) moment_count = std::max(moment_count, row.size());
  }
  std::vector<double> degree(moment_count);
  for (std::size_t l = 0; l < moment_count; ++l) degree[l] = static_cast<double>(l);
  const std::vector<double> angle = droplet_table_angles();

  if (spectral) {
    netcdf4::write_coordinate(
        file, wavelength_name, wavelength,
        {{"units", "um"}, {"long_name", "wavelength"}, {"standard_name", "radiation_wavelength"}});
  }
  netcdf4::write_coordinate(file, radius_name, tables.front().effective_radius_um,
                            {{"units", "um"}, {"long_name", "effective radius, <r^3>/<r^2>"}});
  netcdf4::write_coordinate(file, "moment", degree, {{"units", "1"}, {"long_name", "degree l of the Legendre moment"}});
  netcdf4::write_coordinate(file, "angle", angle, {{"units", "degree"}, {"long_name", "scattering angle"}});
  const auto write = [&](const char* name, const std::vector<std::string>& names, const auto& numbers_of,
                         const std::vector<netcdf4::Attribute>& attributes) {
    const auto numbers = joined(tables, numbers_of);
    netcdf4::write_variable(file, name, dimensions(names), std::span(numbers), attributes);
  };
  write(extinction_name, {radius_name}, [](const DropletTable& t) { return t.extinction_m2_per_g; },
        {{"units", "m2 g-1"}, {"long_name", "extinction coefficient [m-1] per mass of droplets in air [g m-3]"}});
  write(albedo, {radius_name}, [](const DropletTable& t) { return t.single_scattering_albedo; },
        {{"units", "1"}, {"long_name", "single-scattering albedo"}});
  write("asymmetry_parameter", {radius_name}, asymmetry_of,
        {{"units", "1"}, {"long_name", "mean cosine of the scattering angle"}});
  write(
      moments_name, {radius_name, "moment"}, [&](const DropletTable& t) { return moments_of(t, moment_count); },
      {{"units", "1"}, {"long_name", "chi_l of P(mu) = sum (2l+1) chi_l P_l(mu), without the factor 2l+1; chi_0 = 1"}});
  write("phase_function", {radius_name, "angle"}, [&](const DropletTable& t) { return phase_functions_of(t, angle); },
        {{"units", "1"}, {"long_name", "phase function, mean over the sphere 1"}});
  hdf5::finish_file(file);
}

/// One wavelength of several.
struct WavelengthIndex {
  hsize_t index;
  hsize_t count;
};

/// @param rows 0: any length.
/// @param at the wavelength to read, if the variable has a dimension `wavelength`, which comes first.
std::vector<double> read_values(hid_t file, const char* name, std::size_t rank, std::size_t rows,
                                std::optional<WavelengthIndex> at = std::nullopt) {
  if (!hdf5::exists(file, name)) {
    throw InputError(fmt::format("no variable '{}' (allowed: a table by cloudbow mie)", name));
  }
  const hdf5::Handle dataset = hdf5::open_dataset(file, name);
  const std::vector<hsize_t> shape = hdf5::shape_of(dataset);
  const std::size_t before = at ? 1 : 0;
  if (shape.size() != rank + before || (at && shape[0] != at->count) || (rows > 0 && shape[before] != rows)) {
    throw InputError(fmt::format("'{}': wrong shape (found {} dimensions, allowed {}{}, the first of them {})", name,
                                 shape.size(), rank + before, at ? " with the wavelength" : "",
                                 at ? at->count : hsize_t{rows}));
  }
  hdf5::Block block{std::vector<hsize_t>(shape.size(), 0), shape};
  if (at) {
    block.start[0] = at->index;
    block.size[0] = 1;
  }
  std::size_t count = 1;
  for (const hsize_t length : block.size) {
    if (length > largest_table / std::max<std::size_t>(count, 1))
      throw InputError(fmt::format("'{}': too large", name));
    count *= length;
  }
  return hdf5::read_block<double>(dataset, block);
}

double read_number_attribute(hid_t file, const char* name) {
  if (!hdf5::has_attribute(file, name)) {
    throw InputError(fmt::format("no attribute '{}' (allowed: a table by cloudbow mie)", name));
  }
  return hdf5::attribute_number(file, name);
}

DropletTable read_own_table(hid_t file, std::optional<double> wavelength_um) {
  DropletTable table;
  std::optional<WavelengthIndex> at;
  if (hdf5::exists(file, wavelength_name)) {
    const std::vector<double> there = read_values(file, wavelength_name, 1, 0);
    at = WavelengthIndex{choose_wavelength(there, wavelength_um), there.size()};
    table.wavelength_um = there[at->index];
  } else {
    table.wavelength_um = read_number_attribute(file, "wavelength_um");
    choose_wavelength(std::span(&table.wavelength_um, 1), wavelength_um);
  }
  table.effective_radius_um = read_values(file, radius_name, 1, 0);
  const std::size_t rows = table.size();
  if (rows == 0) throw InputError("no effective radius (allowed at least one)");
  table.extinction_m2_per_g = read_values(file, extinction_name, 1, rows, at);
  table.single_scattering_albedo = read_values(file, albedo, 1, rows, at);
  const std::vector<double> moments = read_values(file, moments_name, 2, rows, at);
  const auto count = static_cast<std::ptrdiff_t>(moments.size() / rows);
  for (std::size_t n = 0; n < rows; ++n) {
    const auto begin = moments.begin() + static_cast<std::ptrdiff_t>(n) * count;
    auto end = begin + count;
    while (end - begin > 2 && *(end - 1) == 0) --end;
    table.moments.emplace_back(begin, end);
  }
  return table;
}

DropletTable read_hdf5_table(const std::filesystem::path& path, std::optional<double> wavelength_um,
                             std::optional<double> relative_humidity_percent) {
  {
    const hdf5::Handle file = hdf5::open_file(path);
    if (!hdf5::exists(file, "pmom") && !hdf5::exists(file, "wavelen")) {
      refuse_humidity(relative_humidity_percent);
      return read_own_table(file, wavelength_um);
    }
  }
  return read_libradtran_table(path, wavelength_um, relative_humidity_percent);
}

DropletTable read_by_content(const std::filesystem::path& path, std::optional<double> wavelength_um,
                             std::optional<double> relative_humidity_percent) {
  std::ifstream stream = open_input(path, "a table of droplets");
  std::array<char, 512> head{};
  stream.read(head.data(), head.size());
  const std::string_view start(head.data(), static_cast<std::size_t>(stream.gcount()));
  stream.close();
  if (start.starts_with("\x89HDF\r\n\x1a\n")) return read_hdf5_table(path, wavelength_um, relative_humidity_percent);
  if (start.starts_with("CDF")) return read_libradtran_table(path, wavelength_um, relative_humidity_percent);
  if (is_shdom_table(start)) {
    refuse_humidity(relative_humidity_percent);
    DropletTable table = read_shdom_table(path);
    choose_wavelength(std::span(&table.wavelength_um, 1), wavelength_um);
    return table;
  }
  throw InputError(
      "not a table of droplets (allowed: HDF5 by cloudbow mie, netCDF by libRadtran's mie, text by SHDOM's "
      "make_mie_table, whose first line says \"table vs. effective radius\")");
}

}  // namespace

std::vector<double> droplet_table_angles() {
  std::vector<double> angle;
  const auto add = [&angle](double from, double to, int steps) {
    for (int n = 0; n < steps; ++n) angle.push_back(from + (to - from) * n / steps);
  };
  add(0, 1, 50);
  add(1, 5, 40);
  add(5, 20, 60);
  add(20, 130, 110);
  add(130, 150, 80);
  add(150, 175, 50);
  add(175, 180, 50);
  angle.push_back(180);
  return angle;
}

std::size_t choose_wavelength(std::span<const double> there_um, std::optional<double> wanted_um) {
  constexpr double slack = 1e-3;
  if (!wanted_um) {
    if (there_um.size() == 1) return 0;
    throw InputError(fmt::format("{} wavelengths from {} to {} um (found no wavelength_um that chooses one)",
                                 there_um.size(), there_um.empty() ? 0 : there_um.front(),
                                 there_um.empty() ? 0 : there_um.back()));
  }
  std::size_t nearest = 0;
  for (std::size_t n = 1; n < there_um.size(); ++n) {
    if (std::abs(there_um[n] - *wanted_um) < std::abs(there_um[nearest] - *wanted_um)) nearest = n;
  }
  if (there_um.empty() || !(std::abs(there_um[nearest] - *wanted_um) <= slack * *wanted_um)) {
    throw InputError(fmt::format("no such wavelength (found {} um, allowed {} um, the nearest)", *wanted_um,
                                 there_um.empty() ? 0 : there_um[nearest]));
  }
  return nearest;
}

void write_droplet_table(const std::filesystem::path& file, const DropletTable& table, const DropletTableInfo& info) {
  write_droplet_tables(file, std::span(&table, 1), std::span(&info, 1));
}

void write_droplet_tables(const std::filesystem::path& file, std::span<const DropletTable> tables,
                          std::span<const DropletTableInfo> infos) {
  assert(!tables.empty() && tables.size() == infos.size());
  const FileLibraryLock lock;
  AtomicFile target(file);
  try {
    write_all(target.temporary(), tables, infos);
  } catch (const hdf5::Error& error) {
    throw_unwritable(file, error.what());
  }
  target.commit();
}

void refuse_humidity(std::optional<double> relative_humidity_percent) {
  if (!relative_humidity_percent) return;
  throw InputError(fmt::format("a table by effective radius (found relative_humidity_percent {}, allowed no such key)",
                               *relative_humidity_percent));
}

DropletTable read_droplet_table(const std::filesystem::path& file, std::optional<double> wavelength_um,
                                std::optional<double> relative_humidity_percent) {
  return after_sandbox(file, {.library = "HDF5 or netCDF"}, [&] {
    check_input(file, "a table of droplets");
    hdf5::check_file(file);
    try {
      DropletTable table = read_by_content(file, wavelength_um, relative_humidity_percent);
      // The note on a mixture of humidities would name a radius that means nothing; its reader has one on the rows.
      if (std::string note = check_droplet_table(table); !note.empty() && !relative_humidity_percent)
        table.notes.push_back(std::move(note));
      return table;
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    } catch (const hdf5::Error& error) {
      throw InputError(fmt::format("{}: damaged, or not a table ({})", file.string(), error.what()));
    }
  });
}

}  // namespace cloudbow
