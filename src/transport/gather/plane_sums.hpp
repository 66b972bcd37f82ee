// Sums of light on planes, and their way from rank to rank.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cloudbow/core/ranks.hpp"
#include "transport/grid/lanes.hpp"

namespace cloudbow {

/// Planes without light that varies are empty.
template <class Real>
struct PlaneSums {
  std::vector<std::vector<Real>> columns;  // [planes][columns + lane_padding]
  std::vector<double> everywhere;          // [planes] light of all columns beside them

  explicit PlaneSums(std::size_t planes) : columns(planes), everywhere(planes, 0.) {}

  // Keeps the memory of the planes.
  void clear() {
    for (std::vector<Real>& plane : columns) plane.clear();
    std::fill(everywhere.begin(), everywhere.end(), 0.);
  }
  // Adds other sums, whose planes may be taken.
  void add(PlaneSums& other) {
    for (std::size_t p = 0; p < columns.size(); ++p) add_plane(p, other);
  }
  void add_plane(std::size_t p, PlaneSums& other) {
    everywhere[p] += other.everywhere[p];
    if (columns[p].empty()) {
      columns[p].swap(other.columns[p]);
      return;
    }
    const std::vector<Real>& more = other.columns[p];
    for (std::size_t c = 0; c < more.size(); ++c) columns[p][c] += more[c];
  }
};

/// To another rank, which calls receive_and_add().
template <class Real>
void send_sums(Ranks& ranks, int to, const PlaneSums<Real>& sums) {
  std::vector<std::uint8_t> has_columns;
  for (const auto& plane : sums.columns) has_columns.push_back(plane.empty() ? 0 : 1);
  const std::array<Ranks::Outgoing, 2> kinds{
      {{to, std::as_bytes(std::span(has_columns))}, {to, std::as_bytes(std::span(sums.everywhere))}}};
  ranks.exchange(kinds, {});
  for (const auto& plane : sums.columns) {
    if (plane.empty()) continue;
    const std::array<Ranks::Outgoing, 1> outgoing{{{to, std::as_bytes(std::span(plane))}}};
    ranks.exchange(outgoing, {});
  }
}

/// Plane by plane, so that they are not kept twice. @param columns of a plane
template <class Real>
void receive_and_add(Ranks& ranks, int from, std::size_t columns, PlaneSums<Real>& all) {
  const std::size_t planes = all.columns.size();
  PlaneSums<Real> sums(planes);
  std::vector<std::uint8_t> has_columns(planes);
  const std::array<Ranks::Incoming, 2> kinds{{{from, std::as_writable_bytes(std::span(has_columns))},
                                              {from, std::as_writable_bytes(std::span(sums.everywhere))}}};
  ranks.exchange({}, kinds);
  for (std::size_t p = 0; p < planes; ++p) {
    if (has_columns[p] != 0) {
      sums.columns[p].resize(columns + lane_padding);
      const std::array<Ranks::Incoming, 1> plane{{{from, std::as_writable_bytes(std::span(sums.columns[p]))}}};
      ranks.exchange({}, plane);
    }
    all.add_plane(p, sums);
    std::vector<Real>().swap(sums.columns[p]);
  }
}

}  // namespace cloudbow
