#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "app/scene/scene_reader.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "cloudbow/io/phase_set_file.hpp"
#include "cloudbow/medium/cloud_amounts.hpp"
#include "cloudbow/medium/plausibility.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "cloudbow/optics/rayleigh.hpp"

namespace cloudbow {
namespace {

constexpr NumberRange asymmetry{"-1 < g < 1", -1, 1, false, false};

/// By radius of the table.
std::vector<BulkOptics> visible_optics(const BulkTable& table) {
  const double wavenumber = 1e4 / SceneCloud::visible_um;
  const std::array<double, 2> about{wavenumber - 1, wavenumber + 1}, weight{1, 1};
  return average_over(table, about, weight);
}

double visible_extinction(const BulkTable& table, double effective_radius_um) {
  return at_radius(table, visible_optics(table), effective_radius_um).extinction_m2_per_g;
}

}  // namespace

void SceneReader::read_phase_functions() {
  defined_.emplace("isotropic", DefinedPhaseFunction{PhaseFunction::isotropic()});
  defined_.emplace("rayleigh", DefinedPhaseFunction{PhaseFunction::rayleigh()});
  const auto table = root_.find_table("phase_function");
  if (!table) return;
  for (const std::string& name : root_.find("phase_function")->keys) {
    const ConfigReader reader = *table->find_table(name);
    if (defined_.count(name) != 0) table->fail(name, "already defined", name, "a name that is not built in");
    defined_.emplace(name, read_phase_function(name, reader));
  }
}

SceneReader::DefinedPhaseFunction SceneReader::read_phase_function(const std::string& name,
                                                                   const ConfigReader& reader) {
  const std::string type = reader.text("type");
  if (type == "isotropic" || type == "rayleigh") {
    reader.check_keys({"type"});
    return {type == "isotropic" ? PhaseFunction::isotropic() : PhaseFunction::rayleigh()};
  }
  if (type == "henyey-greenstein") {
    reader.check_keys({"type", "asymmetry_parameter"});
    return {PhaseFunction::henyey_greenstein(reader.number("asymmetry_parameter", asymmetry, at_))};
  }
  if (type == "double-henyey-greenstein") {
    reader.check_keys({"type", "forward_asymmetry_parameter", "backward_asymmetry_parameter", "forward_weight"});
    return {PhaseFunction::double_henyey_greenstein(reader.number("forward_asymmetry_parameter", asymmetry, at_),
                                                    reader.number("backward_asymmetry_parameter", asymmetry, at_),
                                                    reader.number("forward_weight", fraction, at_))};
  }
  if (type == "legendre") return read_legendre(reader);
  if (type == "table") {
    reader.check_keys({"type", "file"});
    return read_function_file(reader, read_phase_table_file);
  }
  if (type == "mie") return read_mie(reader);
  if (type == "set") return read_set(reader);
  if (type == "bulk") return read_bulk(name, reader);
  reader.fail("type", "not one of the choices", fmt::format("\"{}\"", type),
              "isotropic, rayleigh, henyey-greenstein, double-henyey-greenstein, legendre, table, mie, set, bulk");
}

SceneReader::DefinedPhaseFunction SceneReader::read_legendre(const ConfigReader& reader) {
  reader.check_keys({"type", "moments", "file"});
  if (reader.has("moments") == reader.has("file")) {
    reader.fail(reader.has("file") ? "file" : "moments", "moments = [...] and file exclude each other",
                reader.has("file") ? "both" : "neither", "one of the two");
  }
  if (reader.has("file")) return read_function_file(reader, read_legendre_file);
  const auto moments = *reader.find_numbers("moments", {"chi_0 = 1, then -1 to 1, without the factor 2l+1", -1, 1});
  std::optional<PhaseFunction> function;
  reader.with_place("moments", [&] {
    function = PhaseFunction::legendre(moments);
    const std::string told = check_not_negative(moments);
    if (!told.empty()) note(reader, "moments", std::span(&told, 1));
  });
  return {*function, true};
}

SceneReader::DefinedPhaseFunction SceneReader::read_function_file(
    const ConfigReader& reader, PhaseFunctionFile (*reader_of_file)(const std::filesystem::path&)) {
  const auto file = existing_file(reader, "file");
  std::optional<PhaseFunctionFile> found;
  reader.with_place("file", [&] { found = reader_of_file(file); });
  note(reader, "file", found->notes);
  return {found->function, true};
}

SceneReader::DefinedPhaseFunction SceneReader::read_mie(const ConfigReader& reader) {
  reader.check_keys({"type", "file", "wavelength_um", "effective_radius_um", "relative_humidity_percent"});
  const auto file = existing_spectral_file(reader, "file");
  auto wavelength = reader.find_number("wavelength_um", positive, at_);
  if (!wavelength) wavelength = scene_.wavelength_um;
  // Extinction and absorption of one wavelength are wrong at most g-points: nobody gets them without asking.
  if (!wavelength && scene_.broadband)
    reader.fail_missing("wavelength_um", "type = \"bulk\", or the wavelength of the table that holds for all g-points");
  DefinedPhaseFunction defined;
  defined.measured = true;
  defined.effective_radius_um = reader.find_number("effective_radius_um", positive);
  const auto humidity = reader.find_number("relative_humidity_percent", {"0 to 100", 0, 100});
  if (humidity && defined.effective_radius_um)
    reader.fail("relative_humidity_percent", "chooses the row of a table as effective_radius_um does", "both",
                "one of the two");
  reader.with_place("file", [&] {
    defined.droplets = std::make_shared<const DropletTable>(read_droplet_table(file, wavelength, humidity));
  });
  if (humidity) defined.effective_radius_um = defined.droplets->effective_radius_um.front();
  defined.by_humidity = humidity.has_value();
  note(reader, "file", defined.droplets->notes);
  if (defined.effective_radius_um) {
    reader.with_place("effective_radius_um", [&] { mixture_for(*defined.droplets, *defined.effective_radius_um); });
  }
  return defined;
}

SceneReader::DefinedPhaseFunction SceneReader::read_set(const ConfigReader& reader) {
  reader.check_keys({"type", "file", "index_grid"});
  auto set = std::make_shared<ScenePhaseSet>();
  set->file = existing_file(reader, "file");
  set->index_grid = reader.find_text("index_grid").value_or("phase_index");
  reader.with_place("file", [&] {
    PhaseSetFile found = read_phase_set_file(set->file, MomentFactor::excluded);
    if (!found.note.empty()) note(reader, "file", std::span(&found.note, 1));
    for (auto& moments : found.moments) set->function.push_back(PhaseFunction::legendre(std::move(moments)));
  });
  DefinedPhaseFunction defined;
  defined.measured = true;
  defined.set = std::move(set);
  return defined;
}

const std::pair<const std::string, SceneReader::DefinedPhaseFunction>& SceneReader::find_phase_function(
    const ConfigReader& reader) const {
  const std::string name = reader.text("phase_function");
  const auto defined = defined_.find(name);
  if (defined == defined_.end()) {
    std::string names;
    for (const auto& [known, function] : defined_) names += (names.empty() ? "" : ", ") + known;
    reader.fail("phase_function", "no phase function of this name", fmt::format("\"{}\"", name),
                names + ", or any other with its own [phase_function.NAME]");
  }
  return *defined;
}

int SceneReader::add_phase_function(const std::string& name, const PhaseFunction& function, bool measured) {
  const auto used = std::find_if(
      scene_.phase_functions.begin(), scene_.phase_functions.end(),
      [&](const ScenePhaseFunction& phase) { return phase.name == name && phase.function.key() == function.key(); });
  if (used != scene_.phase_functions.end()) return static_cast<int>(used - scene_.phase_functions.begin());
  scene_.phase_functions.push_back({name, function, measured});
  return static_cast<int>(scene_.phase_functions.size()) - 1;
}

void SceneReader::read_cloud_optics(const ConfigReader& reader, SceneCloud& cloud) {
  const auto& [name, defined] = find_phase_function(reader);
  if (defined.droplets == nullptr) {
    if (cloud.effective_radius_um && doubt_effective_radius(*cloud.effective_radius_um, *cloud.effective_radius_um)) {
      reader.fail("effective_radius_um", "no radius of droplets", fmt::format("{}", *cloud.effective_radius_um),
                  fmt::format("{} to {} um", smallest_effective_radius_um, largest_effective_radius_um));
    }
    if (cloud.single_scattering_albedo_grid.empty()) {
      cloud.single_scattering_albedo = reader.number("single_scattering_albedo", fraction, at_);
    }
    if (defined.set != nullptr) {
      cloud.phase_set = defined.set;
      return;
    }
    cloud.phase_function = add_phase_function(name, *defined.function, defined.measured);
    return;
  }
  if (defined.by_humidity && (cloud.effective_radius_um || !cloud.effective_radius_grid.empty())) {
    reader.fail(cloud.effective_radius_um ? "effective_radius_um" : "effective_radius_grid",
                "the table of the phase function has one row, for its humidity", "a radius", "no such key");
  }
  cloud.single_scattering_albedo = reader.find_number("single_scattering_albedo", fraction, at_);
  const std::string of_function = fmt::format("phase_function.{}.effective_radius_um", name);
  if (!cloud.effective_radius_grid.empty()) {
    if (defined.effective_radius_um) {
      reader.fail("effective_radius_grid", "excludes " + of_function, "both", "one of the two");
    }
    cloud.droplets = defined.droplets;
    return;
  }
  if (cloud.effective_radius_um && defined.effective_radius_um &&
      *cloud.effective_radius_um != *defined.effective_radius_um) {
    reader.fail("effective_radius_um", "not that of the phase function", fmt::format("{}", *cloud.effective_radius_um),
                fmt::format("{}, as {} says, or one of the two keys", *defined.effective_radius_um, of_function));
  }
  const auto radius = cloud.effective_radius_um ? cloud.effective_radius_um : defined.effective_radius_um;
  if (!radius) {
    reader.fail_missing("effective_radius_um",
                        fmt::format("effective_radius_um or effective_radius_grid, or {}", of_function));
  }
  reader.with_place(cloud.effective_radius_um ? "effective_radius_um" : "phase_function", [&] {
    if (defined.bulk) {
      const BulkOptics optics = at_radius(*defined.bulk->table, defined.bulk->by_radius, *radius);
      cloud.extinction_m2_per_g = optics.extinction_m2_per_g;
      cloud.relative_extinction = optics.extinction_m2_per_g / visible_extinction(*defined.bulk->table, *radius);
      cloud.effective_radius_um = radius;
      if (!cloud.single_scattering_albedo) cloud.single_scattering_albedo = optics.single_scattering_albedo;
      cloud.phase_function = add_phase_function(name, PhaseFunction::henyey_greenstein(optics.asymmetry), false);
      return;
    }
    const DropletOptics optics = droplet_optics(*defined.droplets, *radius);
    cloud.extinction_m2_per_g = optics.extinction_m2_per_g;
    if (!defined.by_humidity) cloud.effective_radius_um = radius;
    if (!cloud.single_scattering_albedo) cloud.single_scattering_albedo = optics.single_scattering_albedo;
    cloud.phase_function = add_phase_function(name, optics.phase_function, true);
  });
}

void SceneReader::read_cloud_fields() {
  if (!scene_.output.optical_depth && !scene_.output.extinction) return;
  const char* const name = scene_.output.optical_depth ? "optical_depth" : "extinction";
  if (scene_.clouds.empty()) {
    throw InputError(
        fmt::format("{}: {} is that of the cloud alone (found no [cloud], allowed a scene that has one); leave "
                    "it out: layers have the optical_depth of [[layer]]",
                    scene_.where("output.fields"), name));
  }
  const std::vector<ConfigReader> tables = cloud_tables();
  for (std::size_t n = 0; n < tables.size(); ++n) {
    const DefinedPhaseFunction& defined = find_phase_function(tables[n]).second;
    SceneCloud& cloud = scene_.clouds[n];
    if (cloud.droplets == nullptr || !defined.bulk) continue;
    try {
      for (const BulkOptics& optics : visible_optics(*defined.bulk->table))
        cloud.visible_m2_per_g.push_back(optics.extinction_m2_per_g);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {} is that at {} um: {}", scene_.where("output.fields"), name,
                                   SceneCloud::visible_um, error.what()));
    }
  }
}

void SceneReader::read_layer_optics(const ConfigReader& reader, Layer& layer) {
  const auto& [name, defined] = find_phase_function(reader);
  if (defined.set != nullptr) {
    reader.fail("phase_function", "a set, which only a cloud's voxels can choose from", fmt::format("\"{}\"", name),
                "a single phase function");
  }
  if (defined.droplets == nullptr) {
    layer.single_scattering_albedo = reader.number("single_scattering_albedo", fraction, at_);
    layer.phase_function = add_phase_function(name, *defined.function, defined.measured);
    return;
  }
  if (!defined.effective_radius_um) {
    reader.fail("phase_function", "a table of droplets without effective radius", fmt::format("\"{}\"", name),
                fmt::format("one with phase_function.{}.effective_radius_um", name));
  }
  const DropletOptics optics = droplet_optics(*defined.droplets, *defined.effective_radius_um);
  layer.single_scattering_albedo =
      reader.find_number("single_scattering_albedo", fraction, at_).value_or(optics.single_scattering_albedo);
  layer.phase_function = add_phase_function(name, optics.phase_function, true);
}

std::vector<ConfigReader> SceneReader::cloud_tables() const {
  const ConfigNode* const clouds = root_.find("cloud");
  if (clouds == nullptr) return {};
  if (clouds->kind == ConfigNode::Kind::array) return root_.tables("cloud");
  return {*root_.find_table("cloud")};
}

std::string SceneReader::read_cloud_name(const ConfigReader& reader) const {
  const bool several = root_.find("cloud")->kind == ConfigNode::Kind::array;
  if (!reader.has("name")) {
    if (several) reader.fail_missing("name", "a name of the constituent, such as liquid, ice, rain");
    return "";
  }
  const std::string name = reader.text("name");
  check_name(reader, name);
  const auto same = [&name](const SceneCloud& cloud) { return cloud.name == name; };
  if (std::any_of(scene_.clouds.begin(), scene_.clouds.end(), same))
    reader.fail("name", "already in use", name, "another name, such as liquid, ice, rain");
  return name;
}

void SceneReader::read_grids(const ConfigReader& reader, SceneCloud& cloud) const {
  const ConfigNode* const grid = reader.find("grid");
  if (grid == nullptr) return;
  if (grid->kind != ConfigNode::Kind::array) {
    cloud.read.grid = reader.text("grid");
    return;
  }
  std::vector<std::string> grids = *reader.find_texts("grid");
  for (std::size_t n = 0; n < grids.size(); ++n) {
    if (grids[n].empty()) reader.fail("grid", "empty", "\"\"", "strings that are not empty");
    if (std::find(grids.begin(), grids.begin() + static_cast<std::ptrdiff_t>(n), grids[n]) !=
        grids.begin() + static_cast<std::ptrdiff_t>(n))
      reader.fail("grid", "stands twice in the list", fmt::format("\"{}\"", grids[n]), "each grid once");
  }
  if (grids.empty()) reader.fail("grid", "empty", "[]", "a name, or a list of names");
  cloud.read.grid = grids.front();
  cloud.more_grids.assign(grids.begin() + 1, grids.end());
}

void SceneReader::read_cloud(const ConfigReader& reader) {
  reader.check_keys({"name", "file", "grid", "quantity", "scale", "voxel_size_m", "up_axis", "effective_radius_um",
                     "effective_radius_grid", "single_scattering_albedo", "single_scattering_albedo_grid",
                     "temperature_grid", "phase_function"});
  SceneCloud cloud;
  cloud.key = reader.path();
  cloud.name = read_cloud_name(reader);
  cloud.file = existing_file(reader, "file");
  read_grids(reader, cloud);
  std::vector<std::string> quantities = water_contents();
  quantities.insert(quantities.begin(), "extinction");
  cloud.quantity = reader.find_choice("quantity", quantities).value_or("");
  cloud.read.scale = reader.find_number("scale", positive, at_).value_or(1);
  cloud.read.up_axis = reader.find_choice("up_axis", {"x", "y", "z"}).value_or("z");
  if (const ConfigNode* size = reader.find("voxel_size_m"); size != nullptr && size->kind == ConfigNode::Kind::array) {
    cloud.read.voxel_size_m = reader.find_triple("voxel_size_m", positive);
  } else if (const auto edge = reader.find_number("voxel_size_m", positive)) {
    cloud.read.voxel_size_m = {*edge, *edge, *edge};
  }
  cloud.effective_radius_um = reader.find_number("effective_radius_um", positive);
  if (reader.has("effective_radius_grid")) {
    if (cloud.effective_radius_um) {
      reader.fail("effective_radius_grid", "excludes effective_radius_um", "both", "one of the two");
    }
    cloud.effective_radius_grid = reader.text("effective_radius_grid");
  }
  if (reader.has("single_scattering_albedo_grid")) {
    if (reader.has("single_scattering_albedo")) {
      reader.fail("single_scattering_albedo_grid", "excludes single_scattering_albedo", "both", "one of the two");
    }
    cloud.single_scattering_albedo_grid = reader.text("single_scattering_albedo_grid");
  }
  if (reader.has("temperature_grid")) {
    check_thermal_key(reader, "temperature_grid");
    cloud.temperature_grid = reader.text("temperature_grid");
  }
  read_cloud_optics(reader, cloud);
  for (const char* key : {"file", "quantity", "effective_radius_um", "temperature_grid"}) remember(reader, key);
  scene_.clouds.push_back(std::move(cloud));
}

void SceneReader::read_layer(const ConfigReader& reader) {
  reader.check_keys({"name", "bottom_m", "top_m", "optical_depth", "optical_depth_wavelength_um",
                     "single_scattering_albedo", "phase_function"});
  reader.find_text("name");
  Layer layer;
  layer.bottom_m = reader.number("bottom_m", finite);
  layer.top_m = reader.number("top_m", finite);
  if (layer.top_m <= layer.bottom_m) {
    reader.fail("top_m", "not above bottom_m", fmt::format("{}", layer.top_m), fmt::format("> {}", layer.bottom_m));
  }
  layer.optical_depth = reader.number("optical_depth", not_negative, at_);
  read_layer_optics(reader, layer);
  if (reader.has("optical_depth_wavelength_um")) layer.optical_depth *= rayleigh_ratio(reader, layer);
  for (const char* key : {"bottom_m", "top_m"}) remember(reader, key);
  scene_.layers.push_back(layer);
}

double SceneReader::rayleigh_ratio(const ConfigReader& reader, const Layer& layer) const {
  const char* const key = "optical_depth_wavelength_um";
  const double given_um = reader.number(key, positive);
  if (!scene_.wavelength_um) reader.fail(key, "needs [spectrum]", fmt::format("{}", given_um), "no such key");
  const ScenePhaseFunction& phase = scene_.phase_functions[static_cast<std::size_t>(layer.phase_function)];
  if (phase.function.key() != PhaseFunction::rayleigh().key())
    reader.fail(key, "a law that air alone follows", "phase function " + phase.name, "phase_function = \"rayleigh\"");
  if (reader.find("optical_depth")->kind == ConfigNode::Kind::array)
    reader.fail(key, "excludes a list of optical depths", "both", "one of the two");
  return rayleigh_optical_depth(*scene_.wavelength_um) / rayleigh_optical_depth(given_um);
}

}  // namespace cloudbow
