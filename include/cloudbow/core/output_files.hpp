// Checks of the files that a command may write. Every writer calls them before it begins.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace cloudbow {

/// Kind of an output; each has its endings, in one table (output_files.cpp).
enum class OutputKind { any, hdf5, checkpoint, vdb, csv, plot, picture };

struct OutputFile {
  std::filesystem::path path;  ///< empty: not written
  std::string use;             ///< as messages name it: "the result"
  OutputKind kind = OutputKind::any;
};

/// The ending of a name in small letters, ".h5"; empty if there is none. Digits alone are none: "depth_0.5".
std::string name_ending(const std::filesystem::path& file);

/// @throws InputError if the name has an ending that is not of this kind: readers choose the format by it. A name
/// without ending is allowed.
void check_ending(const OutputFile& output);

/// Whether two paths lead to one file, existing or not yet written: through links, another spelling of the path, or,
/// for files not yet written, the letters' case.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// @throws InputError if an output is an input or another output under any name. Also if it has the ending of another
/// kind.
void check_distinct(std::span<const OutputFile> outputs, std::span<const std::filesystem::path> inputs);

/// Reports before a long computation whether a file could be written: makes and removes a temporary file beside the
/// target and leaves an existing target alone.
/// @throws InputError naming the file: no such folder, no permission, the target is a directory or another kind of
/// special file.
void check_writable(const std::filesystem::path& file);

/// Both, of each output.
void check_outputs(const std::vector<OutputFile>& outputs, std::span<const std::filesystem::path> inputs = {});

}  // namespace cloudbow
