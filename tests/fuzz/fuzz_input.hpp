// Shared by the fuzz targets: a mutant as a file, and what a reader may do with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace cloudbow::fuzz {

/// A folder of this process, gone at its end.
const std::filesystem::path& folder();

/// Writes the mutant into the folder. @returns its path.
std::filesystem::path write_mutant(std::span<const std::uint8_t> bytes, const std::string& name);

/// Runs a reader. It may throw InputError, with a message that is not empty; anything else ends the fuzzing. Mutants
/// whose reading ended in a child process are counted: the sum is printed at the end.
void expect_clean(const std::function<void()>& read);

}  // namespace cloudbow::fuzz
