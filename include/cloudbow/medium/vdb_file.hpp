// Clouds in OpenVDB files: strict reading, atomic writing, a description. No OpenVDB type appears here.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// Corners of a box, along the scene's axes.
struct VdbDomain {
  std::array<double, 3> min_m{};
  std::array<double, 3> max_m{};
};

struct VdbReadOptions {
  std::string grid = "density";
  /// The axis of the file that points up: "x", "y" or "z". The field is turned, never mirrored:
  /// "y": (x, y, z) of the file becomes (x, -z, y); "x": it becomes (y, z, x).
  std::string up_axis = "z";
  /// Cell size along the scene's x, y, z (after turning) instead of the file's: the field is stretched about the
  /// world's origin.
  std::optional<std::array<double, 3>> voxel_size_m{};
  double scale = 1.0;  ///< multiplies the stored number; > 0
  /// Extent of a background other than 0, if the grid's metadata do not give it.
  std::optional<VdbDomain> domain_m{};
  /// Required metadata `quantity` of an auxiliary grid, if it has any; empty: anything.
  std::string auxiliary_quantity{};
  bool ignores_background = false;  ///< the active values alone: of a grid that describes the voxels of another
  /// Largest memory that reading may take; 0: half of the machine's.
  std::uint64_t memory_limit_bytes = 0;
};

/// The field of a grid, with its units and notes.
struct VdbCloud : CloudField {
  std::string units{};               ///< empty if the file does not say
  std::vector<std::string> notes{};  ///< decisions of reading, one sentence each with file and grid
};

/// Reads a scalar float grid (stored as float or half) as cells of constant density. The transform gives the centre of
/// voxel (i, j, k); it may scale, translate, mirror and exchange axes. Values that are active and > 0 make the field,
/// active tiles are expanded. The box is the grid's metadata domain_min_m, domain_max_m, else the bounding box of the
/// values > 0. Metadata are world coordinates, on voxel faces to 1e-3 of a voxel. A background other than 0 is the
/// value of all inactive voxels, in the box of the metadata, else in `domain_m`. Negative values down to -1e-5 of the
/// largest count as 0. `quantity` and `units` come from the metadata of these names, empty if there is none. `notes`
/// report what was decided.
/// @throws InputError, each with its own message: file missing, a directory, not OpenVDB, truncated or damaged; grid
/// missing (lists those in the file), of a name that several have, of another type, a level set, empty; too large for
/// memory_limit_bytes (checked before memory is taken); an unbounded background; transform rotated, sheared or a
/// frustum; metadata off the voxel faces or smaller than the cloud; value NaN, infinite or negative (names the voxel);
/// option out of range.
VdbCloud read_cloud_vdb(const std::filesystem::path& path, const VdbReadOptions& options = {});

/// Values of a second float grid (single-scattering albedo, effective radius) at the voxels of `cloud`, in their order.
/// `options` must be those that read the cloud, except for the name of the grid. Their `scale` multiplies this grid's
/// numbers. A background other than 0 is the value at voxels that are not active.
/// @param lowest, highest the range allowed, ends included, after scaling.
/// @throws InputError as read_cloud_vdb does. Also if the metadata contradict auxiliary_quantity; if the voxels do not
/// coincide with the cloud's; if a value is missing or out of range.
std::vector<float> read_auxiliary_vdb(const std::filesystem::path& path, const CloudField& cloud,
                                      const VdbReadOptions& options,
                                      double lowest = std::numeric_limits<double>::lowest(),
                                      double highest = std::numeric_limits<double>::max());

struct VdbWriteOptions {
  std::string grid = "density";
  bool half = false;  ///< 16 bits per value: half the size, 11 significant bits above 6.1e-5, at most 65504
};

/// A second grid on the voxels of a field.
struct VdbAuxiliary {
  std::string grid;
  std::string quantity;
  std::string units;
  std::vector<float> value;  ///< in the order of CloudField::value
};

/// A further field of a file, with grids on its voxels.
struct VdbCloudGrid {
  std::string grid;
  CloudField field;
  std::vector<VdbAuxiliary> auxiliaries;
};

/// Writes the field with metadata domain_min_m, domain_max_m, quantity, units and creator. The file has a temporary
/// name beside `path` until it is complete. Cell (0, 0, 0) is voxel (0, 0, 0). Auxiliary grids are stored as float.
/// @param others fields with other voxels of the same box, such as ice.
/// @throws InputError if the file cannot be written, or a value does not fit into half.
void write_cloud_vdb(const std::filesystem::path& path, const CloudField& field, const VdbWriteOptions& options = {},
                     const std::vector<VdbAuxiliary>& auxiliaries = {}, const std::vector<VdbCloudGrid>& others = {});

/// Positions of the voxels of fields: nx, ny, nz cells of cell_size_m from the corner min_m on, z up.
struct VdbBox {
  std::array<int, 3> cells{};
  std::array<double, 3> cell_size_m{};
  std::array<double, 3> min_m{};
};

/// Any field on some of the voxels of a box.
struct VdbField {
  std::string grid;
  std::string quantity;
  std::string units;
  std::optional<std::array<double, 3>> direction{};      ///< metadata of this name, a vec3d
  std::span<const std::array<std::int32_t, 3>> voxel{};  ///< i, j, k in the box; the others are inactive, 0
  std::vector<float> value{};                            ///< of each of these
};

/// Writes float grids one after the other, so that one at a time is in memory. They have the metadata of
/// write_cloud_vdb and of `direction`. Offsets let readers fetch single grids. Cell (0, 0, 0) is voxel (0, 0, 0). The
/// file appears under its name when it is complete.
/// @param field makes the fields 0 to count - 1, called in this order; its exceptions pass through.
/// @throws InputError if the file cannot be written.
void write_fields_vdb(const std::filesystem::path& path, const VdbBox& box, std::size_t count,
                      const std::function<VdbField(std::size_t)>& field);

/// Smallest, mean and largest of a set of numbers.
struct Spread {
  double min = 0;
  double mean = 0;
  double max = 0;
};

/// Name of vertical integrals of a quantity in these units: "optical depth" or, for each species,
/// "liquid water path [g/m2]". In other units it is "vertical integral".
std::string column_integral_name(const std::string& quantity, const std::string& units);

/// Content of a grid that is read as a cloud with z up.
struct CloudSummary {
  std::array<int, 3> cells{};
  std::array<double, 3> cell_size_m{};
  std::array<double, 3> domain_min_m{};
  std::array<double, 3> domain_max_m{};
  std::array<double, 3> cloud_min_m{};  ///< box of the values > 0
  std::array<double, 3> cloud_max_m{};
  std::size_t active_voxels = 0;  ///< values > 0
  Spread value{};                 ///< over these voxels
  double fill = 0;                ///< active_voxels / cells of the domain
  double cover = 0;               ///< columns with any active voxel / columns
  /// Vertical integral over the columns with any active voxel: optical depth for extinction [1/m], liquid water path
  /// [g/m2] for liquid_water_content [g/m3].
  Spread column{};
  std::vector<std::string> notes{};  ///< as VdbCloud::notes
};

/// One grid of a file.
struct VdbGridInfo {
  std::string name;
  std::string type;      ///< "float", "float stored as half", or OpenVDB's own name of any other type
  std::string quantity;  ///< metadata, empty if there is none
  std::string units;
  std::optional<CloudSummary> cloud;  ///< absent if the grid cannot be read as a cloud
  std::string reason;                 ///< why not: the message of read_cloud_vdb
  /// Optical depth of liquid water if another grid of the file is its effective radius: over columns with any water.
  std::optional<Spread> optical_depth;
  double largest_voxel_depth = 0;  ///< optical depth of a voxel, if it is known
};

struct CloudInfo {
  std::filesystem::path path;
  std::uint64_t bytes = 0;
  std::vector<VdbGridInfo> grids;
};

CloudSummary summarize(const CloudField& field);

/// Vertical integrals of the values over the columns, [j][i].
std::vector<double> column_integrals(const CloudField& field);

/// Grids of an effective radius, a single-scattering albedo or a phase index are read without their background. It
/// belongs to the voxels of another grid.
/// @param grid the only one that is described; empty: all. @param up_axis as in VdbReadOptions.
/// @throws InputError if the file as a whole cannot be read, or the grid is not in it.
CloudInfo describe_cloud_vdb(const std::filesystem::path& path, const std::string& grid = {},
                             const std::string& up_axis = "z");

/// Several lines for a terminal, each ended by a newline.
std::string format_cloud_info(const CloudInfo& info);

/// Sentences about water and optical depth that no cloud has.
std::vector<std::string> doubts_about(const CloudInfo& info);

/// @throws InputError for a grid of effective radii that nothing in a cloud has.
void check_effective_radii(const CloudInfo& info);

}  // namespace cloudbow
