#include "les_axes.hpp"

#include <algorithm>
#include <utility>

namespace cloudbow {

LesAxes::LesAxes(LesFile& file, const NetcdfVariable& variable) : file_(file) {
  assign(variable);
  check_time(variable);
}

void LesAxes::assign(const NetcdfVariable& variable) {
  const std::size_t rank = variable.length.size();
  if (rank < 1 || rank > 4) {
    file_.fail(
        "'{}': wrong number of dimensions (found {}, allowed z; z, x; z, y, x; with or without time); cut one out, as "
        "'ncks -d' does",
        variable.name, rank);
  }
  std::vector<int> role(rank, -1);
  for (std::size_t n = 0; n < rank; ++n) role[n] = axis_of_dimension(variable.dimension[n]);
  // Names without meaning get the customary order: (time, z, y, x), the last of them first.
  for (std::size_t n = 0; n < rank; ++n) {
    if (role[n] >= 0) continue;
    const int customary = static_cast<int>(rank - 1 - n);
    const std::string lower = lower_case(variable.dimension[n]);
    if (lower == "ncells" || lower == "cell" || lower == "ncell" || lower == "cells") {
      file_.fail(
          "'{}': dimension '{}' counts the cells of an unstructured grid (allowed: y and x); bring the file onto "
          "longitudes and latitudes, as 'cdo remapcon,TARGET' does",
          variable.name, variable.dimension[n]);
    }
    if (rank < 3 || std::find(role.begin(), role.end(), customary) != role.end()) {
      file_.fail(
          "'{}': dimension '{}' is none that is known (allowed: say which with --x-axis, --y-axis, --z-axis, "
          "--time-axis)",
          variable.name, variable.dimension[n]);
    }
    role[n] = customary;
    file_.note("GUESSED axis: dimension '{}' is {}", variable.dimension[n],
               axis_names[static_cast<std::size_t>(customary)]);
  }
  for (std::size_t n = 0; n < rank; ++n) {
    auto& axis = axes_[static_cast<std::size_t>(role[n])];
    if (axis.is_there) {
      file_.fail("'{}': dimensions '{}' and '{}' are both taken for {} (allowed: say which with --{}-axis)",
                 variable.name, axis.name, variable.dimension[n], axis_names[static_cast<std::size_t>(role[n])],
                 axis_names[static_cast<std::size_t>(role[n])]);
    }
    axis = {true, variable.dimension[n], variable.length[n]};
  }
  if (!axes_[2].is_there)
    file_.fail("'{}': no vertical dimension (found only others; say which with --z-axis)", variable.name);
  for (std::size_t a = 0; a < 3; ++a) {
    if (axes_[a].is_there && axes_[a].length == 0)
      file_.fail("axis '{}' has length 0 (allowed: at least 1)", axes_[a].name);
  }
  check_import_size(file_.options, static_cast<double>(axes_[0].length), static_cast<double>(axes_[1].length),
                    static_cast<double>(axes_[2].length));
}

int LesAxes::axis_of_dimension(const std::string& dimension) const {
  const auto& given = file_.options.axes;
  for (std::size_t a = 0; a < 4; ++a) {
    if (!given[a].empty() && given[a] == dimension) return static_cast<int>(a);
  }
  const int guess = axis_of_name(dimension);
  return guess >= 0 && !given[static_cast<std::size_t>(guess)].empty() ? -1 : guess;
}

void LesAxes::check_time(const NetcdfVariable& variable) {
  const Axis& time = axes_[3];
  const std::size_t wanted = file_.options.time;
  if (!time.is_there) {
    if (wanted > 0) file_.fail("'{}' has no time axis (found --time {}, allowed 0)", variable.name, wanted);
    return;
  }
  if (time.length == 0)
    file_.fail("time axis '{}' has length 0: there is no field in the file (allowed: at least 1)", time.name);
  if (wanted >= time.length) {
    file_.fail("--time is beyond the time axis '{}' (found {}, allowed 0 to {})", time.name, wanted, time.length - 1);
  }
  if (time.length > 1) file_.note("time: {} of 0 to {} on '{}'", wanted, time.length - 1, time.name);
}

/// "height_2" counts the same cells as "height" if there are as many.
static std::string stem_of(const std::string& name) {
  const auto end = name.find_last_not_of("0123456789");
  return end != std::string::npos && name[end] == '_' ? name.substr(0, end) : name;
}

int LesAxes::role_of(const NetcdfVariable& variable, std::size_t n) const {
  const std::string& name = variable.dimension[n];
  const std::size_t length = variable.length[n];
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    if (axes_[a].is_there && axes_[a].name == name && axes_[a].length == length) return static_cast<int>(a);
  }
  if (stem_of(name) == stem_of(axes_[2].name) && length == axes_[2].length) return 2;
  return length == 1 ? single : -1;
}

std::optional<std::size_t> LesAxes::vertical_dimension(const NetcdfVariable& variable) const {
  std::optional<std::size_t> vertical;
  for (std::size_t n = 0; n < variable.length.size(); ++n) {
    const int role = role_of(variable, n);
    if (role >= 0 && role != 2) continue;
    const bool may_be = role == 2 || variable.length[n] == axes_[2].length + 1;
    if (!may_be || vertical) return std::nullopt;
    vertical = n;
  }
  return vertical;
}

bool LesAxes::holds(const NetcdfVariable& variable) const {
  for (std::size_t n = 0; n < variable.length.size(); ++n) {
    if (role_of(variable, n) < 0) return false;
  }
  return true;
}

LesAxes::Selection LesAxes::select(const NetcdfVariable& variable, std::size_t levels, const char* what) const {
  const std::size_t rank = variable.length.size();
  Selection selection{std::vector<std::size_t>(rank, 0), variable.length};
  std::size_t step = 1;
  for (std::size_t n = rank; n-- > 0;) {
    int role = role_of(variable, n);
    if (role < 0 && variable.length[n] == levels && levels == axes_[2].length + 1) role = 2;
    if (role < 0) {
      file_.fail("'{}' ({}): dimension '{}' is not one of the cloud's (allowed: some of those)", variable.name, what,
                 variable.dimension[n]);
    }
    if (role == 3) {
      selection.start[n] = file_.options.time;
      selection.count[n] = 1;
    } else if (role != single) {
      selection.stride[static_cast<std::size_t>(role)] = step;
      selection.dimension[static_cast<std::size_t>(role)] = n;
      step *= variable.length[n];
    }
  }
  return selection;
}

/// The file is read in slabs, so that few numbers are there twice.
template <class T>
std::vector<T> LesAxes::read(const NetcdfVariable& variable, std::size_t levels, const char* what) const {
  constexpr std::size_t most_numbers = 4000000;
  Selection selection = select(variable, levels, what);
  const std::array<std::size_t, 3> length{axes_[0].length, axes_[1].length, levels};
  std::size_t slab_axis = Selection::none;  // the axis that the file stores slowest
  for (std::size_t a = 0; a < 3; ++a) {
    if (selection.dimension[a] == Selection::none) continue;
    if (slab_axis == Selection::none || selection.dimension[a] < selection.dimension[slab_axis]) slab_axis = a;
  }
  std::vector<T> value(length[0] * length[1] * length[2]);
  const auto fill = [&](const std::vector<double>& stored, std::size_t slab_begin, std::size_t slab_end) {
    // Indices of the cells in the slab, and of their values; cells along an axis that the variable lacks share one.
    std::array<std::vector<std::pair<std::size_t, std::size_t>>, 3> index;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t n = 0; n < length[a]; ++n) {
        const bool has_axis = selection.dimension[a] != Selection::none;
        const std::size_t in_file = has_axis && is_reversed_[a] ? length[a] - 1 - n : n;
        if (a == slab_axis && (in_file < slab_begin || in_file >= slab_end)) continue;
        index[a].emplace_back(n, selection.stride[a] * (a == slab_axis ? in_file - slab_begin : in_file));
      }
    }
    for (const auto& [k, in_z] : index[2]) {
      for (const auto& [j, in_y] : index[1]) {
        T* const row = value.data() + (k * length[1] + j) * length[0];
        for (const auto& [i, in_x] : index[0]) row[i] = static_cast<T>(stored[in_z + in_y + in_x]);
      }
    }
  };
  if (slab_axis == Selection::none) {
    fill(file_.input.read(variable, selection.start, selection.count), 0, 0);
    return value;
  }
  const std::size_t d = selection.dimension[slab_axis];
  const std::size_t chunk = file_.input.chunk_length(variable, d);
  const std::size_t chunks = std::max<std::size_t>(1, most_numbers / selection.stride[slab_axis] / chunk);
  for (std::size_t begin = 0; begin < length[slab_axis]; begin += chunks * chunk) {
    const std::size_t end = std::min(length[slab_axis], begin + chunks * chunk);
    selection.start[d] = begin;
    selection.count[d] = end - begin;
    fill(file_.input.read(variable, selection.start, selection.count), begin, end);
  }
  return value;
}

template std::vector<float> LesAxes::read(const NetcdfVariable&, std::size_t, const char*) const;
template std::vector<double> LesAxes::read(const NetcdfVariable&, std::size_t, const char*) const;

}  // namespace cloudbow
