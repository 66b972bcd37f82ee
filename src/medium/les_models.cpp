#include "les_models.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cloudbow/core/text_case.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "import_parts.hpp"
#include "netcdf_input.hpp"

namespace cloudbow {
namespace {

/// Those whose variables have names of their own stand first.
const std::vector<LesModel>& models() {
  static const std::vector<LesModel> all{
      {"wrf",
       "WRF",
       {"wrf"},
       {{"PH", "PHB", "PB"}},
       {{&water_names, {"QCLOUD"}},
        {&ice_names, {"QICE"}},
        {&rain_names, {"QRAIN"}},
        {&snow_names, {"QSNOW"}},
        {&graupel_names, {"QGRAUP"}},
        {&droplet_number_names, {"QNCLOUD", "QNDROP"}},
        {&effective_radius_names, {"RE_CLOUD"}},
        {&pressure_names, {"P"}}},
       {},
       {}},
      {"rams",
       "RAMS",
       {"rams"},
       {{"RCP"}},
       {{&water_names, {"RCP"}},
        {&ice_names, {"RPP"}},
        {&rain_names, {"RRP"}},
        {&snow_names, {"RSP"}},
        {&graupel_names, {"RGP"}},
        {&droplet_number_names, {"CCP"}},
        {&exner_names, {"PI"}}},
       {},
       {}},
      {"era5",
       "ERA5",
       {"era5"},
       {{"clwc"}, {"ciwc"}},
       {{&water_names, {"clwc"}},
        {&ice_names, {"ciwc"}},
        {&rain_names, {"crwc"}},
        {&snow_names, {"cswc"}},
        {&temperature_names, {"t"}}},
       {},
       {}},
      {"monc",
       "MONC",
       {"monc"},
       {{"q_cloud_liquid_mass"}},
       {{&water_names, {"q_cloud_liquid_mass"}}, {&air_density_names, {"rhon"}}, {&pressure_names, {"prefn"}}},
       {{&pressure_names, {"p"}}},
       {}},
      {"meso-nh",
       "Meso-NH",
       {"meso-nh", "mesonh", "meso_nh"},
       {{"RCT", "THT"}, {"RCT", "PABST"}},
       {{&water_names, {"RCT"}},
        {&ice_names, {"RIT"}},
        {&rain_names, {"RRT"}},
        {&snow_names, {"RST"}},
        {&graupel_names, {"RGT"}},
        {&pressure_names, {"PABST"}},
        {&potential_temperature_names, {"THT"}}},
       {},
       {},
       {"ALT"}},
      {"palm",
       "PALM",
       {"palm"},
       {{"zu_3d"}},
       {{&water_names, {"ql"}}, {&temperature_names, {"ta"}}, {&potential_temperature_names, {"theta", "pt"}}},
       {{&pressure_names, {"p"}}},  // the perturbation
       {}},
      {"cosmo",
       "COSMO",
       {"cosmo"},
       {{"HHL", "QC"}, {"HFL", "QC"}, {"HHL", "QI"}},
       {{&water_names, {"QC"}}, {&pressure_names, {"P"}}, {&temperature_names, {"T"}}},
       {},
       {}},
      {"icon",
       "ICON",
       {"icon "},
       {{"z_mc"}, {"z_ifc"}},
       {{&water_names, {"qc", "clw"}},
        {&ice_names, {"qi", "cli"}},
        {&air_density_names, {"rho"}},
        {&pressure_names, {"pres", "pfull"}},
        {&temperature_names, {"temp", "ta"}}},
       {},
       {}},
      {"oceananigans",
       "Oceananigans or Breeze",
       {"oceananigans", "breeze"},
       {{"z_aac"}, {"zC"}},
       {{&water_names, {"q\xcb\xa1"}},
        {&air_density_names, {"\xcf\x81", "\xcf\x81\xe1\xb5\xa3"}},
        {&pressure_names, {"p\xe1\xb5\xa3"}},
        {&potential_temperature_names, {"\xce\xb8"}}},
       {},
       {"\xce\xb8\xcb\xa1", "\xce\xb8\xcb\xa1\xe2\x81\xb1"}},
      {"cm1",
       "CM1",
       {"cm1"},
       {{"prs", "th"}},
       {{&water_names, {"qc"}}, {&pressure_names, {"prs"}}, {&potential_temperature_names, {"th"}}},
       {},
       {},
       {"zhval", "zh"}},
      {"uclales",
       "UCLALES",
       {"uclales"},
       {{"l", "dn0"}},
       {{&water_names, {"l"}}, {&rain_names, {"r"}}, {&air_density_names, {"dn0"}}, {&pressure_names, {"p"}}},
       {},
       {"t"}},
      {"dales",
       "DALES",
       {"dales"},
       {{"ql", "thl", "zt"}, {"ql", "rhobf"}},
       {{&water_names, {"ql"}}, {&air_density_names, {"rhobf", "rhof"}}, {&pressure_names, {"presf", "presh"}}},
       {},
       {"thl"}},
      {"sam",
       "SAM",
       {"sam "},
       {{"QN", "TABS"}, {"QC", "TABS"}, {"QN", "QI"}},
       {{&water_names, {"QC", "QN"}}, {&pressure_names, {"p"}}, {&temperature_names, {"TABS"}}},
       {},
       {}},
      {"microhh",
       "MicroHH",
       {"microhh"},
       {{"rhoref", "ql"}, {"phydro", "ql"}},
       {{&water_names, {"ql"}}, {&air_density_names, {"rhoref"}}, {&pressure_names, {"phydro"}}},
       {{&pressure_names, {"p"}}},  // the perturbation over the density
       {"thl"}}};
  return all;
}

std::string attribute_that_says(const NetcdfInput& input, const Names& titles) {
  for (const char* attribute : {"title", "TITLE", "source", "model", "model_name", "CM1 version"}) {
    const std::string text = lower_case(input.global_text(attribute)) + " ";
    for (const std::string& title : titles) {
      const auto at = text.find(title);
      const bool begins_a_word = at != std::string::npos && (at == 0 || text[at - 1] < 'a' || text[at - 1] > 'z');
      if (begins_a_word) return attribute;
    }
  }
  return "";
}

bool has_variable_or_dimension(const NetcdfInput& input, const std::string& name) {
  return std::any_of(input.variables().begin(), input.variables().end(), [&](const NetcdfVariable& variable) {
    return variable.name == name ||
           std::find(variable.dimension.begin(), variable.dimension.end(), name) != variable.dimension.end();
  });
}

/// The names of water in a model, its own and those of the vocabulary.
Names names_of_water(const LesModel& model) {
  Names names;
  for (const Words* words : {&water_names, &ice_names, &rain_names, &snow_names, &graupel_names}) {
    Names own = model.names_of(*words);
    if (own.empty() && words != &water_names) own = words->names;
    names.insert(names.end(), own.begin(), own.end());
  }
  return names;
}

}  // namespace

Names LesModel::names_of(const Words& words) const {
  for (const auto& [of, list] : names) {
    if (of == &words) return list;
  }
  return {};
}

bool LesModel::means_other(const Words& words, const std::string& variable) const {
  return std::any_of(others.begin(), others.end(), [&](const auto& entry) {
    return entry.first == &words && std::find(entry.second.begin(), entry.second.end(), variable) != entry.second.end();
  });
}

const std::vector<std::string>& les_model_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const LesModel& model : models()) list.emplace_back(model.name);
    std::sort(list.begin(), list.end());
    return list;
  }();
  return names;
}

const LesModel* recognised_model(const NetcdfInput& input, const CloudImportOptions& options, std::string& evidence) {
  const std::string& given = options.model;
  if (given != "auto") {
    const auto named =
        std::find_if(models().begin(), models().end(), [&](const LesModel& m) { return given == m.name; });
    if (named == models().end()) {
      throw InputError(
          fmt::format("--model: unknown (found \"{}\", allowed auto, {})", given, fmt::join(les_model_names(), ", ")));
    }
    const Names water = names_of_water(*named);
    if (options.variable.empty() && options.quantity != "extinction" &&
        std::none_of(water.begin(), water.end(),
                     [&](const std::string& name) { return input.find(name) != nullptr; })) {
      fail_import(options.file,
                  "no water of the model that --model names, {} (found none of {}); leave out --model, or name the "
                  "variable with --variable",
                  named->title, fmt::join(water, ", "));
    }
    evidence = "as --model says";
    return &*named;
  }
  for (const LesModel& model : models()) {
    if (const std::string attribute = attribute_that_says(input, model.titles); !attribute.empty()) {
      evidence = fmt::format("the file's attribute {} says so", attribute);
      return &model;
    }
  }
  for (const LesModel& model : models()) {
    for (const Names& list : model.signature) {
      if (!std::all_of(list.begin(), list.end(),
                       [&](const auto& name) { return has_variable_or_dimension(input, name); }))
        continue;
      evidence = fmt::format("by the names '{}'", fmt::join(list, "', '"));
      return &model;
    }
  }
  return nullptr;
}

}  // namespace cloudbow
