#include "les_vocabulary.hpp"

#include <algorithm>
#include <cctype>

namespace cloudbow {

const Names kWater{"QC",  "qc",  "QCLOUD", "qcloud", "RCT", "rct", "QL", "ql",  "LWC",
                   "lwc", "clw", "CLW",    "QN",     "rl",  "RL",  "l",  "q_l", "q_cloud_liquid_mass"};
const Names kAirDensity{"RHO",   "rho",  "DN0",     "dn0",         "rho0",   "RHO0",
                        "rhobf", "rhon", "rho_air", "air_density", "density"};
const Names kPressure{"p", "P", "PRES", "pres", "pressure", "PABST", "PABS", "presh", "p0"};
const Names kTemperature{"T", "t", "TABS", "tabs", "TEMP", "temp", "ta", "temperature", "air_temperature", "tk"};
const Names kDropletNumber{"NC",   "nc",   "NDROP", "ndrop",  "QNCLOUD",
                           "CDNC", "cdnc", "Nc",    "ncloud", "q_cloud_liquid_number"};
const Names kEffectiveRadius{"REFF", "reff", "RE", "re", "REL", "rel", "effective_radius", "re_cloud"};

const UnitTable kRatio{"kg/kg, g/kg, mg/kg",
                       {{"kg/kg", 1},
                        {"kgkg-1", 1},
                        {"g/kg", 1e-3},
                        {"gkg-1", 1e-3},
                        {"mg/kg", 1e-6},
                        {"mgkg-1", 1e-6},
                        {"g/g", 1},
                        {"gg-1", 1}}};
const UnitTable kContent{"kg/m3, g/m3, mg/m3",  // in g/m3
                         {{"kg/m3", 1e3}, {"kgm-3", 1e3}, {"g/m3", 1}, {"gm-3", 1}, {"mg/m3", 1e-3}, {"mgm-3", 1e-3}}};
const UnitTable kLength{
    "m, km", {{"m", 1}, {"meter", 1}, {"meters", 1}, {"metre", 1}, {"metres", 1}, {"km", 1e3}, {"kilometers", 1e3}}};
const UnitTable kDensity{"kg/m3, g/m3", {{"kg/m3", 1}, {"kgm-3", 1}, {"g/m3", 1e-3}, {"gm-3", 1e-3}}};
const UnitTable kPressureUnits{
    "Pa, hPa, mb", {{"Pa", 1}, {"pa", 1}, {"hPa", 100}, {"hpa", 100}, {"mb", 100}, {"mbar", 100}, {"millibar", 100}}};
const UnitTable kTemperatureUnits{"K", {{"K", 1}, {"kelvin", 1}, {"Kelvin", 1}, {"degK", 1}}};
const UnitTable kNumberPerVolume{"1/m3, 1/cm3",
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
const UnitTable kNumberPerMass{"1/kg, 1/g, 1/mg",
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
const UnitTable kRadius{"um, m",
                        {{"um", 1},
                         {"micron", 1},
                         {"microns", 1},
                         {"micrometer", 1},
                         {"micrometers", 1},
                         {"\xc2\xb5m", 1},
                         {"\xce\xbcm", 1},
                         {"m", 1e6}}};

std::optional<double> factor_of(const UnitTable& table, const std::string& spelled) {
  std::string plain;
  for (const char c : spelled) {
    if (c != ' ' && c != '^' && c != '*' && c != '_' && c != '.') plain += c;
  }
  for (const Unit& unit : table.units) {
    if (plain == unit.spelling) return unit.factor;
  }
  return std::nullopt;
}

bool is_unit_given(const std::string& units) {
  return !units.empty() && units != "1" && units != "-" && units != "none";
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

int axis_of_name(const std::string& name) {
  const std::string lower = lower_case(name);
  for (const char* known : {"west_east", "ni", "nx", "longitude", "lon"}) {
    if (lower == known) return 0;
  }
  for (const char* known : {"south_north", "nj", "ny", "latitude", "lat"}) {
    if (lower == known) return 1;
  }
  for (const char* known :
       {"lev", "level", "levels", "height", "altitude", "bottom_top", "nk", "nz", "plev", "layer"}) {
    if (lower == known) return 2;
  }
  if (lower.starts_with("time") || lower == "t" || lower == "nt" || lower == "record") return 3;
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

}  // namespace cloudbow
