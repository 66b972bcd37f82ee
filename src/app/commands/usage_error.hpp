// Messages about a command line that cannot be read.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace cloudbow {

/// For an unknown word: the words allowed there, and the one probably meant. Otherwise the message of the parser.
/// @param app after its parse() threw the error
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace cloudbow
