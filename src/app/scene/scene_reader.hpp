// The scene at one of its wavelengths, read table by table. The file scene.cpp reads domain, sun and surface. The files
// scene_optics.cpp and scene_thermal.cpp read the optics, the air and temperatures. The file scene_settings.cpp reads
// the solver and the outputs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/scene/config_reader.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/io/phase_function_file.hpp"
#include "cloudbow/optics/bulk_optics.hpp"

namespace cloudbow {

/// Tables of bulk optics by file, each read once for all g-points.
using BulkTables = std::map<std::filesystem::path, BulkTable>;

/// `[spectrum]`: wavelengths, or the g-points of a gas model, or neither.
struct SceneSpectrum {
  std::vector<double> wavelengths_um{};
  std::optional<SceneBroadband> broadband{};
  std::filesystem::path gas_file{};
  std::shared_ptr<BulkTables> bulk_tables = std::make_shared<BulkTables>();

  /// Scenes that it makes.
  std::size_t size() const {
    if (broadband) return static_cast<std::size_t>(broadband->model->points());
    return std::max<std::size_t>(wavelengths_um.size(), 1);
  }
};

class SceneReader {
 public:
  SceneReader(const ConfigTree& tree, const std::filesystem::path& path, const SceneSpectrum& spectrum,
              std::size_t place)
      : root_(tree.root, ""),
        at_{spectrum.wavelengths_um.empty() ? 0 : place, spectrum.wavelengths_um.size()},
        bulk_tables_(spectrum.bulk_tables) {
    if (!spectrum.wavelengths_um.empty()) scene_.wavelength_um = spectrum.wavelengths_um[place];
    scene_.broadband = spectrum.broadband;
    scene_.gas_point = static_cast<int>(place);
    if (!spectrum.gas_file.empty()) scene_.inputs.push_back(spectrum.gas_file);
    scene_.path = path;
    scene_.inputs.push_back(path);
    scene_.text = tree.text;
  }

  Scene read();

 private:
  struct BulkOfPoint {
    const BulkTable* table;
    std::vector<BulkOptics> by_radius;
  };
  /// A function, or a mie table from which an effective radius makes one, or a set of functions.
  struct DefinedPhaseFunction {
    std::optional<PhaseFunction> function;
    bool measured = false;
    std::shared_ptr<const DropletTable> droplets{};
    std::optional<double> effective_radius_um{};
    bool by_humidity = false;  ///< droplets are the one row of an aerosol, whose radius has no meaning
    std::shared_ptr<const ScenePhaseSet> set{};
    /// Of bulk tables: the table at the g-point, by its radii. Droplets are there too, with the same optics.
    std::optional<BulkOfPoint> bulk{};
  };

  std::filesystem::path relative_to_scene(const std::string& file) const;
  std::filesystem::path existing_file(const ConfigReader& reader, const std::string& key);
  std::filesystem::path existing_file(const ConfigReader& reader, const std::string& key, const std::string& name);
  /// The file of this wavelength, of a list with one for each or of one for all.
  std::filesystem::path existing_spectral_file(const ConfigReader& reader, const std::string& key);
  void remember(const ConfigReader& reader, const std::string& key);
  /// Keeps notes for the user about the file or value of a key.
  void note(const ConfigReader& reader, const std::string& key, std::span<const std::string> notes);

  void read_phase_functions();
  DefinedPhaseFunction read_phase_function(const std::string& name, const ConfigReader& reader);
  DefinedPhaseFunction read_legendre(const ConfigReader& reader);
  /// A function alone in a text file, by one of the readers of phase_function_file.hpp.
  DefinedPhaseFunction read_function_file(const ConfigReader& reader,
                                          PhaseFunctionFile (*reader_of_file)(const std::filesystem::path&));
  DefinedPhaseFunction read_mie(const ConfigReader& reader);
  DefinedPhaseFunction read_set(const ConfigReader& reader);
  /// Optics by wavenumber and radius, from a file or by Mie theory, averaged over the g-point.
  DefinedPhaseFunction read_bulk(const std::string& name, const ConfigReader& reader);
  const BulkTable& bulk_table_of_file(const ConfigReader& reader);
  const BulkTable& bulk_table_by_mie(const std::string& name, const ConfigReader& reader);
  /// Radii of the constituents whose phase function has this name, ascending; none if one of them has a grid of radii.
  std::vector<double> radii_of(const std::string& name) const;
  const std::pair<const std::string, DefinedPhaseFunction>& find_phase_function(const ConfigReader& reader) const;
  /// Index in the scene of a function that may already be there.
  int add_phase_function(const std::string& name, const PhaseFunction& function, bool measured);
  /// The cloud's phase function, and the other data of its droplets in a mie table.
  void read_cloud_optics(const ConfigReader& reader, SceneCloud& cloud);
  /// Checks that the fields optical_depth and extinction can be written, and finds the optics that only they need.
  void read_cloud_fields();
  void read_layer_optics(const ConfigReader& reader, Layer& layer);
  /// The tables of the constituents, in the order of Scene::clouds: [cloud], or those of [[cloud]].
  std::vector<ConfigReader> cloud_tables() const;
  void read_cloud(const ConfigReader& reader);
  std::string read_cloud_name(const ConfigReader& reader) const;
  /// One grid, or several that are added up.
  void read_grids(const ConfigReader& reader, SceneCloud& cloud) const;
  void read_layer(const ConfigReader& reader);
  /// Ratio of the optical depth at this wavelength to that at the wavelength for which the layer gives one.
  double rayleigh_ratio(const ConfigReader& reader, const Layer& layer) const;

  void read_domain(const ConfigReader& reader);
  /// Counter-clockwise from +x, from whichever of the two keys is there.
  static std::optional<double> read_azimuth(const ConfigReader& reader);
  void read_sun(const ConfigReader& reader);
  void read_sky(const ConfigReader& reader);
  void read_surface(const ConfigReader& reader);
  void read_albedo_map_key(const ConfigReader& reader);
  /// The mean over the g-point of an albedo by wavelength.
  double read_spectral_albedo_key(const ConfigReader& reader);
  void read_atmosphere_table(const ConfigReader& reader);
  /// Mole fractions: one for all heights, or one for each height of the table.
  void read_gases(const ConfigReader& reader, Atmosphere& air) const;
  void read_thermal(const ConfigReader& reader);
  void read_thermal_of_point(const ConfigReader& reader);
  /// The temperature of the ground, or its map.
  void read_surface_temperature(const ConfigReader& reader);
  /// `quantity` of an image: whether it is the brightness temperature.
  bool read_quantity(const ConfigReader& reader) const;
  /// @throws InputError for a key that has no meaning without [thermal].
  void check_thermal_key(const ConfigReader& reader, const std::string& key) const;
  /// Checks that what [thermal] and heating rates need is there.
  void check_emission();
  void check_whole();
  /// Checks that a scene has the light and the air of its gas model.
  void check_broadband() const;
  /// Checks that the field bands has bands, and all their g-points.
  void check_bands() const;

  /// @throws InputError for a name that variables and attributes of results cannot have.
  static void check_name(const ConfigReader& reader, const std::string& name);
  /// Name of an image in results and pictures.
  std::string read_image_name(const ConfigReader& reader) const;
  void read_radiance(const ConfigReader& reader);
  void read_camera(const ConfigReader& reader);
  void read_solver(const ConfigReader& reader);
  void read_output(const ConfigReader& reader);

  ConfigReader root_;
  SpectralPlace at_;
  std::shared_ptr<BulkTables> bulk_tables_;
  Scene scene_;
  std::map<std::string, DefinedPhaseFunction> defined_;
};

}  // namespace cloudbow
