#include "app/commands/usage_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "app/process/suggestion.hpp"

namespace cloudbow {
namespace {

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Suggestion for an inner command given without its outer one, as "info" for "cloud info".
std::string suggest_inner(const CLI::App& app, const std::string& word) {
  for (const CLI::App* command : app.get_subcommands({}))
    for (const std::string& inner : command_names(*command))
      if (inner == word) return fmt::format("; did you mean {} {}?", command->get_name(), inner);
  return "";
}

/// Message about the first unknown or surplus word; empty if there is none.
/// @param path of the command: "", "run: ", "cloud make: "
std::string unknown_word(const CLI::App& app, const std::string& path) {
  const std::vector<std::string> words = app.remaining();
  const std::vector<std::string> commands = command_names(app);
  if (!words.empty()) {
    const std::string word = words.front().substr(0, words.front().find('='));
    if (word.starts_with('-')) {
      return fmt::format("{}unknown option (found {}, allowed {})", path, word,
                         candidates_for(word, option_names(app)));
    }
    if (commands.empty()) return fmt::format("{}a word too many (found {})", path, word);
    return fmt::format("{}unknown command (found {}, allowed {}{})", path, word, candidates_for(word, commands),
                       suggest_inner(app, word));
  }
  for (const CLI::App* command : app.get_subcommands())
    return unknown_word(*command, fmt::format("{}{}: ", path.empty() ? "" : path.substr(0, path.size() - 2) + " ",
                                              command->get_name()));
  return commands.empty() ? "" : fmt::format("{}no command (found none, allowed {})", path, fmt::join(commands, ", "));
}

}  // namespace

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
  const int code = error.get_exit_code();
  const bool about_words =
      code == static_cast<int>(CLI::ExitCodes::ExtrasError) || code == static_cast<int>(CLI::ExitCodes::RequiredError);
  const std::string unknown = about_words ? unknown_word(app, "") : "";
  return unknown.empty() ? error.what() : unknown;
}

}  // namespace cloudbow
