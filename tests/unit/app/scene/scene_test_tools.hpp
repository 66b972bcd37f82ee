// A scene of layers, and what reading it or a changed one says.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/error.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {

inline const std::string layers_toml = R"(title = "three layers"

[phase_function.droplets]
type = "henyey-greenstein"
asymmetry_parameter = 0.85

[[layer]]
name = "cloud"
bottom_m = 500.0
top_m = 1000
optical_depth = 10.0
single_scattering_albedo = 0.99
phase_function = "droplets"

[[layer]]
bottom_m = 0
top_m = 3000
optical_depth = 0.1
single_scattering_albedo = 1
phase_function = "rayleigh"

[sun]
zenith_deg = 60.0
azimuth_deg = 37.0
irradiance_w_m2 = 1361.0

[surface]
type = "lambertian"
albedo = 0.25

[solver]
accuracy = "fine"
)";

/// The text with one part replaced; the part must be there.
inline std::string replaced(const std::string& part, const std::string& by) {
  std::string text = layers_toml;
  const auto at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), by);
}

inline std::string message_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryFolder folder;
  try {
    read_scene(folder.write("scene.toml", text), overrides);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace cloudbow
