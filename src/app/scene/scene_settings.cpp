#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>

#include "app/scene/accuracy.hpp"
#include "app/scene/scene_reader.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"
#include "cloudbow/transport/output_fields.hpp"

namespace cloudbow {
namespace {

constexpr NumberRange tolerance_range{"1e-8 to 0.1", 1e-8, 0.1};
constexpr int max_pixels = 16384;
constexpr int max_rays = 16;

}  // namespace

void SceneReader::check_name(const ConfigReader& reader, const std::string& name) {
  const auto is_word = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  if (!std::all_of(name.begin(), name.end(), is_word)) reader.fail("name", "not a name", name, "letters, digits and _");
}

std::string SceneReader::read_image_name(const ConfigReader& reader) const {
  const std::string name = reader.text("name");
  check_name(reader, name);
  const auto same = [&](const auto& other) { return other.name == name; };
  if (name == "field" || std::any_of(scene_.radiances.begin(), scene_.radiances.end(), same) ||
      std::any_of(scene_.cameras.begin(), scene_.cameras.end(), same)) {
    reader.fail("name", "already in use", name, "another name");
  }
  return name;
}

namespace {

/// Fields that the program makes of solutions, of the scene, or of several runs. The others are output_fields().
struct MadeField {
  std::string_view key;
  bool SceneOutput::*asked;
};
constexpr std::array<MadeField, 6> made_fields{{{"heating_rate", &SceneOutput::heating_rate},
                                                {"optical_depth", &SceneOutput::optical_depth},
                                                {"extinction", &SceneOutput::extinction},
                                                {"bands", &SceneOutput::bands},
                                                {"radiance_field", &SceneOutput::radiance_field},
                                                {"errors", &SceneOutput::errors}}};

void read_field(const ConfigReader& reader, const std::string& name, SceneOutput& output) {
  bool found = false;
  std::vector<std::string> allowed;
  for (const OutputField& field : output_fields()) {
    if (field.key == nullptr) continue;
    if (std::find(allowed.begin(), allowed.end(), field.key) == allowed.end()) allowed.emplace_back(field.key);
    if (name != field.key) continue;
    found = true;
    if (field.asked != nullptr) output.*field.asked = true;
  }
  for (const MadeField& field : made_fields) {
    allowed.emplace_back(field.key);
    if (name != field.key) continue;
    found = true;
    output.*field.asked = true;
  }
  if (found) return;
  reader.fail("fields", "not one of the choices", fmt::format("\"{}\"", name),
              fmt::format("{}", fmt::join(allowed, ", ")));
}

/// `largest_level_depth` is an earlier name of the key.
std::optional<double> read_max_level_optical_depth(const ConfigReader& reader) {
  const NumberRange range{">= 0", 0, 1e9};
  const auto depth = reader.find_number("max_level_optical_depth", range);
  const auto earlier = reader.find_number("largest_level_depth", range);
  if (depth && earlier) {
    reader.fail("largest_level_depth", "an earlier name of max_level_optical_depth, which is given too",
                fmt::format("{}", *earlier), "one of the two");
  }
  return depth ? depth : earlier;
}

}  // namespace

void SceneReader::read_radiance(const ConfigReader& reader) {
  reader.check_keys({"name", "zenith_deg", "azimuth_deg", "bearing_deg", "width", "height", "quantity"});
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
  radiance.width = reader.find_integer("width", 1, max_pixels).value_or(0);
  radiance.height = reader.find_integer("height", 1, max_pixels).value_or(0);
  radiance.brightness_temperature = read_quantity(reader);
  scene_.radiances.push_back(radiance);
}

void SceneReader::read_camera(const ConfigReader& reader) {
  reader.check_keys(
      {"name", "type", "position_m", "look_at_m", "up", "field_of_view_deg", "width", "height", "rays", "quantity"});
  const std::string name = read_image_name(reader);
  const std::string type = reader.find_choice("type", {"perspective", "fisheye", "panorama"}).value_or("perspective");
  const auto vector = [&](const char* key) -> std::optional<Eigen::Vector3d> {
    const auto triple = reader.find_triple(key, finite);
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
    const auto count = reader.find_integer(key, 1, max_pixels);
    if (!count) reader.fail_missing(key, fmt::format("an integer from 1 to {}", max_pixels));
    return *count;
  };
  const int width = pixels("width"), height = pixels("height");
  const int rays = reader.find_integer("rays", 1, max_rays).value_or(2);
  reader.with_place(reader.has("look_at_m") ? "look_at_m" : "up", [&] {
    scene_.cameras.push_back(
        make_camera(name, projection, placement, field_of_view_deg * std::numbers::pi / 180, width, height, rays));
  });
  if (read_quantity(reader)) scene_.thermal_cameras.push_back(name);
  remember(reader, "position_m");
}

void SceneReader::read_solver(const ConfigReader& reader) {
  reader.check_keys({"mode", "accuracy", "control_points", "directions", "delta_m_order", "fit", "gather_directions",
                     "beam_rays", "column_streams", "largest_level_depth", "max_level_optical_depth",
                     "max_column_optical_depth", "max_column_parts", "air", "tolerance", "class_tolerance",
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
  solver.max_level_optical_depth = read_max_level_optical_depth(reader);
  solver.max_column_optical_depth = reader.find_number("max_column_optical_depth", {">= 0", 0, 1e9});
  solver.max_column_parts = reader.find_integer("max_column_parts", 1, 16);
  const std::string air = reader.find_choice("air", {"auto", "levels", "cells"}).value_or("auto");
  if (air == "levels") solver.air = AirCells::in_blocks;
  if (air == "cells") solver.air = AirCells::of_voxels;
  solver.tolerance = reader.find_number("tolerance", tolerance_range);
  solver.class_tolerance = reader.find_number("class_tolerance", {"0 to 0.1", 0, 0.1});
  solver.max_sweeps = reader.find_integer("max_sweeps", 1, 1000000).value_or(solver.max_sweeps);
  solver.half_precision_radiance = reader.find_choice("radiance_storage", {"float32", "float16"}) == "float16";
}

void SceneReader::read_output(const ConfigReader& reader) {
  reader.check_keys({"flux_levels", "file", "fields", "error_estimate", "circumsolar_deg"});
  SceneOutput& output = scene_.output;
  output.error_estimate = reader.flag("error_estimate", output.error_estimate);
  if (reader.has("file")) output.file = relative_to_scene(reader.text("file"));
  if (const ConfigNode* levels = reader.find("flux_levels"); levels != nullptr) {
    if (levels->kind == ConfigNode::Kind::array) {
      output.flux_levels = FluxLevels::listed;
      output.heights_m = *reader.find_numbers("flux_levels", finite);
      if (output.heights_m.empty()) reader.fail("flux_levels", "empty", "[]", "all, boundaries, or heights in metres");
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
    for (const OutputField& field : output_fields()) {
      if (field.asked != nullptr) output.*field.asked = false;
    }
    for (const std::string& name : *fields) read_field(reader, name, output);
  }
  if (const auto degrees = reader.find_number("circumsolar_deg", {"0.05 to 10", .05, 10})) {
    if (!scene_.sun) reader.fail("circumsolar_deg", "no sun", fmt::format("{}", *degrees), "with [sun] only");
    output.circumsolar_half_angle = std::min(*degrees * std::numbers::pi / 180, largest_circumsolar_half_angle);
  }
  for (const char* key : {"flux_levels", "fields", "circumsolar_deg"}) remember(reader, key);
}

}  // namespace cloudbow
