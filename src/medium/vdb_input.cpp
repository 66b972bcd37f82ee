#include "vdb_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <iterator>
#include <new>
#include <string_view>
#include <system_error>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"

namespace cloudbow {

namespace {

std::string type_name(const openvdb::io::GridDescriptor& descriptor, const openvdb::GridBase& grid) {
  if (!grid.isType<openvdb::FloatGrid>()) return grid.isType<openvdb::DoubleGrid>() ? "double" : descriptor.gridType();
  return descriptor.saveFloatAsHalf() ? "float stored as half" : "float";
}

/// Kind of a file that is not OpenVDB, from its first bytes.
std::string kind_of(const std::array<char, 8>& first) {
  const std::string_view bytes(first.data(), first.size());
  if (bytes == std::string_view("\x89HDF\r\n\x1a\n")) return "those of HDF5 or netCDF-4";
  if (bytes.substr(0, 3) == "CDF" && (bytes[3] == 1 || bytes[3] == 2 || bytes[3] == 5)) return "those of netCDF";
  return "not OpenVDB's mark";
}

std::string without_final_period(std::string text) {
  while (!text.empty() && (text.back() == '.' || text.back() == '\n')) text.pop_back();
  return text;
}

}  // namespace

template <class Function>
void VdbInput::reading(Function function) const {
  try {
    function();
  } catch (const InputError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::ios_base::failure&) {
    throw InputError(fmt::format(
        "{}: the file is truncated or damaged (it ends at byte {} before its grids do); get a complete copy",
        path_.string(), bytes_));
  } catch (const std::exception& error) {
    throw InputError(fmt::format("{}: the file is damaged or of an unknown kind of OpenVDB (the library says: {})",
                                 path_.string(), without_final_period(error.what())));
  }
}

VdbInput::VdbInput(const std::filesystem::path& path, const std::string& wanted) : path_(path) {
  stream_ = open_input(path, "an OpenVDB file");
  bytes_ = std::filesystem::file_size(path);

  std::array<char, 8> first{};
  stream_.read(first.data(), first.size());
  std::int64_t magic = 0;
  std::memcpy(&magic, first.data(), first.size());
  if (!stream_ || magic != openvdb::OPENVDB_MAGIC) {
    throw InputError(fmt::format(
        "{}: not an OpenVDB file (its first bytes are {}); `cloudbow cloud import {} -o cloud.vdb` makes one "
        "of LES output (netCDF), SHDOM files and text",
        path.string(), kind_of(first), path.string()));
  }
  stream_.clear();
  stream_.seekg(0);
  stream_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  openvdb::initialize();
  reading([&] { walk(wanted); });
}

// The order of the reads follows openvdb::io::Stream and openvdb::io::File::readGridMetadata.
void VdbInput::walk(const std::string& wanted) {
  readHeader(stream_);
  openvdb::io::setStreamMetadataPtr(stream_, stream_metadata_, /*transfer=*/false);
  openvdb::io::setVersion(stream_, libraryVersion(), fileVersion());
  openvdb::io::setDataCompression(stream_, compression());
  openvdb::MetaMap().readMeta(stream_);

  const std::int32_t grids = readGridCount(stream_);
  for (std::int32_t g = 0; g < grids; ++g) {
    Entry entry;
    entry.grid = entry.descriptor.read(stream_);
    entry.name = openvdb::io::GridDescriptor::nameAsString(entry.descriptor.uniqueName());
    entry.type = type_name(entry.descriptor, *entry.grid);

    const auto begin =
        inputHasGridOffsets() ? entry.descriptor.getGridPos() : static_cast<std::streamoff>(stream_.tellg());
    const auto end = entry.descriptor.getEndPos();
    if (inputHasGridOffsets() && (begin < stream_.tellg() || end < begin || static_cast<std::uint64_t>(end) > bytes_)) {
      throw InputError(
          fmt::format("{}: the file is truncated or damaged (grid \"{}\" should end at byte {}, the file at {}); "
                      "get a complete copy",
                      path_.string(), entry.name, end, bytes_));
    }
    entry.data_begin = begin;
    stream_.seekg(begin);
    readGridCompression(stream_);
    entry.grid->readMeta(stream_);
    entry.grid->readTransform(stream_);

    if (inputHasGridOffsets()) {
      stream_.seekg(end);
    } else if (!entry.descriptor.isInstance()) {
      const auto whole = openvdb::GridBase::createGrid(entry.descriptor.gridType());
      stream_.seekg(begin);
      readGrid(whole, entry.descriptor, stream_);
      if (entry.name == wanted) {
        entry.grid = whole;
        entry.is_loaded = true;
      }
    }
    entries_.push_back(std::move(entry));
  }
}

const VdbInput::Entry& VdbInput::find(const std::string& name) const {
  const auto named = [&](const Entry& entry) { return entry.name == name; };
  const auto found = std::find_if(entries_.begin(), entries_.end(), named);
  if (found != entries_.end() && std::none_of(std::next(found), entries_.end(), named)) return *found;
  std::string there, twins;
  for (const auto& entry : entries_) {
    there += fmt::format("{}\"{}\" ({})", there.empty() ? "" : ", ", entry.name, entry.type);
    if (entry.descriptor.gridName() == name) twins += fmt::format("{}\"{}\"", twins.empty() ? "" : ", ", entry.name);
  }
  if (found != entries_.end()) {
    throw InputError(fmt::format("{}: grid \"{}\" is there more than once ({}) give each a name of its own",
                                 path_.string(), name, there));
  }
  throw InputError(fmt::format("{}: no grid \"{}\" ({}){}", path_.string(), name,
                               there.empty() ? "the file holds no grid" : "grids in the file: " + there,
                               twins.empty() ? "" : fmt::format(" several have this name: choose one of {}", twins)));
}

openvdb::FloatGrid::ConstPtr VdbInput::load(const Entry& entry) {
  if (!entry.grid->isType<openvdb::FloatGrid>()) {
    throw InputError(
        fmt::format("{}: grid \"{}\" has the wrong type ({}; float, also stored as half, is allowed); "
                    "convert it to float, or name another grid",
                    path_.string(), entry.name, entry.type));
  }
  if (entry.descriptor.isInstance()) {
    throw InputError(fmt::format("{}: grid \"{}\" has no voxels of its own (it shares those of \"{}\") name that grid",
                                 path_.string(), entry.name,
                                 openvdb::io::GridDescriptor::nameAsString(entry.descriptor.instanceParentName())));
  }
  if (entry.is_loaded) return openvdb::gridConstPtrCast<openvdb::FloatGrid>(entry.grid);
  const auto whole = openvdb::FloatGrid::create();
  reading([&] {
    stream_.seekg(entry.data_begin);
    readGrid(whole, entry.descriptor, stream_);
  });
  return whole;
}

}  // namespace cloudbow
