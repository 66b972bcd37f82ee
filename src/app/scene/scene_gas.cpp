// Scenes at the g-points of a gas model.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/process/cache_directory.hpp"
#include "app/scene/scene_reader.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/bulk_table_file.hpp"
#include "cloudbow/medium/spectral_albedo.hpp"
#include "cloudbow/medium/spectral_weight.hpp"
#include "cloudbow/optics/mie_bulk.hpp"

namespace cloudbow {
namespace {

constexpr double longest_um = 1000;  // longwave models begin at the wavenumber 0

/// Moments g^l, as far as they matter.
std::vector<double> henyey_greenstein_moments(double asymmetry) {
  std::vector<double> moments{1.};
  constexpr double least = 1e-6;
  constexpr std::size_t most = 2000;
  while (moments.size() < most && std::abs(moments.back()) * (2. * static_cast<double>(moments.size()) + 1) > least)
    moments.push_back(moments.back() * asymmetry);
  return moments;
}

}  // namespace

void SceneReader::read_thermal_of_point(const ConfigReader& reader) {
  const GasModel& model = *scene_.broadband->model;
  for (const char* key : {"wavelength_um", "band_um"}) {
    if (reader.has(key))
      reader.fail(key, "stands beside spectrum.gas_model", "both",
                  "[thermal] without keys: the model has its own bands");
  }
  if (model.light() != GasModel::Light::longwave) {
    throw InputError(
        fmt::format("{}: thermal: stands beside a gas model of sunlight (found {}, allowed a longwave one, or a scene "
                    "without [thermal])",
                    root_.place_of("thermal"), scene_.broadband->file));
  }
  SceneThermal thermal;
  thermal.planck = [model = scene_.broadband->model, point = scene_.gas_point](double temperature) {
    return model->planck(point, temperature);
  };
  const auto& spectrum = model.spectrum();
  thermal.band_um = {1e4 / spectrum.upper.back(), std::min(longest_um, 1e4 / std::max(spectrum.lower.front(), 1e-9))};
  scene_.thermal = thermal;
}

const BulkTable& SceneReader::bulk_table_of_file(const ConfigReader& reader) {
  const auto file = existing_file(reader, "file");
  auto found = bulk_tables_->find(file);
  if (found == bulk_tables_->end()) {
    reader.with_place("file", [&] { found = bulk_tables_->emplace(file, read_bulk_table(file)).first; });
  }
  return found->second;
}

std::vector<double> SceneReader::radii_of(const std::string& name) const {
  std::vector<double> radii;
  for (const ConfigReader& cloud : cloud_tables()) {
    if (cloud.find_text("phase_function") != name) continue;
    const auto radius = cloud.find_number("effective_radius_um", positive);
    if (!radius) return {};
    radii.push_back(*radius);
  }
  std::sort(radii.begin(), radii.end());
  radii.erase(std::unique(radii.begin(), radii.end()), radii.end());
  return radii;
}

const BulkTable& SceneReader::bulk_table_by_mie(const std::string& name, const ConfigReader& reader) {
  const std::string substance = *reader.find_choice("substance", {"water", "ice"});
  // Mie theory takes long for large radii: those of the scene alone, if it says so.
  std::vector<double> radii = radii_of(name);
  const auto radius = reader.find_number("effective_radius_um", positive);
  if (radius) radii = {*radius};
  const bool given = !radii.empty();
  if (!given) radii = {3, 4, 5, 6, 8, 10, 12, 15, 20, 25, 30};
  const std::filesystem::path key = fmt::format("{} {}", substance, fmt::join(radii, " "));
  auto found = bulk_tables_->find(key);
  if (found == bulk_tables_->end()) {
    reader.with_place(given ? "effective_radius_um" : "substance", [&] {
      const auto [shortest, longest] = wavelengths_of(*scene_.broadband->model);
      const MieBulkRecipe recipe{substance == "water" ? Substance::water : Substance::ice, DistributionKind::gamma, .1};
      std::vector<double> wavelengths = mie_wavelengths(shortest, longest);
      // An extinction grid is relative to visible light, which longwave models do not reach.
      constexpr double beside_visible_um = .01;
      for (const double um : {SceneCloud::visible_um + beside_visible_um, SceneCloud::visible_um - beside_visible_um}) {
        if (um < wavelengths.front()) wavelengths.insert(wavelengths.begin(), um);
      }
      found = bulk_tables_->emplace(key, make_mie_bulk_table(recipe, wavelengths, radii, {0, cache_directory()})).first;
    });
  }
  return found->second;
}

SceneReader::DefinedPhaseFunction SceneReader::read_bulk(const std::string& name, const ConfigReader& reader) {
  reader.check_keys({"type", "file", "substance", "effective_radius_um"});
  if (!scene_.broadband)
    reader.fail("type", "needs spectrum.gas_model, whose g-points it is averaged over", "bulk",
                "spectrum.gas_model beside it, or type = \"mie\" at wavelengths");
  if (reader.has("file") && reader.has("substance"))
    reader.fail("substance", "stands beside `file`", "both", "one of the two");
  if (!reader.has("file") && !reader.has("substance"))
    reader.fail_missing("file", "file = \"TABLE.nc\", or substance = \"water\" or \"ice\" for spheres by Mie theory");
  DefinedPhaseFunction defined;
  defined.effective_radius_um = reader.find_number("effective_radius_um", positive);
  const BulkTable& table = reader.has("file") ? bulk_table_of_file(reader) : bulk_table_by_mie(name, reader);
  reader.with_place(reader.has("file") ? "file" : "substance", [&] {
    const SpectralWeight weight = weight_of_point(*scene_.broadband->model, scene_.gas_point);
    defined.bulk = BulkOfPoint{&table, average_over(table, weight.wavenumber_cm1, weight.weight)};
  });
  DropletTable droplets;
  droplets.effective_radius_um = table.effective_radius_um;
  for (const BulkOptics& optics : defined.bulk->by_radius) {
    droplets.extinction_m2_per_g.push_back(optics.extinction_m2_per_g);
    droplets.single_scattering_albedo.push_back(optics.single_scattering_albedo);
    droplets.moments.push_back(henyey_greenstein_moments(optics.asymmetry));
  }
  defined.droplets = std::make_shared<const DropletTable>(std::move(droplets));
  return defined;
}

double SceneReader::read_spectral_albedo_key(const ConfigReader& reader) {
  for (const char* key : {"albedo", "albedo_map"}) {
    if (reader.has(key))
      reader.fail("spectral_albedo", fmt::format("stands beside `{}`", key), "both", "one of the two");
  }
  if (!scene_.broadband)
    reader.fail("spectral_albedo", "needs spectrum.gas_model", reader.text("spectral_albedo"),
                "`albedo`, or a list of them");
  const auto file = existing_file(reader, "spectral_albedo");
  double albedo = 0;
  reader.with_place("spectral_albedo", [&] {
    albedo = albedo_of_points(*scene_.broadband->model, read_spectral_albedo(file),
                              file.filename().string())[static_cast<std::size_t>(scene_.gas_point)];
  });
  return albedo;
}

void SceneReader::check_bands() const {
  if (!scene_.output.bands) return;
  if (!scene_.broadband) {
    throw InputError(fmt::format(
        "{}: bands need a gas model (found no spectrum.gas_model, allowed one); leave bands out, or give it",
        scene_.where("output.fields")));
  }
  if (scene_.broadband->method == SceneBroadband::Method::few) {
    throw InputError(
        fmt::format("{}: few g-points have no parts by band (found spectrum.method \"few\", allowed \"all\", "
                    "\"columns\"); \"columns\" is quicker",
                    scene_.where("output.fields")));
  }
}

void SceneReader::check_broadband() const {
  const SceneBroadband& broadband = *scene_.broadband;
  if (!scene_.atmosphere) {
    throw InputError(
        fmt::format("{}: atmosphere: missing (found spectrum.gas_model without it, allowed [atmosphere] with "
                    "the gases of the model: {})",
                    root_.place_of("spectrum"), fmt::join(broadband.model->gases(), ", ")));
  }
  const bool solar = broadband.model->light() == GasModel::Light::solar;
  if (solar ? root_.has("sun") : scene_.thermal.has_value()) return;
  throw InputError(fmt::format("{}: {}: missing (found {}, a gas model of {}, allowed [{}] beside it)",
                               root_.place_of("spectrum"), solar ? "sun" : "thermal", broadband.file,
                               solar ? "sunlight" : "longwave light", solar ? "sun" : "thermal"));
}

}  // namespace cloudbow
