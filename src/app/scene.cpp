#include "cloudbow/app/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <numbers>

#include "cloudbow/app/accuracy.hpp"
#include "cloudbow/app/config_reader.hpp"
#include "cloudbow/app/phase_function_file.hpp"
#include "cloudbow/app/phase_set_file.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/rayleigh.hpp"
#include "cloudbow/results/droplet_table_file.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {
namespace {

constexpr NumberRange kAsymmetry{"-1 < g < 1", -1, 1, false, false};
constexpr NumberRange kZenith{"0 <= z < 90: a sun above the horizon", 0, 90, true, false};
constexpr NumberRange kTolerance{"1e-8 to 0.1", 1e-8, 0.1};
constexpr int kMaxVerticalCells = 100000;
constexpr int kMaxPixels = 16384;
constexpr int kMaxRays = 16;
constexpr std::size_t kMaxWavelengths = 1000;

/// Of `[spectrum]`; none without it.
std::vector<double> read_wavelengths(const ConfigReader& root) {
  const auto spectrum = root.find_table("spectrum");
  if (!spectrum) return {};
  spectrum->check_keys({"wavelengths_um"});
  const auto wavelengths = spectrum->find_numbers("wavelengths_um", kPositive);
  if (!wavelengths) spectrum->fail_missing("wavelengths_um", "a list of wavelengths > 0");
  if (wavelengths->empty() || wavelengths->size() > kMaxWavelengths) {
    spectrum->fail("wavelengths_um", "empty or too long", fmt::format("{} wavelengths", wavelengths->size()),
                   fmt::format("1 to {}", kMaxWavelengths));
  }
  // As a coordinate of the result, which readers search, must be.
  const bool ascend =
      std::adjacent_find(wavelengths->begin(), wavelengths->end(), std::greater_equal<>()) == wavelengths->end();
  const bool descend =
      std::adjacent_find(wavelengths->begin(), wavelengths->end(), std::less_equal<>()) == wavelengths->end();
  if (!ascend && !descend) {
    spectrum->fail("wavelengths_um", "neither ascending nor descending", describe(*spectrum->find("wavelengths_um")),
                   "each wavelength once, in one of the two orders");
  }
  return *wavelengths;
}

class SceneReader {
 public:
  SceneReader(const ConfigTree& tree, const std::filesystem::path& path, std::span<const double> wavelengths_um,
              std::size_t wavelength)
      : root_(tree.root, ""), at_{wavelength, wavelengths_um.size()} {
    if (!wavelengths_um.empty()) scene_.wavelength_um = wavelengths_um[wavelength];
    scene_.path = path;
    scene_.inputs.push_back(path);
    scene_.text = tree.text;
  }

  Scene read() {
    root_.check_keys({"title", "cloud", "phase_function", "layer", "domain", "sun", "sky", "surface", "solver",
                      "radiance", "camera", "spectrum", "output"});
    scene_.title = root_.find_text("title").value_or(scene_.path.stem().string());
    read_phase_functions();
    if (const auto cloud = root_.find_table("cloud")) read_cloud(*cloud);
    for (const ConfigReader& layer : root_.tables("layer")) read_layer(layer);
    if (const auto domain = root_.find_table("domain")) read_domain(*domain);
    if (const auto sun = root_.find_table("sun")) read_sun(*sun);
    if (const auto sky = root_.find_table("sky")) {
      sky->check_keys({"radiance_w_m2_sr"});
      scene_.sky_radiance = sky->find_number("radiance_w_m2_sr", kNotNegative, at_).value_or(0);
    }
    if (const auto surface = root_.find_table("surface")) read_surface(*surface);
    if (const auto solver = root_.find_table("solver")) read_solver(*solver);
    for (const ConfigReader& radiance : root_.tables("radiance")) read_radiance(radiance);
    for (const ConfigReader& camera : root_.tables("camera")) read_camera(camera);
    if (const auto output = root_.find_table("output")) read_output(*output);
    check_whole();
    return std::move(scene_);
  }

 private:
  /// A function, or a mie table from which an effective radius makes one, or a set of functions.
  struct DefinedPhaseFunction {
    std::optional<PhaseFunction> function;
    bool measured = false;
    std::shared_ptr<const DropletTable> droplets{};
    std::optional<double> effective_radius_um{};
    std::shared_ptr<const ScenePhaseSet> set{};
  };

  std::filesystem::path relative_to_scene(const std::string& file) const {
    return scene_.path.parent_path() / std::filesystem::path(file);
  }

  std::filesystem::path existing_file(const ConfigReader& reader, const std::string& key) {
    return existing_file(reader, key, reader.text(key));
  }

  std::filesystem::path existing_file(const ConfigReader& reader, const std::string& key, const std::string& name) {
    const std::filesystem::path file = relative_to_scene(name);
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) reader.fail(key, "no such file", file.string(), "a file that is there");
    if (std::filesystem::is_directory(status)) reader.fail(key, "a directory", file.string(), "a file");
    scene_.inputs.push_back(file);
    return file;
  }

  /// The file of this wavelength, of a list with one for each or of one for all.
  std::filesystem::path existing_spectral_file(const ConfigReader& reader, const std::string& key) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : reader.spectral_texts(key, at_)) files.push_back(existing_file(reader, key, name));
    return files.size() == 1 ? files.front() : files[at_.index];
  }

  void remember(const ConfigReader& reader, const std::string& key) {
    scene_.place[reader.full_name(key)] = reader.place_of(key);
  }

  void read_phase_functions() {
    defined_.emplace("isotropic", DefinedPhaseFunction{PhaseFunction::isotropic()});
    defined_.emplace("rayleigh", DefinedPhaseFunction{PhaseFunction::rayleigh()});
    const auto table = root_.find_table("phase_function");
    if (!table) return;
    for (const std::string& name : root_.find("phase_function")->keys) {
      const ConfigReader reader = *table->find_table(name);
      if (defined_.count(name) != 0) table->fail(name, "already defined", name, "a name that is not built in");
      defined_.emplace(name, read_phase_function(reader));
    }
  }

  DefinedPhaseFunction read_phase_function(const ConfigReader& reader) {
    const std::string type = reader.text("type");
    if (type == "isotropic" || type == "rayleigh") {
      reader.check_keys({"type"});
      return {type == "isotropic" ? PhaseFunction::isotropic() : PhaseFunction::rayleigh()};
    }
    if (type == "henyey-greenstein") {
      reader.check_keys({"type", "asymmetry_parameter"});
      return {PhaseFunction::henyey_greenstein(reader.number("asymmetry_parameter", kAsymmetry, at_))};
    }
    if (type == "double-henyey-greenstein") {
      reader.check_keys({"type", "forward_asymmetry_parameter", "backward_asymmetry_parameter", "forward_weight"});
      return {PhaseFunction::double_henyey_greenstein(reader.number("forward_asymmetry_parameter", kAsymmetry, at_),
                                                      reader.number("backward_asymmetry_parameter", kAsymmetry, at_),
                                                      reader.number("forward_weight", kFraction, at_))};
    }
    if (type == "legendre") return read_legendre(reader);
    if (type == "table") return read_table(reader);
    if (type == "mie") return read_mie(reader);
    if (type == "set") return read_set(reader);
    reader.fail("type", "not one of the choices", fmt::format("\"{}\"", type),
                "isotropic, rayleigh, henyey-greenstein, double-henyey-greenstein, legendre, table, mie, set");
  }

  DefinedPhaseFunction read_legendre(const ConfigReader& reader) {
    reader.check_keys({"type", "moments", "file"});
    if (reader.has("moments") == reader.has("file")) {
      reader.fail(reader.has("file") ? "file" : "moments", "moments = [...] and file exclude each other",
                  reader.has("file") ? "both" : "neither", "one of the two");
    }
    std::optional<PhaseFunction> function;
    if (reader.has("file")) {
      const auto file = existing_file(reader, "file");
      reader.with_place("file", [&] { function = read_legendre_file(file); });
    } else {
      const auto moments = *reader.find_numbers("moments", {"chi_0 = 1, then -1 to 1", -1, 1});
      reader.with_place("moments", [&] { function = PhaseFunction::legendre(moments); });
    }
    return {*function, true};
  }

  DefinedPhaseFunction read_table(const ConfigReader& reader) {
    reader.check_keys({"type", "file"});
    const auto file = existing_file(reader, "file");
    std::optional<PhaseFunction> function;
    reader.with_place("file", [&] { function = read_phase_table_file(file); });
    return {*function, true};
  }

  DefinedPhaseFunction read_mie(const ConfigReader& reader) {
    reader.check_keys({"type", "file", "wavelength_um", "effective_radius_um"});
    const auto file = existing_spectral_file(reader, "file");
    auto wavelength = reader.find_number("wavelength_um", kPositive, at_);
    if (!wavelength) wavelength = scene_.wavelength_um;
    DefinedPhaseFunction defined;
    defined.measured = true;
    defined.effective_radius_um = reader.find_number("effective_radius_um", kPositive);
    reader.with_place(
        "file", [&] { defined.droplets = std::make_shared<const DropletTable>(read_droplet_table(file, wavelength)); });
    if (defined.effective_radius_um) {
      reader.with_place("effective_radius_um", [&] { mixture_for(*defined.droplets, *defined.effective_radius_um); });
    }
    return defined;
  }

  DefinedPhaseFunction read_set(const ConfigReader& reader) {
    reader.check_keys({"type", "file", "index_grid"});
    auto set = std::make_shared<ScenePhaseSet>();
    set->file = existing_file(reader, "file");
    set->index_grid = reader.find_text("index_grid").value_or("phase_index");
    reader.with_place("file", [&] {
      for (auto& moments : read_phase_set_file(set->file, MomentFactor::excluded).moments) {
        set->function.push_back(PhaseFunction::legendre(std::move(moments)));
      }
    });
    DefinedPhaseFunction defined;
    defined.measured = true;
    defined.set = std::move(set);
    return defined;
  }

  const std::pair<const std::string, DefinedPhaseFunction>& find_phase_function(const ConfigReader& reader) const {
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

  /// Index in the scene of a function that may already be there.
  int add_phase_function(const std::string& name, const PhaseFunction& function, bool measured) {
    const auto used = std::find_if(
        scene_.phase_functions.begin(), scene_.phase_functions.end(),
        [&](const ScenePhaseFunction& phase) { return phase.name == name && phase.function.key() == function.key(); });
    if (used != scene_.phase_functions.end()) return static_cast<int>(used - scene_.phase_functions.begin());
    scene_.phase_functions.push_back({name, function, measured});
    return static_cast<int>(scene_.phase_functions.size()) - 1;
  }

  /// The cloud's phase function, and what else a mie table tells of its droplets.
  void read_cloud_optics(const ConfigReader& reader, SceneCloud& cloud) {
    const auto& [name, defined] = find_phase_function(reader);
    if (defined.droplets == nullptr) {
      if (cloud.single_scattering_albedo_grid.empty()) {
        cloud.single_scattering_albedo = reader.number("single_scattering_albedo", kFraction, at_);
      }
      if (defined.set != nullptr) {
        cloud.phase_set = defined.set;
        return;
      }
      cloud.phase_function = add_phase_function(name, *defined.function, defined.measured);
      return;
    }
    cloud.single_scattering_albedo = reader.find_number("single_scattering_albedo", kFraction, at_);
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
      reader.fail("effective_radius_um", "not that of the phase function",
                  fmt::format("{}", *cloud.effective_radius_um),
                  fmt::format("{}, as {} says, or one of the two keys", *defined.effective_radius_um, of_function));
    }
    const auto radius = cloud.effective_radius_um ? cloud.effective_radius_um : defined.effective_radius_um;
    if (!radius) {
      reader.fail_missing("effective_radius_um",
                          fmt::format("effective_radius_um or effective_radius_grid, or {}", of_function));
    }
    reader.with_place(cloud.effective_radius_um ? "effective_radius_um" : "phase_function", [&] {
      const DropletOptics optics = droplet_optics(*defined.droplets, *radius);
      cloud.extinction_m2_per_g = optics.extinction_m2_per_g;
      if (!cloud.single_scattering_albedo) cloud.single_scattering_albedo = optics.single_scattering_albedo;
      cloud.phase_function = add_phase_function(name, optics.phase_function, true);
    });
  }

  void read_layer_optics(const ConfigReader& reader, Layer& layer) {
    const auto& [name, defined] = find_phase_function(reader);
    if (defined.set != nullptr) {
      reader.fail("phase_function", "a set, which only a cloud's voxels can choose from", fmt::format("\"{}\"", name),
                  "a single phase function");
    }
    if (defined.droplets == nullptr) {
      layer.single_scattering_albedo = reader.number("single_scattering_albedo", kFraction, at_);
      layer.phase_function = add_phase_function(name, *defined.function, defined.measured);
      return;
    }
    if (!defined.effective_radius_um) {
      reader.fail("phase_function", "a mie table without effective radius", fmt::format("\"{}\"", name),
                  fmt::format("one with phase_function.{}.effective_radius_um", name));
    }
    const DropletOptics optics = droplet_optics(*defined.droplets, *defined.effective_radius_um);
    layer.single_scattering_albedo =
        reader.find_number("single_scattering_albedo", kFraction, at_).value_or(optics.single_scattering_albedo);
    layer.phase_function = add_phase_function(name, optics.phase_function, true);
  }

  void read_cloud(const ConfigReader& reader) {
    reader.check_keys({"file", "grid", "quantity", "scale", "voxel_size_m", "up_axis", "effective_radius_um",
                       "effective_radius_grid", "single_scattering_albedo", "single_scattering_albedo_grid",
                       "phase_function"});
    SceneCloud cloud;
    cloud.file = existing_file(reader, "file");
    if (reader.has("grid")) cloud.read.grid = reader.text("grid");
    cloud.quantity = reader.find_choice("quantity", {"extinction", "liquid_water_content"}).value_or("");
    cloud.read.scale = reader.find_number("scale", kPositive, at_).value_or(1);
    cloud.read.up_axis = reader.find_choice("up_axis", {"x", "y", "z"}).value_or("z");
    if (const ConfigNode* size = reader.find("voxel_size_m");
        size != nullptr && size->kind == ConfigNode::Kind::array) {
      cloud.read.voxel_size_m = reader.find_triple("voxel_size_m", kPositive);
    } else if (const auto edge = reader.find_number("voxel_size_m", kPositive)) {
      cloud.read.voxel_size_m = {*edge, *edge, *edge};
    }
    cloud.effective_radius_um = reader.find_number("effective_radius_um", kPositive);
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
    read_cloud_optics(reader, cloud);
    for (const char* key : {"file", "quantity", "effective_radius_um"}) remember(reader, key);
    scene_.cloud = std::move(cloud);
  }

  void read_layer(const ConfigReader& reader) {
    reader.check_keys({"name", "bottom_m", "top_m", "optical_depth", "optical_depth_wavelength_um",
                       "single_scattering_albedo", "phase_function"});
    reader.find_text("name");
    Layer layer;
    layer.bottom_m = reader.number("bottom_m", kFinite);
    layer.top_m = reader.number("top_m", kFinite);
    if (layer.top_m <= layer.bottom_m) {
      reader.fail("top_m", "not above bottom_m", fmt::format("{}", layer.top_m), fmt::format("> {}", layer.bottom_m));
    }
    layer.optical_depth = reader.number("optical_depth", kNotNegative, at_);
    read_layer_optics(reader, layer);
    if (reader.has("optical_depth_wavelength_um")) layer.optical_depth *= rayleigh_ratio(reader, layer);
    for (const char* key : {"bottom_m", "top_m"}) remember(reader, key);
    scene_.layers.push_back(layer);
  }

  /// Of the optical depths at this wavelength and at that for which the layer gives one.
  double rayleigh_ratio(const ConfigReader& reader, const Layer& layer) const {
    const char* const key = "optical_depth_wavelength_um";
    const double given_um = reader.number(key, kPositive);
    if (!scene_.wavelength_um) reader.fail(key, "needs [spectrum]", fmt::format("{}", given_um), "no such key");
    const ScenePhaseFunction& phase = scene_.phase_functions[static_cast<std::size_t>(layer.phase_function)];
    if (phase.function.key() != PhaseFunction::rayleigh().key())
      reader.fail(key, "a law that air alone follows", "phase function " + phase.name, "phase_function = \"rayleigh\"");
    if (reader.find("optical_depth")->kind == ConfigNode::Kind::array)
      reader.fail(key, "excludes a list of optical depths", "both", "one of the two");
    return rayleigh_optical_depth(*scene_.wavelength_um) / rayleigh_optical_depth(given_um);
  }

  void read_domain(const ConfigReader& reader) {
    reader.check_keys({"boundary", "min_m", "max_m", "vertical_cells"});
    SceneDomain& domain = scene_.domain;
    domain.periodic = reader.find_choice("boundary", {"periodic", "open"}).value_or("periodic") == "periodic";
    domain.min_m = reader.find_triple("min_m", kFinite);
    domain.max_m = reader.find_triple("max_m", kFinite);
    if (domain.min_m && domain.max_m) {
      for (int axis = 0; axis < 3; ++axis) {
        if ((*domain.max_m)[axis] <= (*domain.min_m)[axis]) {
          reader.fail("max_m", fmt::format("not above min_m in {}", "xyz"[axis]),
                      fmt::format("{}", (*domain.max_m)[axis]), fmt::format("> {}", (*domain.min_m)[axis]));
        }
      }
    }
    domain.vertical_cells = reader.find_integer("vertical_cells", 1, kMaxVerticalCells).value_or(0);
    if (domain.vertical_cells > 0 && scene_.cloud) {
      reader.fail("vertical_cells", "only for scenes without [cloud]", std::to_string(domain.vertical_cells),
                  "no such key: the cloud's voxels give the levels");
    }
    for (const char* key : {"min_m", "max_m"}) remember(reader, key);
  }

  // Counter-clockwise from +x, from whichever of the two keys is there.
  static std::optional<double> read_azimuth(const ConfigReader& reader) {
    const auto azimuth = reader.find_number("azimuth_deg", kFinite);
    const auto bearing = reader.find_number("bearing_deg", kFinite);
    if (azimuth && bearing) reader.fail("bearing_deg", "excludes azimuth_deg", "both", "one of the two");
    if (bearing) return 90 - *bearing;
    return azimuth;
  }

  void read_sun(const ConfigReader& reader) {
    reader.check_keys({"zenith_deg", "azimuth_deg", "bearing_deg", "irradiance_w_m2"});
    SceneSun sun;
    sun.zenith_deg = reader.number("zenith_deg", kZenith);
    const auto azimuth = read_azimuth(reader);
    if (!azimuth) {
      reader.fail("azimuth_deg", "missing", "neither azimuth_deg nor bearing_deg",
                  "one of the two: azimuth_deg counter-clockwise from +x, or bearing_deg clockwise from +y");
    }
    sun.azimuth_deg = *azimuth;
    sun.irradiance_w_m2 = reader.find_number("irradiance_w_m2", kNotNegative, at_).value_or(1);
    if (sun.irradiance_w_m2 > 0) scene_.sun = sun;
  }

  /// Of an image, which results and pictures know it by.
  std::string read_image_name(const ConfigReader& reader) const {
    const std::string name = reader.text("name");
    const auto is_word = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
    if (!std::all_of(name.begin(), name.end(), is_word))
      reader.fail("name", "not a name", name, "letters, digits and _");
    const auto same = [&](const auto& other) { return other.name == name; };
    if (name == "field" || std::any_of(scene_.radiances.begin(), scene_.radiances.end(), same) ||
        std::any_of(scene_.cameras.begin(), scene_.cameras.end(), same)) {
      reader.fail("name", "already in use", name, "another name");
    }
    return name;
  }

  void read_radiance(const ConfigReader& reader) {
    reader.check_keys({"name", "zenith_deg", "azimuth_deg", "bearing_deg", "width", "height"});
    SceneRadiance radiance;
    radiance.name = read_image_name(reader);
    radiance.zenith_deg = reader.number("zenith_deg", {"0 to 180 without 89 to 91", 0, 180});
    if (std::abs(radiance.zenith_deg - 90) < 1) {
      reader.fail("zenith_deg", "too near the horizon", fmt::format("{}", radiance.zenith_deg),
                  "0 to 180 without 89 to 91");
    }
    radiance.azimuth_deg = read_azimuth(reader).value_or(0);
    if (reader.has("width") != reader.has("height")) {
      reader.fail_missing(reader.has("width") ? "height" : "width", "width and height, or neither");
    }
    radiance.width = reader.find_integer("width", 1, kMaxPixels).value_or(0);
    radiance.height = reader.find_integer("height", 1, kMaxPixels).value_or(0);
    scene_.radiances.push_back(radiance);
  }

  void read_camera(const ConfigReader& reader) {
    reader.check_keys(
        {"name", "type", "position_m", "look_at_m", "up", "field_of_view_deg", "width", "height", "rays"});
    const std::string name = read_image_name(reader);
    const std::string type = reader.find_choice("type", {"perspective", "fisheye", "panorama"}).value_or("perspective");
    const auto vector = [&](const char* key) -> std::optional<Eigen::Vector3d> {
      const auto triple = reader.find_triple(key, kFinite);
      if (!triple) return std::nullopt;
      return Eigen::Vector3d((*triple)[0], (*triple)[1], (*triple)[2]);
    };
    CameraPlacement placement;
    const auto position = vector("position_m");
    if (!position) reader.fail_missing("position_m", "[x, y, z]");
    placement.position_m = *position;
    const auto look_at = vector("look_at_m");
    if (!look_at && type != "fisheye") reader.fail_missing("look_at_m", "[x, y, z]");
    placement.look_at_m = look_at.value_or(*position + Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d sight = placement.look_at_m - placement.position_m;
    const bool vertical = sight.x() == 0 && sight.y() == 0 && type != "panorama";
    placement.up = vector("up").value_or(vertical ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ());

    auto projection = Camera::Projection::perspective;
    NumberRange allowed{"above 0, up to 170", 0, 170, false};
    double default_deg = 60;
    if (type == "fisheye") {
      projection = Camera::Projection::fisheye;
      allowed = {"above 0, up to 360", 0, 360, false};
      default_deg = 180;
    } else if (type == "panorama") {
      projection = Camera::Projection::panorama;
      allowed = {"above 0, up to 180", 0, 180, false};
    }
    const double field_of_view_deg = reader.find_number("field_of_view_deg", allowed).value_or(default_deg);
    const auto pixels = [&](const char* key) {
      const auto count = reader.find_integer(key, 1, kMaxPixels);
      if (!count) reader.fail_missing(key, fmt::format("an integer from 1 to {}", kMaxPixels));
      return *count;
    };
    const int width = pixels("width"), height = pixels("height");
    const int rays = reader.find_integer("rays", 1, kMaxRays).value_or(2);
    reader.with_place(reader.has("look_at_m") ? "look_at_m" : "up", [&] {
      scene_.cameras.push_back(
          make_camera(name, projection, placement, field_of_view_deg * std::numbers::pi / 180, width, height, rays));
    });
    remember(reader, "position_m");
  }

  void read_surface(const ConfigReader& reader) {
    const std::string type =
        reader.find_choice("type", {"lambertian", "rpv", "ross-li", "cox-munk"}).value_or("lambertian");
    std::vector<std::string> keys{"type", "slope_deg", "aspect_deg"};
    const auto check_keys = [&](std::initializer_list<std::string> more) {
      keys.insert(keys.end(), more);
      reader.check_keys(keys);
    };
    Surface& surface = scene_.surface;
    surface.tilt.slope_deg = reader.find_number("slope_deg", {"0 to 89", 0, 89}).value_or(0);
    surface.tilt.aspect_deg = reader.find_number("aspect_deg", kFinite).value_or(0);
    if (type == "lambertian") {
      check_keys({"albedo", "albedo_map"});
      surface.albedo = reader.find_number("albedo", kFraction, at_).value_or(0);
      if (reader.has("albedo_map")) read_albedo_map_key(reader);
      if (surface.tilt.slope_deg > 0) surface.brdf = SurfaceBrdf::lambertian(surface.albedo);
    } else if (type == "rpv") {
      check_keys({"rho0", "k", "theta", "rho_c"});
      const double rho0 = reader.number("rho0", kNotNegative, at_);
      surface.brdf = SurfaceBrdf::rpv(rho0, reader.number("k", kPositive, at_),
                                      reader.number("theta", {"between -1 and 1", -1, 1, false, false}, at_),
                                      reader.find_number("rho_c", kNotNegative, at_).value_or(rho0));
    } else if (type == "ross-li") {
      check_keys({"f_iso", "f_vol", "f_geo"});
      surface.brdf = SurfaceBrdf::ross_li(reader.number("f_iso", kNotNegative, at_),
                                          reader.number("f_vol", kFinite, at_), reader.number("f_geo", kFinite, at_));
    } else {
      check_keys({"wind_speed_m_s", "refractive_index"});
      surface.brdf = SurfaceBrdf::cox_munk(
          reader.number("wind_speed_m_s", {"0 to 50", 0, 50}),
          reader.find_number("refractive_index", {"above 1, below 10", 1, 10, false, false}, at_).value_or(1.34));
    }
  }

  void read_albedo_map_key(const ConfigReader& reader) {
    const std::string file = reader.spectral_texts("albedo_map", at_).front();
    if (reader.has("albedo")) reader.fail("albedo_map", "stands beside `albedo`", file, "one of the two");
    if (scene_.surface.tilt.slope_deg > 0)
      reader.fail("albedo_map", "stands beside `slope_deg`", file, "one of the two");
    if (!scene_.cloud) {
      reader.fail("albedo_map", "needs a cloud, whose columns it covers", file,
                  "`albedo` where there are layers alone");
    }
    scene_.albedo_map = existing_spectral_file(reader, "albedo_map");
    remember(reader, "albedo_map");
  }

  void read_solver(const ConfigReader& reader) {
    reader.check_keys({"mode", "accuracy", "control_points", "directions", "delta_m_order", "fit", "gather_directions",
                       "beam_rays", "column_streams", "largest_level_depth", "tolerance", "class_tolerance",
                       "max_sweeps", "radiance_storage"});
    SceneSolver& solver = scene_.solver;
    const std::string mode =
        reader.find_choice("mode", {"auto", "3d", "independent-columns", "independent-diffuse"}).value_or("auto");
    if (mode == "3d") solver.mode = SolveMode::three_dimensional;
    if (mode == "independent-columns") solver.mode = SolveMode::independent_columns;
    if (mode == "independent-diffuse") solver.mode = SolveMode::independent_diffuse;
    solver.accuracy = reader.find_choice("accuracy", accuracy_names()).value_or("balanced");
    solver.control_points = reader.find_integer("control_points", 12, 642);
    if (solver.control_points) {
      reader.with_place("control_points", [&] { ControlPoints{*solver.control_points}; });
    }
    solver.directions = reader.find_text("directions");
    if (solver.directions) reader.with_place("directions", [&] { make_ordinate_set(*solver.directions); });
    solver.delta_m_order = reader.find_integer("delta_m_order", 1, 64);
    if (const auto fit = reader.find_choice("fit", {"linear-programming", "least-squares", "collocation"})) {
      solver.fit = *fit == "linear-programming" ? FitMethod::linear_programming
                   : *fit == "least-squares"    ? FitMethod::least_squares
                                                : FitMethod::collocation;
    }
    solver.gather_directions = reader.find_integer("gather_directions", 1, 1000000);
    solver.beam_rays = reader.find_integer("beam_rays", 1, 1024);
    if (solver.beam_rays) {
      const int side = static_cast<int>(std::lround(std::sqrt(*solver.beam_rays)));
      if (side * side != *solver.beam_rays) {
        reader.fail("beam_rays", "not a square number", std::to_string(*solver.beam_rays), "1, 4, 9, 16, ..., 1024");
      }
    }
    solver.column_streams = reader.find_integer("column_streams", 2, 16);
    solver.largest_level_depth = reader.find_number("largest_level_depth", {">= 0", 0, 1e9});
    solver.tolerance = reader.find_number("tolerance", kTolerance);
    solver.class_tolerance = reader.find_number("class_tolerance", {"0 to 0.1", 0, 0.1});
    solver.max_sweeps = reader.find_integer("max_sweeps", 1, 1000000).value_or(solver.max_sweeps);
    solver.half_precision_radiance = reader.find_choice("radiance_storage", {"float32", "float16"}) == "float16";
  }

  void read_output(const ConfigReader& reader) {
    reader.check_keys({"flux_levels", "file", "fields", "error_estimate"});
    SceneOutput& output = scene_.output;
    output.error_estimate = reader.flag("error_estimate", output.error_estimate);
    if (reader.has("file")) output.file = relative_to_scene(reader.text("file"));
    if (const ConfigNode* levels = reader.find("flux_levels"); levels != nullptr) {
      if (levels->kind == ConfigNode::Kind::array) {
        output.flux_levels = FluxLevels::listed;
        output.heights_m = *reader.find_numbers("flux_levels", kFinite);
        if (output.heights_m.empty())
          reader.fail("flux_levels", "empty", "[]", "all, boundaries, or heights in metres");
        std::sort(output.heights_m.begin(), output.heights_m.end());
      } else {
        const auto name = reader.find_text("flux_levels");
        if (name != "all" && name != "boundaries") {
          reader.fail("flux_levels", "not one of the choices", describe(*levels),
                      "all, boundaries, or a list of heights in metres");
        }
        if (name == "boundaries") output.flux_levels = FluxLevels::boundaries;
      }
    }
    if (const auto fields = reader.find_texts("fields")) {
      output.absorption = false;
      for (const std::string& field : *fields) {
        if (field == "absorption") {
          output.absorption = true;
        } else if (field == "actinic") {
          output.actinic = true;
        } else if (field == "radiance_field") {
          output.radiance_field = true;
        } else if (field == "errors") {
          output.errors = true;
        } else if (field != "fluxes") {
          reader.fail("fields", "not one of the choices", fmt::format("\"{}\"", field),
                      "fluxes, absorption, actinic, radiance_field, errors");
        }
      }
    }
    remember(reader, "flux_levels");
  }

  void check_whole() const {
    if (!scene_.cloud && scene_.layers.empty()) {
      throw InputError(
          fmt::format("{}: nothing that light could meet (found neither [cloud] nor [[layer]], allowed one or both)",
                      scene_.path.string()));
    }
    if (!scene_.sun && scene_.sky_radiance <= 0) {
      throw InputError(fmt::format("{}: no light (found neither [sun] nor [sky] that shines, allowed one or both)",
                                   scene_.path.string()));
    }
  }

  ConfigReader root_;
  SpectralPlace at_;
  Scene scene_;
  std::map<std::string, DefinedPhaseFunction> defined_;
};

}  // namespace

std::string Scene::where(const std::string& key) const {
  const auto known = place.find(key);
  return fmt::format("{}: {}", known == place.end() ? path.string() : known->second, key);
}

std::vector<Scene> read_scenes(const std::filesystem::path& path, std::span<const std::string> overrides) {
  const ConfigTree tree = read_config(path, overrides);
  const std::vector<double> wavelengths = read_wavelengths(ConfigReader(tree.root, ""));
  std::vector<Scene> scenes;
  for (std::size_t n = 0; n < std::max<std::size_t>(wavelengths.size(), 1); ++n)
    scenes.push_back(SceneReader(tree, path, wavelengths, n).read());
  return scenes;
}

Scene read_scene(const std::filesystem::path& path, std::span<const std::string> overrides) {
  return std::move(read_scenes(path, overrides).front());
}

}  // namespace cloudbow
