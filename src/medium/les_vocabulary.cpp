#include "les_vocabulary.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <string_view>
#include <utility>

namespace cloudbow {

const Words water_names{{"QC", "qc", "QCLOUD", "qcloud", "RCT", "rct", "QL", "ql", "LWC", "lwc", "clw", "CLW", "QN",
                         "rl", "RL", "l", "q_l", "q_cloud_liquid_mass", "q\xcb\xa1"},
                        {"mass_fraction_of_cloud_liquid_water_in_air", "cloud_liquid_water_mixing_ratio",
                         "mass_concentration_of_cloud_liquid_water_in_air"}};
const Words extinction_names{{"extinction", "ext", "EXT", "beta_ext", "extinction_coefficient", "kext"}, {}};
const Words air_density_names{
    {"RHO", "rho", "DN0", "dn0", "rho0", "RHO0", "rhobf", "rhon", "rho_air", "air_density", "density", "RHODREF"},
    {"air_density"}};
const Words pressure_names{{"p", "P", "PRES", "pres", "pressure", "PABST", "PABS", "prs", "presh", "p0"},
                           {"air_pressure"}};
const Words temperature_names{{"T", "t", "TABS", "tabs", "TEMP", "temp", "ta", "temperature", "air_temperature", "tk"},
                              {"air_temperature"}};
const Words potential_temperature_names{{"th", "TH", "THT", "theta", "THETA", "pt", "PT", "potential_temperature"},
                                        {"air_potential_temperature"}};
const Words droplet_number_names{
    {"NC", "nc", "NDROP", "ndrop", "QNCLOUD", "CDNC", "cdnc", "Nc", "ncloud", "q_cloud_liquid_number"},
    {"number_concentration_of_cloud_liquid_water_particles_in_air"}};
const Words effective_radius_names{
    {"REFF", "reff", "RE", "re", "REL", "rel", "effective_radius", "re_cloud"},
    {"effective_radius_of_cloud_liquid_water_particles", "effective_radius_of_cloud_liquid_water_particle"}};
const Words scattering_albedo_names{{"ssa", "SSA", "single_scattering_albedo"}, {}};

const Words liquid_potential_temperature_names{{"thl", "THL", "thetal", "theta_l", "THETAL"}, {}};
const Words exner_names{{"PI", "EXNER", "exner", "exnf", "pii"}, {"dimensionless_exner_function"}};

const Words ice_names{{"QI", "qi", "QICE", "qice", "RIT", "rit", "cli", "CLI", "q_i", "ri", "q_ice_mass"},
                      {"mass_fraction_of_cloud_ice_in_air", "cloud_ice_mixing_ratio"}};
const Words rain_names{{"QR", "qr", "QRAIN", "qrain", "RRT", "rrt", "rr", "q_rain_mass"}, {}};
const Words precipitation_names{{"QP", "qp"}, {}};
const Words snow_names{{"QS", "qs", "QSNOW", "qsnow", "RST", "rst", "q_snow_mass"}, {}};
const Words graupel_names{{"QG", "qg", "QGRAUP", "qgraup", "RGT", "rgt", "q_graupel_mass"}, {}};
const Words hail_names{{"QH", "qh", "QHAIL", "qhail", "RHT", "RHP"}, {}};
const Words aggregates_names{{"RAP"}, {}};
const Words ice_radius_names{{"RE_ICE", "re_ice", "reff_ice", "REFF_ICE", "rei", "REI", "reffi", "REFFI"},
                             {"effective_radius_of_cloud_ice_particles", "effective_radius_of_cloud_ice_particle"}};
const Words rain_radius_names{{"RE_RAIN", "re_rain", "reff_rain", "REFF_RAIN"}, {"effective_radius_of_rain_particles"}};
const Words snow_radius_names{{"RE_SNOW", "re_snow", "reff_snow", "REFF_SNOW"}, {"effective_radius_of_snow_particles"}};
const Words graupel_radius_names{{"RE_GRAUPEL", "re_graupel", "reff_graupel", "REFF_GRAUPEL"}, {}};
const Names condensate_names{"QN"};
const std::vector<Species> species_names{
    {"cloud ice", &ice_names, "ice", "ice_water_content", "reff_ice", &ice_radius_names},
    {"rain", &rain_names, "rain", "rain_water_content", "reff_rain", &rain_radius_names},
    {"precipitation", &precipitation_names},
    {"snow", &snow_names, "snow", "snow_water_content", "reff_snow", &snow_radius_names},
    {"graupel", &graupel_names, "graupel", "graupel_water_content", "reff_graupel", &graupel_radius_names},
    {"hail", &hail_names},
    {"aggregates", &aggregates_names}};

const Names heights_names{"z_ifc", "HHL", "z_mc", "HFL", "z", "zt", "height", "altitude", "z_t", "zu", "ZHAT", "ALT"};

const UnitTable ratio_units{"kg/kg, g/kg, mg/kg",
                            {{"kg/kg", 1},
                             {"kgkg-1", 1},
                             {"g/kg", 1e-3},
                             {"gkg-1", 1e-3},
                             {"mg/kg", 1e-6},
                             {"mgkg-1", 1e-6},
                             {"g/g", 1},
                             {"gg-1", 1}}};
const UnitTable content_units{
    "kg/m3, g/m3, mg/m3", {{"kg/m3", 1e3}, {"kgm-3", 1e3}, {"g/m3", 1}, {"gm-3", 1}, {"mg/m3", 1e-3}, {"mgm-3", 1e-3}}};
const UnitTable extinction_units{"1/m, 1/km",
                                 {{"1/m", 1}, {"m-1", 1}, {"/m", 1}, {"1/km", 1e-3}, {"km-1", 1e-3}, {"/km", 1e-3}}};
const UnitTable length_units{"m, km",
                             {{"m", 1},
                              {"meter", 1},
                              {"meters", 1},
                              {"metre", 1},
                              {"metres", 1},
                              {"km", 1e3},
                              {"kilometer", 1e3},
                              {"kilometers", 1e3},
                              {"kilometre", 1e3},
                              {"kilometres", 1e3}}};
const UnitTable geopotential_units{"m2/s2", {{"m2/s2", 1}, {"m2s-2", 1}}};
const UnitTable angle_units{"degree",
                            {{"degree", 1},
                             {"degrees", 1},
                             {"degreesnorth", 1},
                             {"degreesN", 1},
                             {"degreenorth", 1},
                             {"degreeN", 1},
                             {"degreeseast", 1},
                             {"degreesE", 1},
                             {"degreeeast", 1},
                             {"degreeE", 1}}};
const UnitTable exner_units{
    "1, J/(kg K)", {{"1", 1}, {"-", 1}, {"J/kg/K", 1.0 / 1004}, {"Jkg-1K-1", 1.0 / 1004}, {"J/kgK", 1.0 / 1004}}};
const UnitTable density_units{"kg/m3, g/m3", {{"kg/m3", 1}, {"kgm-3", 1}, {"g/m3", 1e-3}, {"gm-3", 1e-3}}};
const UnitTable pressure_units{"Pa, hPa, mb",
                               {{"Pa", 1},
                                {"pascal", 1},
                                {"pascals", 1},
                                {"hPa", 100},
                                {"hectopascal", 100},
                                {"hectopascals", 100},
                                {"mb", 100},
                                {"mbar", 100},
                                {"millibar", 100},
                                {"millibars", 100}}};
const UnitTable kelvin_units{"K, degC", {{"K", 1}, {"kelvin", 1}, {"degK", 1}, {"degreeK", 1}, {"degreesK", 1}}};
const UnitTable celsius_units{"K, degC",
                              {{"degC", 1},
                               {"C", 1},
                               {"degreeC", 1},
                               {"degreesC", 1},
                               {"celsius", 1},
                               {"degreecelsius", 1},
                               {"degreescelsius", 1},
                               {"degcelsius", 1},
                               {"\xc2\xb0"
                                "C",
                                1}}};
const UnitTable number_per_volume_units{"1/m3, 1/cm3",
                                        {{"1/m3", 1},
                                         {"m-3", 1},
                                         {"#/m3", 1},
                                         {"#m-3", 1},
                                         {"1/cm3", 1e6},
                                         {"cm-3", 1e6},
                                         {"#/cm3", 1e6},
                                         {"#cm-3", 1e6},
                                         {"/cm3", 1e6},
                                         {"/m3", 1}}};
const UnitTable number_per_mass_units{"1/kg, 1/g, 1/mg",
                                      {{"1/kg", 1},
                                       {"kg-1", 1},
                                       {"#/kg", 1},
                                       {"#kg-1", 1},
                                       {"/kg", 1},
                                       {"1/g", 1e3},
                                       {"g-1", 1e3},
                                       {"1/mg", 1e6},
                                       {"mg-1", 1e6},
                                       {"#/mg", 1e6}}};
const UnitTable radius_units{"um, m",
                             {{"um", 1},
                              {"micron", 1},
                              {"microns", 1},
                              {"micrometer", 1},
                              {"micrometers", 1},
                              {"micrometre", 1},
                              {"micrometres", 1},
                              {"m", 1e6},
                              {"meter", 1e6},
                              {"metre", 1e6}}};

namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }

/// Without what does not count, and with ASCII letters for signs of UTF-8.
std::string plain_unit(std::string spelled) {
  constexpr std::array<std::pair<const char*, const char*>, 7> signs{{{"\xc2\xb5", "u"},      // micro
                                                                      {"\xce\xbc", "u"},      // Greek mu
                                                                      {"\xc2\xb7", ""},       // middle dot
                                                                      {"\xe2\x81\xbb", "-"},  // superscript minus
                                                                      {"\xc2\xb9", "1"},      // superscripts
                                                                      {"\xc2\xb2", "2"},
                                                                      {"\xc2\xb3", "3"}}};
  for (const auto& [sign, ascii] : signs) {
    for (auto at = spelled.find(sign); at != std::string::npos; at = spelled.find(sign)) {
      spelled.replace(at, std::string_view(sign).size(), ascii);
    }
  }
  std::string plain;
  for (const char c : spelled) {
    if (std::string_view(" \t^*_.()[]{}").find(c) == std::string_view::npos) plain += c;
  }
  return plain;
}

/// Whether the letter begins a short unit, as the m of "mg" and "mbar" does: there m is milli and M mega.
bool is_prefix(const std::string& unit, std::size_t at) {
  if (at > 0 && is_letter(unit[at - 1])) return false;
  std::size_t length = 0;
  while (at + length < unit.size() && is_letter(unit[at + length])) ++length;
  return length > 1 && length < 5;
}

bool is_same_unit(const std::string& plain, const std::string& known) {
  if (lower_case(plain) != lower_case(known)) return false;
  for (std::size_t n = 0; n < plain.size(); ++n) {
    if (known[n] == 'm' && plain[n] == 'M' && is_prefix(known, n)) return false;
  }
  return true;
}

}  // namespace

std::optional<double> factor_of(const UnitTable& table, const std::string& spelled) {
  // A number before the unit: not the 1 of "1/m3", and not a sum like "10-3".
  double number = 1;
  std::string rest = spelled;
  const auto begin = spelled.find_first_not_of(' ');
  if (begin != std::string::npos) {
    double value = 0;
    const auto [end, error] = std::from_chars(spelled.data() + begin, spelled.data() + spelled.size(), value);
    const std::string after(error == std::errc() ? end : spelled.data(), spelled.data() + spelled.size());
    const auto letter = after.find_first_not_of(" *");
    if (error == std::errc() && value > 0 && value < 1e30 && letter != std::string::npos && is_letter(after[letter])) {
      number = value;
      rest = after;
    }
  }
  const std::string plain = plain_unit(rest);
  for (const Unit& unit : table.units) {
    if (is_same_unit(plain, unit.spelling)) return number * unit.factor;
  }
  return std::nullopt;
}

bool is_unit_given(const std::string& units) {
  const std::string plain = lower_case(plain_unit(units));
  return !plain.empty() && plain != "1" && plain != "-" && plain != "none" && plain != "dimensionless";
}

int axis_of_name(const std::string& name) {
  const std::string lower = lower_case(name);
  for (const char* known : {"west_east", "ni", "nx", "longitude", "lon", "rlon"}) {
    if (lower == known) return 0;
  }
  for (const char* known : {"south_north", "nj", "ny", "latitude", "lat", "rlat"}) {
    if (lower == known) return 1;
  }
  for (const char* known : {"lev", "level", "levels", "height", "altitude", "bottom_top", "nk", "nz", "plev", "layer",
                            "pressure_level", "model_level", "hybrid", "isobaricinhpa"}) {
    if (lower == known) return 2;
  }
  if (lower.starts_with("height_") && lower.find_first_not_of("0123456789", 7) == std::string::npos) return 2;  // ICON
  if (lower.starts_with("time") || lower == "valid_time" || lower == "t" || lower == "nt" || lower == "record")
    return 3;
  switch (lower[0]) {
    case 'x':
      return 0;
    case 'y':
      return 1;
    case 'z':
      return 2;
    default:
      return -1;
  }
}

bool axis_is_angle(const std::string& name) {
  const std::string lower = lower_case(name);
  return lower.find("lon") != std::string::npos || lower.find("lat") != std::string::npos;
}

}  // namespace cloudbow
