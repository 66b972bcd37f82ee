// The scene at one of its wavelengths, read table by table. The file scene.cpp reads domain, sun and surface. The files
// scene_optics.cpp and scene_thermal.cpp read the optics, the air and temperatures. The file scene_settings.cpp reads
// the solver and the outputs.
#pragma once

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

namespace cloudbow {

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

  Scene read();

 private:
  /// A function, or a mie table from which an effective radius makes one, or a set of functions.
  struct DefinedPhaseFunction {
    std::optional<PhaseFunction> function;
    bool measured = false;
    std::shared_ptr<const DropletTable> droplets{};
    std::optional<double> effective_radius_um{};
    std::shared_ptr<const ScenePhaseSet> set{};
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
  DefinedPhaseFunction read_phase_function(const ConfigReader& reader);
  DefinedPhaseFunction read_legendre(const ConfigReader& reader);
  /// A function alone in a text file, by one of the readers of phase_function_file.hpp.
  DefinedPhaseFunction read_function_file(const ConfigReader& reader,
                                          PhaseFunctionFile (*reader_of_file)(const std::filesystem::path&));
  DefinedPhaseFunction read_mie(const ConfigReader& reader);
  DefinedPhaseFunction read_set(const ConfigReader& reader);
  const std::pair<const std::string, DefinedPhaseFunction>& find_phase_function(const ConfigReader& reader) const;
  /// Index in the scene of a function that may already be there.
  int add_phase_function(const std::string& name, const PhaseFunction& function, bool measured);
  /// The cloud's phase function, and the other data of its droplets in a mie table.
  void read_cloud_optics(const ConfigReader& reader, SceneCloud& cloud);
  void read_layer_optics(const ConfigReader& reader, Layer& layer);
  void read_cloud(const ConfigReader& reader);
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
  void read_atmosphere_table(const ConfigReader& reader);
  void read_thermal(const ConfigReader& reader);
  /// The temperature of the ground, or its map.
  void read_surface_temperature(const ConfigReader& reader);
  /// `quantity` of an image: whether it is the brightness temperature.
  bool read_quantity(const ConfigReader& reader) const;
  /// @throws InputError for a key that has no meaning without [thermal].
  void check_thermal_key(const ConfigReader& reader, const std::string& key) const;
  /// Checks that what [thermal] and heating rates need is there.
  void check_emission();
  void check_whole();

  /// Name of an image in results and pictures.
  std::string read_image_name(const ConfigReader& reader) const;
  void read_radiance(const ConfigReader& reader);
  void read_camera(const ConfigReader& reader);
  void read_solver(const ConfigReader& reader);
  void read_output(const ConfigReader& reader);

  ConfigReader root_;
  SpectralPlace at_;
  Scene scene_;
  std::map<std::string, DefinedPhaseFunction> defined_;
};

}  // namespace cloudbow
