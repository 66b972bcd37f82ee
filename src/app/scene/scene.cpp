#include "cloudbow/app/scene.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "app/scene/scene_reader.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {
namespace {

constexpr NumberRange light_range{"0, or 1e-25 to 1e25", 0, most_light};
constexpr NumberRange zenith{"0 <= z < 90: a sun above the horizon", 0, 90, true, false};
constexpr NumberRange sky_temperature{"0 to 400 K, not Celsius", 0, 400};
constexpr int max_vertical_cells = 100000;
constexpr std::size_t max_wavelengths = 1000;

/// Irradiance or radiance, which results hold in float.
std::optional<double> light(const ConfigReader& reader, const std::string& key, SpectralPlace at) {
  const auto value = reader.find_number(key, light_range, at);
  if (value && *value > 0 && *value < least_light)
    reader.fail(key, "out of range", fmt::format("{}", *value), light_range.allowed);
  return value;
}

SceneBroadband read_broadband(const ConfigReader& spectrum, const std::filesystem::path& file) {
  SceneBroadband broadband;
  if (const std::string reason = unreadable_reason(file); !reason.empty())
    spectrum.fail("gas_model", reason, file.string(), "a file that is there and may be read");
  spectrum.with_place("gas_model", [&] { broadband.model = read_gas_model(file); });
  broadband.file = file.filename().string();
  using Method = SceneBroadband::Method;
  const auto method = spectrum.find_choice("method", {"few", "all", "columns"}).value_or("few");
  broadband.method = method == "few" ? Method::few : method == "all" ? Method::all : Method::columns;
  for (const char* key : {"few_tolerance", "few_points"}) {
    if (spectrum.has(key) && broadband.method != Method::few)
      spectrum.fail(key, "a setting of method = \"few\"", method, "no such key, or \"few\"");
  }
  broadband.few_tolerance =
      spectrum.find_number("few_tolerance", {"1e-6 to .1", 1e-6, .1}).value_or(broadband.few_tolerance);
  broadband.few_points = spectrum.find_integer("few_points", 1, broadband.model->points()).value_or(0);
  return broadband;
}

/// `[spectrum]`; nothing without it.
SceneSpectrum read_spectrum(const ConfigReader& root, const std::filesystem::path& folder) {
  const auto spectrum = root.find_table("spectrum");
  if (!spectrum) return {};
  spectrum->check_keys({"wavelengths_um", "gas_model", "method", "few_tolerance", "few_points"});
  if (spectrum->has("gas_model")) {
    if (spectrum->has("wavelengths_um"))
      spectrum->fail("gas_model", "stands beside `wavelengths_um`", "both", "one of the two");
    SceneSpectrum points;
    points.gas_file = folder / spectrum->text("gas_model");
    points.broadband = read_broadband(*spectrum, points.gas_file);
    return points;
  }
  for (const char* key : {"method", "few_tolerance", "few_points"}) {
    if (!spectrum->has(key)) continue;
    spectrum->fail(key, "a setting of gas_model",
                   spectrum->has("wavelengths_um") ? "wavelengths alone" : "no gas_model", "no such key, or gas_model");
  }
  const auto wavelengths = spectrum->find_numbers("wavelengths_um", positive);
  if (!wavelengths) spectrum->fail_missing("wavelengths_um", "a list of wavelengths > 0, or gas_model");
  if (wavelengths->empty() || wavelengths->size() > max_wavelengths) {
    spectrum->fail("wavelengths_um", "empty or too long", fmt::format("{} wavelengths", wavelengths->size()),
                   fmt::format("1 to {}", max_wavelengths));
  }
  // The wavelengths are a coordinate of the result. Readers search it, so it must be monotonic.
  const bool ascend =
      std::adjacent_find(wavelengths->begin(), wavelengths->end(), std::greater_equal<>()) == wavelengths->end();
  const bool descend =
      std::adjacent_find(wavelengths->begin(), wavelengths->end(), std::less_equal<>()) == wavelengths->end();
  if (!ascend && !descend) {
    spectrum->fail("wavelengths_um", "neither ascending nor descending", describe(*spectrum->find("wavelengths_um")),
                   "each wavelength once, in one of the two orders");
  }
  SceneSpectrum at_wavelengths;
  at_wavelengths.wavelengths_um = *wavelengths;
  return at_wavelengths;
}

}  // namespace

Scene SceneReader::read() {
  root_.check_keys({"title", "cloud", "phase_function", "layer", "domain", "sun", "sky", "surface", "solver",
                    "radiance", "camera", "spectrum", "output", "atmosphere", "thermal"});
  scene_.title = root_.find_text("title").value_or(scene_.path.stem().string());
  if (const auto atmosphere = root_.find_table("atmosphere")) read_atmosphere_table(*atmosphere);
  if (const auto thermal = root_.find_table("thermal")) read_thermal(*thermal);
  read_phase_functions();
  for (const ConfigReader& cloud : cloud_tables()) read_cloud(cloud);
  for (const ConfigReader& layer : root_.tables("layer")) read_layer(layer);
  if (const auto domain = root_.find_table("domain")) read_domain(*domain);
  if (const auto sun = root_.find_table("sun")) read_sun(*sun);
  if (const auto sky = root_.find_table("sky")) read_sky(*sky);
  if (const auto surface = root_.find_table("surface")) read_surface(*surface);
  if (const auto solver = root_.find_table("solver")) read_solver(*solver);
  for (const ConfigReader& radiance : root_.tables("radiance")) read_radiance(radiance);
  for (const ConfigReader& camera : root_.tables("camera")) read_camera(camera);
  if (const auto output = root_.find_table("output")) read_output(*output);
  check_whole();
  return std::move(scene_);
}

std::filesystem::path SceneReader::relative_to_scene(const std::string& file) const {
  return scene_.path.parent_path() / std::filesystem::path(file);
}

std::filesystem::path SceneReader::existing_file(const ConfigReader& reader, const std::string& key) {
  return existing_file(reader, key, reader.text(key));
}

std::filesystem::path SceneReader::existing_file(const ConfigReader& reader, const std::string& key,
                                                 const std::string& name) {
  const std::filesystem::path file = relative_to_scene(name);
  if (const std::string reason = unreadable_reason(file); !reason.empty())
    reader.fail(key, reason, file.string(), "a file that is there and may be read");
  scene_.inputs.push_back(file);
  return file;
}

std::filesystem::path SceneReader::existing_spectral_file(const ConfigReader& reader, const std::string& key) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : reader.spectral_texts(key, at_)) files.push_back(existing_file(reader, key, name));
  return files.size() == 1 ? files.front() : files[at_.index];
}

void SceneReader::remember(const ConfigReader& reader, const std::string& key) {
  scene_.place[reader.full_name(key)] = reader.place_of(key);
}

void SceneReader::note(const ConfigReader& reader, const std::string& key, std::span<const std::string> notes) {
  for (const std::string& note : notes)
    scene_.notes.push_back(fmt::format("{}: {}: {}", reader.place_of(key), reader.full_name(key), note));
}

void SceneReader::read_domain(const ConfigReader& reader) {
  reader.check_keys({"boundary", "min_m", "max_m", "vertical_cells"});
  SceneDomain& domain = scene_.domain;
  domain.periodic = reader.find_choice("boundary", {"periodic", "open"}).value_or("periodic") == "periodic";
  domain.min_m = reader.find_triple("min_m", finite);
  domain.max_m = reader.find_triple("max_m", finite);
  if (domain.min_m && domain.max_m) {
    for (int axis = 0; axis < 3; ++axis) {
      if ((*domain.max_m)[axis] <= (*domain.min_m)[axis]) {
        reader.fail("max_m", fmt::format("not above min_m in {}", "xyz"[axis]),
                    fmt::format("{}", (*domain.max_m)[axis]), fmt::format("> {}", (*domain.min_m)[axis]));
      }
    }
  }
  domain.vertical_cells = reader.find_integer("vertical_cells", 1, max_vertical_cells).value_or(0);
  if (domain.vertical_cells > 0 && !scene_.clouds.empty()) {
    reader.fail("vertical_cells", "only for scenes without [cloud]", std::to_string(domain.vertical_cells),
                "no such key: the cloud's voxels give the levels");
  }
  for (const char* key : {"min_m", "max_m"}) remember(reader, key);
}

// Counter-clockwise from +x, from whichever of the two keys is there.
std::optional<double> SceneReader::read_azimuth(const ConfigReader& reader) {
  const auto azimuth = reader.find_number("azimuth_deg", finite);
  const auto bearing = reader.find_number("bearing_deg", finite);
  if (azimuth && bearing) reader.fail("bearing_deg", "excludes azimuth_deg", "both", "one of the two");
  if (bearing) return 90 - *bearing;
  return azimuth;
}

void SceneReader::read_sun(const ConfigReader& reader) {
  reader.check_keys({"zenith_deg", "azimuth_deg", "bearing_deg", "irradiance_w_m2"});
  SceneSun sun;
  sun.zenith_deg = reader.number("zenith_deg", zenith);
  const auto azimuth = read_azimuth(reader);
  if (!azimuth) {
    reader.fail("azimuth_deg", "missing", "neither azimuth_deg nor bearing_deg",
                "one of the two: azimuth_deg counter-clockwise from +x, or bearing_deg clockwise from +y");
  }
  sun.azimuth_deg = *azimuth;
  const auto irradiance = light(reader, "irradiance_w_m2", at_);
  if (scene_.broadband) {
    const GasModel& model = *scene_.broadband->model;
    if (model.light() != GasModel::Light::solar) {
      throw InputError(fmt::format(
          "{}: sun: stands beside a longwave gas model (found {}, allowed one of sunlight, or a scene without [sun])",
          root_.place_of("sun"), scene_.broadband->file));
    }
    if (!irradiance) reader.fail_missing("irradiance_w_m2", "the total solar irradiance in W m-2, such as 1361");
    if (*irradiance == 0)
      reader.fail("irradiance_w_m2", "no light", "0", "> 0, the total solar irradiance in W m-2, such as 1361");
    sun.irradiance_w_m2 = *irradiance * model.solar_share(scene_.gas_point);
    if (sun.irradiance_w_m2 >= least_light) scene_.sun = sun;
    return;
  }
  if (scene_.thermal) {
    // A sun of 1 beside emission would be a wrong number.
    const std::string units = scene_.thermal->flux_units();
    if (!irradiance) {
      reader.fail_missing("irradiance_w_m2",
                          fmt::format("the irradiance in {}, the unit of what [thermal] emits", units));
    }
    const std::string told = fmt::format("taken in {}, the unit of what [thermal] emits", units);
    if (*irradiance > 0) note(reader, "irradiance_w_m2", std::span(&told, 1));
  }
  sun.irradiance_w_m2 = irradiance.value_or(1);
  if (sun.irradiance_w_m2 > 0) scene_.sun = sun;
}

void SceneReader::read_sky(const ConfigReader& reader) {
  reader.check_keys({"radiance_w_m2_sr", "temperature_k"});
  if (scene_.broadband && reader.has("radiance_w_m2_sr")) {
    reader.fail("radiance_w_m2_sr", "has no spectrum", describe(*reader.find("radiance_w_m2_sr")),
                "no such key with spectrum.gas_model, or temperature_k");
  }
  scene_.sky_radiance = light(reader, "radiance_w_m2_sr", at_).value_or(0);
  if (!reader.has("temperature_k")) return;
  check_thermal_key(reader, "temperature_k");
  if (reader.has("radiance_w_m2_sr"))
    reader.fail("temperature_k", "excludes radiance_w_m2_sr", "both", "one of the two");
  scene_.sky_temperature_k = reader.number("temperature_k", sky_temperature);
  const double radiance = scene_.thermal->planck(*scene_.sky_temperature_k);
  scene_.sky_radiance = radiance < least_light ? 0 : radiance;
}

namespace {

/// Keys of each type of surface, beside those of all.
constexpr std::array<std::pair<std::string_view, std::array<const char*, 4>>, 4> surface_keys{
    {{"lambertian", {"albedo", "albedo_map", "spectral_albedo"}},
     {"rpv", {"rho0", "k", "theta", "rho_c"}},
     {"ross-li", {"f_iso", "f_vol", "f_geo"}},
     {"cox-munk", {"wind_speed_m_s", "refractive_index"}}}};

void check_surface_keys(const ConfigReader& reader, const std::string& type) {
  std::vector<std::string> own;
  for (const auto& [name, keys] : surface_keys) {
    if (name == type) std::copy_if(keys.begin(), keys.end(), std::back_inserter(own), [](auto key) { return key; });
  }
  for (const auto& [name, keys] : surface_keys) {
    for (const char* key : keys) {
      if (name == type || key == nullptr || !reader.has(key)) continue;
      reader.fail(key, fmt::format("a key of the type \"{}\"", name), fmt::format("type = \"{}\"", type),
                  fmt::format("beside it {}; leave {} out", fmt::join(own, ", "), key));
    }
  }
  own.insert(own.end(), {"type", "slope_deg", "aspect_deg", "temperature_k", "temperature_map"});
  reader.check_keys(own);
}

}  // namespace

void SceneReader::read_surface(const ConfigReader& reader) {
  const std::string type =
      reader.find_choice("type", {"lambertian", "rpv", "ross-li", "cox-munk"}).value_or("lambertian");
  check_surface_keys(reader, type);
  Surface& surface = scene_.surface;
  surface.tilt.slope_deg = reader.find_number("slope_deg", {"0 to 89", 0, 89}).value_or(0);
  surface.tilt.aspect_deg = reader.find_number("aspect_deg", finite).value_or(0);
  if (type == "lambertian") {
    surface.albedo = reader.find_number("albedo", fraction, at_).value_or(0);
    if (reader.has("spectral_albedo")) surface.albedo = read_spectral_albedo_key(reader);
    if (reader.has("albedo_map")) read_albedo_map_key(reader);
    if (surface.tilt.slope_deg > 0) surface.brdf = SurfaceBrdf::lambertian(surface.albedo);
  } else if (type == "rpv") {
    const double rho0 = reader.number("rho0", not_negative, at_);
    surface.brdf = SurfaceBrdf::rpv(rho0, reader.number("k", positive, at_),
                                    reader.number("theta", {"between -1 and 1", -1, 1, false, false}, at_),
                                    reader.find_number("rho_c", not_negative, at_).value_or(rho0));
  } else if (type == "ross-li") {
    surface.brdf = SurfaceBrdf::ross_li(reader.number("f_iso", not_negative, at_), reader.number("f_vol", finite, at_),
                                        reader.number("f_geo", finite, at_));
  } else if (type == "cox-munk") {
    surface.brdf = SurfaceBrdf::cox_munk(
        reader.number("wind_speed_m_s", {"0 to 50", 0, 50}),
        reader.find_number("refractive_index", {"above 1, below 10", 1, 10, false, false}, at_).value_or(1.34));
  } else {
    throw std::logic_error("no keys of the surface type " + type);
  }
  read_surface_temperature(reader);
}

void SceneReader::read_albedo_map_key(const ConfigReader& reader) {
  const std::string file = reader.spectral_texts("albedo_map", at_).front();
  if (reader.has("albedo")) reader.fail("albedo_map", "stands beside `albedo`", file, "one of the two");
  if (scene_.surface.tilt.slope_deg > 0) reader.fail("albedo_map", "stands beside `slope_deg`", file, "one of the two");
  if (scene_.clouds.empty()) {
    reader.fail("albedo_map", "needs a cloud, whose columns it covers", file, "`albedo` over layers alone");
  }
  scene_.albedo_map = existing_spectral_file(reader, "albedo_map");
  remember(reader, "albedo_map");
}

void SceneReader::check_whole() {
  if (scene_.broadband) {
    remember(*root_.find_table("spectrum"), "gas_model");
    check_broadband();
    remember(root_, "atmosphere");
    scene_.broadband->molecules_phase_function = add_phase_function("rayleigh", PhaseFunction::rayleigh(), false);
  }
  if (scene_.clouds.empty() && scene_.layers.empty() && !scene_.broadband) {
    throw InputError(
        fmt::format("{}: nothing that light could meet (found neither [cloud] nor [[layer]], allowed one or both)",
                    scene_.path.string()));
  }
  if (!scene_.sun && scene_.sky_radiance <= 0 && !scene_.thermal && !scene_.broadband) {
    throw InputError(fmt::format(
        "{}: no light (found neither [sun] nor [sky] that shines, nor [thermal], allowed one or more of them)",
        scene_.path.string()));
  }
  check_emission();
  read_cloud_fields();
  check_bands();
}

std::string Scene::where(const std::string& key) const {
  const auto known = place.find(key);
  return fmt::format("{}: {}", known == place.end() ? path.string() : known->second, key);
}

std::vector<Scene> read_scenes(const std::filesystem::path& path, std::span<const std::string> overrides) {
  const ConfigTree tree = read_config(path, overrides);
  const SceneSpectrum spectrum = read_spectrum(ConfigReader(tree.root, ""), path.parent_path());
  std::vector<Scene> scenes;
  for (std::size_t n = 0; n < spectrum.size(); ++n) scenes.push_back(SceneReader(tree, path, spectrum, n).read());
  return scenes;
}

Scene read_scene(const std::filesystem::path& path, std::span<const std::string> overrides) {
  return std::move(read_scenes(path, overrides).front());
}

}  // namespace cloudbow
