// A VDB file opened strictly: every grid is known by name, type, metadata and transform before any voxel takes memory.
// OpenVDB's own io::File accepts truncated files, and io::Stream loads every grid before its metadata can be seen.
#pragma once

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace cloudbow {

class VdbInput : private openvdb::io::Archive {
 public:
  struct Entry {
    std::string name;
    std::string type;             ///< "float", "float stored as half", or OpenVDB's own name
    openvdb::GridBase::Ptr grid;  ///< metadata and transform; the tree is empty until load()
    bool is_loaded = false;
    openvdb::io::GridDescriptor descriptor;
    std::streamoff data_begin = 0;
  };

  /// @param wanted the grid that load() will read: the others of a file without offsets are read and discarded.
  /// @throws InputError: missing, a directory, not OpenVDB, truncated or damaged.
  VdbInput(const std::filesystem::path& path, const std::string& wanted);

  const std::vector<Entry>& entries() const { return entries_; }

  /// The grid of this name with its metadata and transform. @throws InputError that lists the grids there.
  const Entry& find(const std::string& name) const;

  /// Reads the tree. @throws InputError if the grid is not of floats, shares another grid's tree, or is damaged.
  openvdb::FloatGrid::ConstPtr load(const Entry& entry);

 private:
  void walk(const std::string& wanted);
  template <class Function>
  void reading(Function function) const;

  std::filesystem::path path_;
  std::uint64_t bytes_ = 0;
  openvdb::io::StreamMetadata::Ptr stream_metadata_{
      new openvdb::io::StreamMetadata};  ///< the stream points here: outlives it
  std::ifstream stream_;
  std::vector<Entry> entries_;
};

}  // namespace cloudbow
