// Scenes of one layer for tests of planning.
#pragma once

#include <string>
#include <vector>

#include "cloudbow/app/scene.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {

inline std::vector<Scene> layer_scenes(const std::string& more = "") {
  const TemporaryFolder folder;
  return read_scenes(folder.write("scene.toml",
                                  "[[layer]]\nbottom_m = 0\ntop_m = 100\noptical_depth = 2\n"
                                  "single_scattering_albedo = 0.9\nphase_function = \"isotropic\"\n[sun]\n"
                                  "zenith_deg = 30\nazimuth_deg = 0\n[solver]\naccuracy = \"draft\"\n" +
                                      more));
}

}  // namespace cloudbow
