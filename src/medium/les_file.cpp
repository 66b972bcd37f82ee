#include "les_file.hpp"

#include <algorithm>

namespace cloudbow {

LesFile::LesFile(const CloudImportOptions& import_options)
    : options(import_options), input(import_options.file, import_options.with) {
  std::string evidence;
  model = recognised_model(input, options, evidence);
  if (model != nullptr) note("model: {} ({})", model->title, evidence);
}

std::string LesFile::described(const NetcdfVariable& variable, const std::string& units) {
  std::string shape;
  for (std::size_t n = 0; n < variable.length.size(); ++n) {
    shape += fmt::format("{}{} = {}", n == 0 ? "" : ", ", variable.dimension[n], variable.length[n]);
  }
  return fmt::format("'{}' ({}) [{}]", variable.name, shape, units.empty() ? "unit not said" : units);
}

std::string LesFile::fields_there() const {
  std::string names;
  int count = 0;
  for (const NetcdfVariable& variable : input.variables()) {
    if (variable.length.size() < 2) continue;
    if (++count > 30) return names + ", ...";
    names += (names.empty() ? "" : ", ") + variable.name;
  }
  return names.empty() ? "none" : names;
}

const NetcdfVariable& LesFile::named(const std::string& name, const std::string& option) const {
  const NetcdfVariable* variable = input.find(name);
  if (variable == nullptr) {
    fail("no variable '{}' (as {} says; fields in the file: {})", name, option, fields_there());
  }
  return *variable;
}

std::vector<const NetcdfVariable*> LesFile::candidates(const Words& words) const {
  const auto is_other = [&](const std::string& name) { return model != nullptr && model->means_other(words, name); };
  Names names = model == nullptr ? Names{} : model->names_of(words);
  for (const std::string& name : words.names) {
    if (std::find(names.begin(), names.end(), name) == names.end() && !is_other(name)) names.push_back(name);
  }
  std::vector<const NetcdfVariable*> found;
  for (std::size_t f = 0; f < input.files() && found.empty(); ++f) {
    for (const std::string& name : names) {
      const NetcdfVariable* variable = input.find_in(f, name);
      if (variable != nullptr && !variable->length.empty()) found.push_back(variable);
    }
  }
  if (!found.empty()) return found;
  for (const NetcdfVariable& variable : input.variables()) {
    const std::string standard_name = input.text_attribute(variable, "standard_name");
    const Names& known = words.standard_names;
    if (!variable.length.empty() && !is_other(variable.name) &&
        std::find(known.begin(), known.end(), standard_name) != known.end())
      found.push_back(&variable);
  }
  return found;
}

const NetcdfVariable* LesFile::first_of(const Words& words) const {
  const auto found = candidates(words);
  return found.empty() ? nullptr : found.front();
}

const NetcdfVariable* LesFile::find(const std::string& given, const Words& words, const std::string& option) const {
  if (!given.empty()) return &named(given, option);
  const auto found = candidates(words);
  return found.empty() ? nullptr : found.front();
}

std::string LesFile::meaning(const NetcdfVariable& variable) const {
  std::string text;
  for (const char* attribute : {"standard_name", "long_name", "longname", "description", "title"}) {
    text += ' ';
    text += lower_case(input.text_attribute(variable, attribute));
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

bool LesFile::is_perturbation(const NetcdfVariable& variable) const {
  const std::string text = meaning(variable);
  const auto has = [&text](const char* word) { return text.find(word) != std::string::npos; };
  return (has("perturb") || has("deviation") || has("anomaly")) && !has("total") && !has("full");
}

double LesFile::factor(const NetcdfVariable& variable, const UnitTable& table, double guess, const char* guessed_unit) {
  if (const auto known = factor_of(table, variable.units)) return *known;
  if (is_unit_given(variable.units))
    fail("'{}': unit not known (found '{}', allowed {})", variable.name, variable.units, table.allowed);
  note("GUESSED unit of '{}': {}", variable.name, guessed_unit);
  return guess;
}

}  // namespace cloudbow
