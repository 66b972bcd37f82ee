// Where a command may write. Every writer asks here before it begins.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace cloudbow {

struct OutputFile {
  std::filesystem::path path;  ///< empty: not written
  std::string use;             ///< as messages name it: "the result"
};

/// Whether two paths lead to one file, there or yet to come: through links, another spelling of the path, or, for files
/// to come, the letters' case.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// @throws InputError if an output is an input or another output under any name.
void check_distinct(std::span<const OutputFile> outputs, std::span<const std::filesystem::path> inputs);

/// Reports before a long computation whether a file could be written: makes and removes a temporary file beside the
/// target and leaves an existing target alone.
/// @throws InputError naming the file: no such folder, no permission, the target is a directory or another kind of
/// special file.
void check_writable(const std::filesystem::path& file);

/// Both, of each output.
void check_outputs(const std::vector<OutputFile>& outputs, std::span<const std::filesystem::path> inputs = {});

}  // namespace cloudbow
