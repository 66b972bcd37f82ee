#include <fmt/format.h>

#include "app/scene/scene_reader.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr NumberRange surface_temperature{"100 to 1000 K, not Celsius", 100, 1000};
constexpr const char* us_1976 = "us-1976";

/// Heights, pressures and temperatures of the table itself. `standard` gives the profile that is missing.
Atmosphere inline_atmosphere(const ConfigReader& reader, bool standard) {
  Atmosphere air;
  const auto profile = [&](const char* key, const NumberRange& range) {
    return reader.find_numbers(key, range).value_or(std::vector<double>());
  };
  air.height_m = profile("height_m", finite);
  air.pressure_pa = profile("pressure_pa", positive);
  air.temperature_k = profile("temperature_k", {"100 to 400 K, not Celsius", 100, 400});
  if (air.height_m.empty()) reader.fail_missing("height_m", "a list of heights for the profiles beside it");
  const Atmosphere filling = us_standard_1976();
  for (const char* key : {"pressure_pa", "temperature_k"}) {
    if (reader.has(key)) continue;
    if (!standard) {
      reader.fail_missing(key, fmt::format("a list with one number for each of height_m, or standard = \"{}\", which "
                                           "fills it",
                                           us_1976));
    }
    for (const double height : air.height_m) {
      if (key == std::string("pressure_pa")) air.pressure_pa.push_back(filling.pressure_at(height));
      if (key == std::string("temperature_k")) air.temperature_k.push_back(filling.temperature_at(height));
    }
  }
  if (reader.has("pressure_pa") && reader.has("temperature_k") && standard)
    reader.fail("standard", "nothing is left to fill", us_1976, "pressure_pa or temperature_k absent, or no such key");
  check_atmosphere(air, fmt::format("{}: {}", reader.place_of("height_m"), "atmosphere"));
  return air;
}

}  // namespace

void SceneReader::read_atmosphere_table(const ConfigReader& reader) {
  reader.check_keys({"file", "standard", "height_m", "pressure_pa", "temperature_k", "h2o", "o3", "co2", "ch4", "n2o",
                     "cfc11", "cfc12", "co2_ppm"});
  const bool standard = reader.find_choice("standard", {us_1976}).has_value();
  const bool is_inline = reader.has("height_m") || reader.has("pressure_pa") || reader.has("temperature_k");
  if (reader.has("file")) {
    for (const char* key : {"standard", "height_m", "pressure_pa", "temperature_k"}) {
      if (reader.has(key)) reader.fail(key, "stands beside `file`", "both", "one of the two");
    }
    const auto file = existing_file(reader, "file");
    reader.with_place("file", [&] { scene_.atmosphere = {read_atmosphere(file), file.filename().string()}; });
  } else if (is_inline) {
    scene_.atmosphere = {inline_atmosphere(reader, standard), "inline"};
  } else if (standard) {
    scene_.atmosphere = {us_standard_1976(), us_1976};
  } else {
    reader.fail_missing(
        "standard",
        fmt::format("one of file, standard = \"{}\", or height_m with pressure_pa and temperature_k", us_1976));
  }
  read_gases(reader, scene_.atmosphere->air);
  remember(root_, "atmosphere");
}

void SceneReader::read_gases(const ConfigReader& reader, Atmosphere& air) const {
  constexpr NumberRange mole_fraction{"a mole fraction, 0 to 1", 0, 1};
  for (const char* gas : {"h2o", "o3", "co2", "ch4", "n2o", "cfc11", "cfc12"}) {
    const ConfigNode* const given = reader.find(gas);
    if (given == nullptr) continue;
    std::vector<double>& profile = air.mole_fraction[gas];
    if (given->kind != ConfigNode::Kind::array) {
      profile.assign(air.height_m.size(), reader.number(gas, mole_fraction));
      continue;
    }
    profile = *reader.find_numbers(gas, mole_fraction);
    if (profile.size() != air.height_m.size() || !reader.has("height_m")) {
      reader.fail(gas, "not one number for each of height_m", fmt::format("{} numbers", profile.size()),
                  "a list as long as height_m of the table, or one number for all heights");
    }
  }
  if (!reader.has("co2_ppm")) return;
  if (reader.has("co2")) reader.fail("co2_ppm", "stands beside `co2`", "both", "one of the two");
  const double ppm = reader.number("co2_ppm", {"0, or 1 to 1e5", 0, 1e5});
  if (ppm > 0 && ppm < 1) {
    reader.fail("co2_ppm", "reads like a mole fraction, not like parts per million", fmt::format("{:g}", ppm),
                fmt::format("0, or 1 to 1e5; for a mole fraction of {0:g} write co2 = {0:g}", ppm));
  }
  air.mole_fraction["co2"].assign(air.height_m.size(), 1e-6 * ppm);
}

void SceneReader::read_thermal(const ConfigReader& reader) {
  reader.check_keys({"wavelength_um", "band_um"});
  SceneThermal thermal;
  if (scene_.wavelength_um) {
    for (const char* key : {"wavelength_um", "band_um"}) {
      if (!reader.has(key)) continue;
      reader.fail(key, "stands beside spectrum.wavelengths_um, each of which is a wavelength of emission", "both",
                  "[thermal] without keys");
    }
    thermal.wavelength_um = scene_.wavelength_um;
    thermal.set(PlanckFunction::at(*scene_.wavelength_um));
    scene_.thermal = thermal;
    return;
  }
  if (scene_.broadband) {
    read_thermal_of_point(reader);
    return;
  }
  if (reader.has("wavelength_um") == reader.has("band_um")) {
    reader.fail(reader.has("band_um") ? "band_um" : "wavelength_um",
                "wavelength_um and band_um = [a, b] exclude each other", reader.has("band_um") ? "both" : "neither",
                "one of the two; with [spectrum] neither");
  }
  if (reader.has("wavelength_um")) {
    thermal.wavelength_um = reader.number("wavelength_um", positive);
    reader.with_place("wavelength_um", [&] { thermal.set(PlanckFunction::at(*thermal.wavelength_um)); });
  } else {
    const auto ends = *reader.find_numbers("band_um", positive);
    if (ends.size() != 2) reader.fail("band_um", "not of length 2", describe(*reader.find("band_um")), "[a, b]");
    if (!(ends[0] < ends[1])) {
      reader.fail("band_um", "does not ascend", fmt::format("[{}, {}]", ends[0], ends[1]), "[a, b] with a < b");
    }
    thermal.band_um = {ends[0], ends[1]};
    reader.with_place("band_um", [&] { thermal.set(PlanckFunction::over(*thermal.band_um)); });
  }
  scene_.thermal = thermal;
}

void SceneReader::check_thermal_key(const ConfigReader& reader, const std::string& key) const {
  if (scene_.thermal) return;
  reader.fail(key, "nothing emits without [thermal]", describe(*reader.find(key)), "no such key, or [thermal]");
}

void SceneReader::read_surface_temperature(const ConfigReader& reader) {
  for (const char* key : {"temperature_k", "temperature_map"}) {
    if (reader.has(key)) check_thermal_key(reader, key);
  }
  if (reader.has("temperature_map")) {
    const std::string file = reader.text("temperature_map");
    if (reader.has("temperature_k"))
      reader.fail("temperature_map", "stands beside `temperature_k`", file, "one of the two");
    if (scene_.clouds.empty()) {
      reader.fail("temperature_map", "needs a cloud, whose columns it covers", file,
                  "`temperature_k` with layers alone");
    }
    scene_.temperature_map = existing_file(reader, "temperature_map");
    remember(reader, "temperature_map");
    return;
  }
  scene_.surface_temperature_k = reader.find_number("temperature_k", surface_temperature);
  if (!scene_.surface_temperature_k) return;
  scene_.surface.planck = scene_.thermal->planck(*scene_.surface_temperature_k);
  remember(reader, "temperature_k");
}

bool SceneReader::read_quantity(const ConfigReader& reader) const {
  const bool temperature =
      reader.find_choice("quantity", {"radiance", "brightness_temperature"}) == std::string("brightness_temperature");
  if (temperature) check_thermal_key(reader, "quantity");
  if (temperature && scene_.broadband)
    reader.fail("quantity", "is for one spectral interval", "brightness_temperature",
                "radiance with spectrum.gas_model");
  return temperature;
}

void SceneReader::check_emission() {
  if (scene_.thermal && !scene_.atmosphere) {
    throw InputError(fmt::format(
        "{}: atmosphere: missing (found [thermal] without it, allowed [atmosphere], whose temperature all matter "
        "has) standard = \"{}\" needs no file",
        root_.place_of("thermal"), us_1976));
  }
  if (scene_.thermal && !scene_.surface_temperature_k && scene_.temperature_map.empty()) {
    throw InputError(
        fmt::format("{}: surface.temperature_k: missing (found [thermal] without it, allowed {}, or "
                    "surface.temperature_map)",
                    root_.place_of(root_.has("surface") ? "surface" : "thermal"), surface_temperature.allowed));
  }
  if (scene_.output.heating_rate && !scene_.atmosphere) {
    throw InputError(
        fmt::format("{}: heating_rate needs the density of air (found no [atmosphere], allowed one of its own or "
                    "standard = \"{}\")",
                    scene_.where("output.fields"), us_1976));
  }
  if (scene_.atmosphere && !scene_.thermal && !scene_.output.heating_rate && !scene_.broadband) {
    const std::string told = "not used: there is neither [thermal] nor heating_rate among output.fields";
    note(root_, "atmosphere", std::span(&told, 1));
  }
}

}  // namespace cloudbow
