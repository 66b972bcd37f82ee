// Layouts of models: how their files are recognised, and what names mean in them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "les_vocabulary.hpp"

namespace cloudbow {

class NetcdfInput;
struct CloudImportOptions;

/// Names by quantity.
using NamesOfWords = std::vector<std::pair<const Words*, Names>>;

struct LesModel {
  const char* name;              ///< as --model has it
  const char* title;             ///< as messages have it
  Names titles;                  ///< in the file's attributes title, TITLE, source or model, in lower case
  std::vector<Names> signature;  ///< all variables or dimensions of one of these lists are there
  NamesOfWords names;            ///< of its variables, tried before all others
  NamesOfWords others;           ///< names that mean something else than usual, and are not tried
  Names liquid_potential;        ///< liquid water potential temperature, whatever the name suggests
  Names heights{};               ///< of all cells: a coordinate of levels holds over flat ground alone

  Names names_of(const Words& words) const;
  bool means_other(const Words& words, const std::string& variable) const;
};

/// The model of the options, or the one that the files show; null if they show none.
/// @param evidence what showed it. @throws InputError if the option names a model whose water the files lack
const LesModel* recognised_model(const NetcdfInput& input, const CloudImportOptions& options, std::string& evidence);

}  // namespace cloudbow
