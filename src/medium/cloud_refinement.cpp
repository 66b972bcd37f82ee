#include "cloudbow/medium/cloud_refinement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/error.hpp"
#include "row_cursor.hpp"
#include "row_spans.hpp"

namespace cloudbow {
namespace {

/// A point between the centre of a cell and that of a neighbour.
struct Blend {
  int side;      ///< -1 or 1: the neighbour
  double share;  ///< of the neighbour
};

/// The centre of part s of a cell.
Blend blend_at(int s, int factor) {
  const double from_centre = (s + .5) / factor - .5;
  return {from_centre < 0 ? -1 : 1, std::abs(from_centre)};
}

/// Mean share of one neighbour over the parts of a cell.
double mean_share(int factor) {
  double sum = 0;
  for (int s = 0; s < factor; ++s) {
    const Blend blend = blend_at(s, factor);
    if (blend.side < 0) sum += blend.share;
  }
  return sum / factor;
}

int neighbour(int index, int side, int count, bool wraps) {
  const int beside = index + side;
  return wraps ? (beside + count) % count : std::clamp(beside, 0, count - 1);
}

std::vector<double> dense_plane(const CloudField& field, int k) {
  const std::size_t nx = static_cast<std::size_t>(field.cells[0]), ny = static_cast<std::size_t>(field.cells[1]);
  std::vector<double> plane(nx * ny, 0.);
  for (std::size_t j = 0; j < ny; ++j) {
    const std::size_t row = static_cast<std::size_t>(k) * ny + j;
    for (std::uint32_t s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
      const RowSpan& span = field.spans[s];
      std::copy_n(field.value.begin() + span.offset, span.n,
                  plane.begin() + static_cast<std::ptrdiff_t>(j * nx) + span.i);
    }
  }
  return plane;
}

class Refinement {
 public:
  Refinement(const CloudField& field, int factor, bool periodic)
      : field_(field), factor_(factor), periodic_(periodic), share_(mean_share(factor)) {}

  CloudField refined() {
    CloudField fine;
    fine.min_m = field_.min_m;
    fine.quantity = field_.quantity;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      fine.cells[axis] = field_.cells[axis] * factor_;
      fine.cell_size_m[axis] = field_.cell_size_m[axis] / factor_;
    }
    const auto cube = static_cast<std::size_t>(factor_) * factor_ * factor_;
    fine.value.reserve(field_.active_voxels() * cube);
    RowSpanWriter rows(fine);
    const int nz = field_.cells[2];
    here_ = dense_plane(field_, 0);
    below_ = here_;
    for (int k = 0; k < nz; ++k) {
      above_ = k + 1 < nz ? dense_plane(field_, k + 1) : here_;
      set_scale();
      for (int u = 0; u < factor_; ++u) write_plane(k, blend_at(u, factor_), rows);
      below_ = std::move(here_);
      here_ = std::move(above_);
    }
    return fine;
  }

 private:
  /// Value over the mean of the trilinear values in the parts of each voxel of the plane. This mean is a sum over 27
  /// voxels whose weights are products, one factor for each axis.
  void set_scale() {
    const int nx = field_.cells[0], ny = field_.cells[1];
    const auto smoothed = [this](double before, double at, double after) {
      return share_ * before + (1 - 2 * share_) * at + share_ * after;
    };
    std::vector<double> column(here_.size());
    for (std::size_t c = 0; c < here_.size(); ++c) column[c] = smoothed(below_[c], here_[c], above_[c]);
    std::vector<double> row(static_cast<std::size_t>(nx));
    scale_.assign(here_.size(), 0.);
    for (int j = 0; j < ny; ++j) {
      const double* const before = row_of(column, neighbour(j, -1, ny, periodic_));
      const double* const at = row_of(column, j);
      const double* const after = row_of(column, neighbour(j, 1, ny, periodic_));
      for (int i = 0; i < nx; ++i) row[static_cast<std::size_t>(i)] = smoothed(before[i], at[i], after[i]);
      for (int i = 0; i < nx; ++i) {
        const std::size_t c = static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
        if (here_[c] == 0) continue;
        const auto left = static_cast<std::size_t>(neighbour(i, -1, nx, periodic_));
        const auto right = static_cast<std::size_t>(neighbour(i, 1, nx, periodic_));
        scale_[c] = here_[c] / smoothed(row[left], row[static_cast<std::size_t>(i)], row[right]);
      }
    }
  }

  /// One plane of parts.
  void write_plane(int k, const Blend& vertical, RowSpanWriter& rows) const {
    const int nx = field_.cells[0], ny = field_.cells[1];
    const std::vector<double>& beside = vertical.side < 0 ? below_ : above_;
    std::vector<double> plane(here_.size());
    for (std::size_t c = 0; c < plane.size(); ++c) plane[c] = std::lerp(here_[c], beside[c], vertical.share);
    std::vector<double> row(static_cast<std::size_t>(nx));
    for (int j = 0; j < ny; ++j) {
      for (int t = 0; t < factor_; ++t) {
        const Blend along_y = blend_at(t, factor_);
        const double* const at = row_of(plane, j);
        const double* const next = row_of(plane, neighbour(j, along_y.side, ny, periodic_));
        for (int i = 0; i < nx; ++i) row[static_cast<std::size_t>(i)] = std::lerp(at[i], next[i], along_y.share);
        write_row(k, j, row, rows);
      }
    }
  }

  void write_row(int k, int j, const std::vector<double>& values, RowSpanWriter& rows) const {
    const int nx = field_.cells[0];
    const double* const scale = row_of(scale_, j);
    const std::size_t row =
        static_cast<std::size_t>(k) * static_cast<std::size_t>(field_.cells[1]) + static_cast<std::size_t>(j);
    for (std::uint32_t n = field_.row_begin[row]; n < field_.row_begin[row + 1]; ++n) {
      const RowSpan& span = field_.spans[n];
      for (int i = span.i; i < span.i + span.n; ++i) {
        for (int s = 0; s < factor_; ++s) {
          const Blend along_x = blend_at(s, factor_);
          const auto next = static_cast<std::size_t>(neighbour(i, along_x.side, nx, periodic_));
          const double value = std::lerp(values[static_cast<std::size_t>(i)], values[next], along_x.share) * scale[i];
          // The smallest numbers of float may round to 0, which is no voxel.
          if (const auto stored = static_cast<float>(value); stored > 0) rows.add(i * factor_ + s, stored);
        }
      }
    }
    rows.end_row();
  }

  const double* row_of(const std::vector<double>& plane, int j) const {
    return plane.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(field_.cells[0]);
  }

  const CloudField& field_;
  int factor_;
  bool periodic_;
  double share_;
  std::vector<double> below_, here_, above_;  // dense planes
  std::vector<double> scale_;                 // of the voxels in the middle one
};

void check_size(const CloudField& field, int factor) {
  const double cube = std::pow(factor, 3);
  const double parts = static_cast<double>(field.active_voxels()) * cube;
  const double rows = static_cast<double>(field.cells[1]) * field.cells[2] * factor * factor;
  const double bytes = parts * sizeof(float) + rows * sizeof(std::uint32_t);
  const double allowed = static_cast<double>(available_memory_bytes()) / 2;
  constexpr double most = std::numeric_limits<std::uint32_t>::max();
  if (parts <= most && bytes <= allowed) return;
  throw InputError(
      fmt::format("factor: too many parts (found {:.3g} of {:.3g} GB, allowed {:.3g} of {:.3g} GB) take a smaller one",
                  parts, bytes * 1e-9, most, allowed * 1e-9));
}

}  // namespace

CloudField refine_cloud(const CloudField& field, int factor, bool periodic) {
  assert(factor >= least_refinement && factor <= largest_refinement);
  check_size(field, factor);
  return Refinement(field, factor, periodic).refined();
}

std::vector<float> values_of_parts(const CloudField& field, const CloudField& refined, int factor,
                                   std::span<const float> of_voxels) {
  std::vector<float> of_parts;
  of_parts.reserve(refined.value.size());
  for (int k = 0; k < refined.cells[2]; ++k) {
    for (int j = 0; j < refined.cells[1]; ++j) {
      RowCursor voxels(field, k / factor, j / factor);
      const std::size_t row =
          static_cast<std::size_t>(k) * static_cast<std::size_t>(refined.cells[1]) + static_cast<std::size_t>(j);
      for (std::uint32_t s = refined.row_begin[row]; s < refined.row_begin[row + 1]; ++s) {
        const RowSpan& span = refined.spans[s];
        for (int i = span.i; i < span.i + span.n; ++i) of_parts.push_back(of_voxels[*voxels.voxel(i / factor)]);
      }
    }
  }
  return of_parts;
}

}  // namespace cloudbow
