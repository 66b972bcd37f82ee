#include "transport/rays/sideways_march.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "transport/rays/march.hpp"

namespace cloudbow {
namespace {

constexpr int ahead = 6;  // chunks
static_assert(ahead <= Sheets::padding);

// Launch fraction of a cell. After `rest` of a cell more, the rays are as far behind its middle as they began before
// it.
double centred_start(double rest, bool ascending) { return ascending ? (1 - rest) / 2 : (1 + rest) / 2; }

template <class Real, class Kind>
class SidewaysMarch {
 public:
  SidewaysMarch(const SidewaysPath& path, const Sheets& sheets, const Sheets& gaps, const CellView<Real>& cells,
                const Real* source, SidewaysPlanes<Real>& planes, const CellSums<Real>& sums,
                SidewaysWorkspace<Real>& work)
      : path_(path),
        pattern_(*path.pattern),
        sheets_(sheets),
        gaps_(gaps),
        marched_{0, cells, source, sums},
        planes_(planes),
        work_(work),
        levels_(path.levels.last - path.levels.first),
        columns_(sheets.columns),
        first_row_(-(path.block + 1)) {
    work_.rays.resize(static_cast<std::size_t>(levels_ - first_row_) * columns_ + lane_padding);
    work_.row.resize(columns_ + 2);
  }

  void run() {
    fill_outermost_row();
    march_block(-path_.block, 0);
    for (int first = 0; first < levels_; first += path_.block) {
      const int last = std::min(levels_, first + path_.block);
      for (int q = first; q < last; ++q) relaunch(q);
      march_block(first, last);
    }
    leave_over_the_seam();
  }

 private:
  Real* ray_row(int q) { return work_.rays.data() + static_cast<std::size_t>(q - first_row_) * columns_; }

  // Level of the box for a level counted along the light's vertical travel.
  int box_level(int along) const { return path_.upward ? path_.levels.first + along : path_.levels.last - 1 - along; }
  // Interface, by height above the first level, that light crosses on its way into a level.
  int interface(int along) const { return path_.upward ? along : levels_ - along; }

  // Calls visit(sheet, share) for the sheets that an interval of the march overlaps. Their order is that of the march,
  // around the seam.
  template <class Visit>
  void for_sheets_between(double from, double to, const Visit& visit) const {
    for (int s = static_cast<int>(std::floor(from)); s < to; ++s) {
      const double share = std::min(to, s + 1.) - std::max(from, static_cast<double>(s));
      if (share > 1e-12) visit(pattern_.level(wrapped(s, sheets_.count)), share);
    }
  }

  // Calls use(m, column, n) for the n rays from m on that are in the columns from `column` on.
  template <class Use>
  void for_shifted(int shift, const Use& use) const {
    const int first = wrapped(shift, columns_);
    use(0, first, columns_ - first);
    if (first > 0) use(columns_ - first, 0, first);
  }

  // Rays of a row take the mean of the incident light over their part of the plane: `width` sheets about `at`.
  void come_in(Real* row, double at, double width, int shift) {
    if (planes_.entering.empty()) {
      std::fill_n(row, columns_, planes_.everywhere);
      return;
    }
    std::fill_n(row, columns_, Real(0));
    for_sheets_between(at - width / 2, at + width / 2, [&](int sheet, double share) {
      const Real weight = static_cast<Real>(share / width);
      const Real* const plane = planes_.entering.data() + static_cast<std::size_t>(sheet) * columns_;
      for_shifted(shift, [=](int m, int column, int n) {
        const Real* __restrict const from = plane + column;
        Real* __restrict const to = row + m;
        for (int i = 0; i < n; ++i) to[i] += weight * from[i];
      });
    });
  }

  void go_out(const Real* row, double at, double width, int shift) {
    planes_.left += width * sum(row);
    if (planes_.leaving.empty()) return;
    for_sheets_between(at - width / 2, at + width / 2, [&](int sheet, double share) {
      const Real weight = static_cast<Real>(share);
      Real* const plane = planes_.leaving.data() + static_cast<std::size_t>(sheet) * columns_;
      for_shifted(shift, [=](int m, int column, int n) {
        const Real* __restrict const from = row + m;
        Real* __restrict const to = plane + column;
        for (int i = 0; i < n; ++i) to[i] += weight * from[i];
      });
    });
  }

  double sum(const Real* row) const { return plane_sum(row, static_cast<std::size_t>(columns_)); }

  // The row outside when the last sheet is done, part of which crosses the plane at the seam.
  void fill_outermost_row() {
    come_in(ray_row(first_row_), sheets_.count, std::max(path_.rest, 1e-9) / path_.rise, path_.across);
    if (!planes_.at_level.empty()) planes_.at_level[interface(0)] += path_.rest / path_.rise * sum(ray_row(first_row_));
  }

  // Rays at the launch points of row q, from those that have come back.
  void relaunch(int q) {
    const Real* const near = ray_row(q - path_.block);
    const Real* const behind = ray_row(q - path_.block - 1);
    const Real rest = static_cast<Real>(path_.rest);
    const Real sidestep = static_cast<Real>(path_.across_rest);
    Real* const back = work_.row.data() + 1;  // with the neighbours across the seam beside it
    for_shifted(path_.across, [=](int m, int column, int n) {
      const Real* __restrict const one = near + m;
      const Real* __restrict const two = behind + m;
      Real* __restrict const to = back + column;
      for (int i = 0; i < n; ++i) to[i] = (1 - rest) * one[i] + rest * two[i];
    });
    back[-1] = back[columns_ - 1];
    back[columns_] = back[0];
    const Real* __restrict const from = back + (path_.ascending_across ? -1 : 1);
    Real* __restrict const row = ray_row(q);
    for (int m = 0; m < columns_; ++m) row[m] = (1 - sidestep) * back[m] + sidestep * from[m];
    // Light that changes rows at the seam crosses a level there.
    if (!planes_.at_level.empty() && q > 0) planes_.at_level[interface(q)] += path_.rest / path_.rise * sum(behind);
  }

  void march_block(int first, int last) {
    int crossed = 0;
    for (int step = 0; step < pattern_.levels(); ++step) {
      const int sheet = pattern_.level(step);
      const double chord = pattern_.chord_m[step];
      double at = step;
      for (std::uint32_t s = pattern_.level_begin[step]; s < pattern_.level_begin[step + 1]; ++s) {
        const Segment& segment = pattern_.segments[s];
        if (segment.entry == Entry::y_low || segment.entry == Entry::y_high)
          cross_plane(++crossed, first, last, at, segment.shift_x);
        at += segment.fraction;
        // Levels, along the travel, that rows of this block are in.
        const int low = std::max(0, first + crossed);
        const int high = std::min(levels_, last + crossed);
        if (low >= high || segment.fraction <= 0) continue;
        const int lowest = box_level(path_.upward ? low : high - 1);
        const int end = box_level(path_.upward ? high - 1 : low) + 1;
        const auto chunks = sheets_.of(sheet, lowest, end);
        const auto gaps = gaps_.count > 0 ? gaps_.of(sheet, lowest, end) : std::span<const Chunk>{};
        if (chunks.empty() && gaps.empty()) continue;
        const SegmentGeometry<Real> geometry(segment, chord);
        const int shift = wrapped(segment.shift_x, columns_);
        // Row of rays for a level of the box: base + slope * level.
        const int slope = path_.upward ? 1 : -1;
        const int base = (path_.upward ? -path_.levels.first : path_.levels.last - 1) - crossed - first_row_;
        for (const Chunk& chunk : chunks) {
          ask_for<Kind>(&chunk + ahead, marched_);
          const std::size_t row = static_cast<std::size_t>(base + slope * chunk.row) * columns_;
          cross_run(row, chunk, shift, columns_, [&](std::size_t ray, std::size_t cell, int n) {
            cross_cells<Kind>(geometry, n, marched_, cell, work_.rays.data() + ray, PlainRays());
          });
        }
        for (std::size_t g = 0; g < gaps.size();) {
          const int level = gaps[g].row;
          const std::size_t row = static_cast<std::size_t>(base + slope * level) * columns_;
          AirCrossing<Kind, Real> air(geometry, marched_.view.extinction[gaps[g].cell], marched_, work_.rays.data());
          while (g < gaps.size() && gaps[g].row == level) {
            const std::uint32_t block = gaps[g].cell;
            air.enter(block);
            for (; g < gaps.size() && gaps[g].row == level && gaps[g].cell == block; ++g)
              cross_gap(row, gaps[g], shift, columns_, air);
            air.leave();
          }
        }
      }
    }
  }

  // All rows have just crossed an interface, for the `crossed`th time: one comes in, one leaves.
  void cross_plane(int crossed, int first, int last, double at, int shift) {
    const double width = 1 / path_.rise;
    const int in = -crossed;
    const int out = levels_ - crossed;
    if (in >= first && in < last) come_in(ray_row(in), at, width, shift);
    if (out >= first && out < last) go_out(ray_row(out), at, width, shift);
    if (planes_.at_level.empty()) return;
    for (int q = std::max(first, in); q < last && q <= out; ++q)
      planes_.at_level[interface(q + crossed)] += width * sum(ray_row(q));
  }

  // The last row inside when the last sheet is done: a share of it leaves at the seam.
  void leave_over_the_seam() {
    const Real* const row = ray_row(levels_ - 1 - path_.block);
    const double width = path_.rest / path_.rise;
    if (width > 1e-12) go_out(row, sheets_.count, width, path_.across);
    if (!planes_.at_level.empty()) planes_.at_level[interface(levels_)] += width * sum(row);
  }

  const SidewaysPath& path_;
  const PathPattern& pattern_;
  const Sheets& sheets_;
  const Sheets& gaps_;
  MarchedCells<Real> marched_;
  SidewaysPlanes<Real>& planes_;
  SidewaysWorkspace<Real>& work_;
  int levels_;
  int columns_;
  int first_row_;  // the lowest launch row, outside
};

}  // namespace

std::optional<SidewaysPath> make_sideways_path(const BoxGrid& box, const Direction& travel, int axis,
                                               LevelRange levels) {
  assert(box.periodic && axis >= 0 && axis < 2);
  if (travel[axis] == 0) return std::nullopt;
  const int other = 1 - axis;
  const double sheet_m = axis == 0 ? box.dx_m : box.dy_m;
  const int sheet_count = axis == 0 ? box.nx : box.ny;
  const double level_m = box.thickness_m(levels.first);
  SidewaysPath path;
  path.axis = axis;
  path.levels = levels;
  path.upward = travel.z() > 0;
  path.rise = std::abs(travel.z() / travel[axis]) * sheet_m / level_m;
  constexpr double too_steep = 4;  // rays crowd, and along z they cross fewer cells
  if (path.rise > too_steep) return std::nullopt;
  const double total = path.rise * sheet_count;
  path.block = static_cast<int>(std::floor(total));
  path.rest = total - path.block;
  if (path.block < 1) return std::nullopt;

  BoxGrid transposed;
  transposed.nx = other == 0 ? box.nx : box.ny;
  transposed.ny = levels.last - levels.first;
  transposed.dx_m = other == 0 ? box.dx_m : box.dy_m;
  transposed.dy_m = level_m;
  for (int s = 0; s <= sheet_count; ++s) transposed.z_edge_m.push_back(s * sheet_m);
  transposed.periodic = true;
  if (transposed.ny == 1) return std::nullopt;  // as a periodic axis of one it would not be crossed
  const double sidestep =
      transposed.nx == 1 ? 0 : std::abs(travel[other] / travel[axis]) * sheet_m / transposed.dx_m * sheet_count;
  path.ascending_across = travel[other] >= 0;
  const int whole = static_cast<int>(std::floor(sidestep));
  path.across_rest = sidestep - whole;
  path.across = path.ascending_across ? whole : -whole;
  path.pattern = std::make_shared<const PathPattern>(
      make_path_pattern(transposed, Direction(travel[other], travel.z(), travel[axis]),
                        centred_start(path.across_rest, path.ascending_across), centred_start(path.rest, path.upward),
                        false, {0, sheet_count}));
  return path;
}

template <class Real>
void march_sideways(const SidewaysPath& path, const Sheets& sheets, const Sheets& gaps, const CellView<Real>& cells,
                    const Real* source, SidewaysPlanes<Real>& planes, const CellSums<Real>& sums,
                    SidewaysWorkspace<Real>& work) {
  for_kind_of<true>(cells, sums, [&](auto kind) {
    SidewaysMarch<Real, decltype(kind)>(path, sheets, gaps, cells, source, planes, sums, work).run();
  });
}

template void march_sideways<float>(const SidewaysPath&, const Sheets&, const Sheets&, const CellView<float>&,
                                    const float*, SidewaysPlanes<float>&, const CellSums<float>&,
                                    SidewaysWorkspace<float>&);
template void march_sideways<double>(const SidewaysPath&, const Sheets&, const Sheets&, const CellView<double>&,
                                     const double*, SidewaysPlanes<double>&, const CellSums<double>&,
                                     SidewaysWorkspace<double>&);

}  // namespace cloudbow
