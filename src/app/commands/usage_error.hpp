// What is told of a command line that cannot be read.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace cloudbow {

/// For a word that nobody knows: what is known there, and what may have been meant; else as the parser says it.
/// @param app after its parse() threw the error
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace cloudbow
