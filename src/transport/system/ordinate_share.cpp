#include "transport/system/ordinate_share.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace cloudbow {
namespace {

// Ranges of cells begin at multiples of this, the largest tile of a scattering: tiles are those of one rank.
constexpr std::size_t range_cells = 128;

std::vector<std::size_t> ranges(int ranks, std::size_t cells) {
  const std::size_t blocks = (cells + range_cells - 1) / range_cells;
  std::vector<std::size_t> begin;
  for (int r = 0; r <= ranks; ++r)
    begin.push_back(
        std::min(cells, range_cells * (blocks * static_cast<std::size_t>(r) / static_cast<std::size_t>(ranks))));
  return begin;
}

}  // namespace

OrdinateShare::OrdinateShare(Ranks& ranks, const OrdinateSet& ordinates, std::size_t cells)
    : ranks_(&ranks), of_rank_(static_cast<std::size_t>(ranks.size())), begin_(ranges(ranks.size(), cells)) {
  for (int d = 0; d < ordinates.size(); ++d) {
    owner_.push_back(owner_of_octant(octant_of(ordinates.direction[d])));
    std::vector<int>& of_owner = of_rank_[static_cast<std::size_t>(owner_.back())];
    of_owner.push_back(d);
    most_ = std::max(most_, of_owner.size());
  }
}

// One rank has an octant of light that travels down and the one above it. So all ranks march in both directions. With
// eight ranks or more each octant has its own.
int OrdinateShare::owner_of_octant(int octant) const {
  constexpr int pairs = octants / 2;
  const int size = ranks_->size();
  if (size >= octants) return octant;
  return octant % pairs * std::min(size, pairs) / pairs;
}

template <class Real>
AngularField<Real> OrdinateShare::own_cells(std::optional<Real> float16_unit) const {
  const auto own = static_cast<std::size_t>(ranks_->rank());
  AngularField<Real> field(static_cast<int>(owner_.size()), begin_[own + 1] - begin_[own], float16_unit);
  field.first_cell = begin_[own];
  field.all_cells = begin_.back();
  return field;
}

// Each step moves one ordinate of every rank.
template <class Rows>
void OrdinateShare::exchange_rows(Rows& rows, bool to_cells) const {
  using Row = typename Rows::value_type;
  using Stored = typename Row::value_type;
  const auto own = static_cast<std::size_t>(ranks_->rank());
  const std::size_t count = begin_[own + 1] - begin_[own], all = begin_.back();
  for (std::size_t step = 0; step < most_; ++step) {
    std::vector<Ranks::Outgoing> outgoing;
    std::vector<Ranks::Incoming> incoming;
    std::vector<std::pair<int, Row>> fresh;
    fresh.reserve(of_rank_.size());
    const auto new_row = [&](int d, std::size_t cells) -> Row& {
      return fresh.emplace_back(d, Row(AngularField<float>::padded(cells))).second;
    };
    const bool has_row = step < of_rank_[own].size();
    const int mine = has_row ? of_rank_[own][step] : -1;
    Row* const whole = !has_row ? nullptr : to_cells ? &rows[static_cast<std::size_t>(mine)] : &new_row(mine, all);
    for (std::size_t r = 0; r < of_rank_.size(); ++r) {
      const int rank = static_cast<int>(r);
      const std::size_t of_range = begin_[r + 1] - begin_[r];
      if (whole != nullptr) {  // pieces of this rank's ordinate, in the ranges of all
        const std::span<Stored> piece(whole->data() + begin_[r], of_range);
        if (to_cells) {
          outgoing.push_back({rank, std::as_bytes(piece)});
        } else {
          incoming.push_back({rank, std::as_writable_bytes(piece)});
        }
      }
      if (step >= of_rank_[r].size()) continue;  // this rank's range of the ordinates of all
      const int theirs = of_rank_[r][step];
      if (to_cells) {
        incoming.push_back({rank, std::as_writable_bytes(std::span<Stored>(new_row(theirs, count).data(), count))});
      } else {
        outgoing.push_back(
            {rank, std::as_bytes(std::span<Stored>(rows[static_cast<std::size_t>(theirs)].data(), count))});
      }
    }
    ranks_->exchange(outgoing, incoming);
    for (const std::vector<int>& of : of_rank_) {
      if (step < of.size()) Row().swap(rows[static_cast<std::size_t>(of[step])]);
    }
    for (auto& [d, row] : fresh) rows[static_cast<std::size_t>(d)] = std::move(row);
  }
}

template <class Real>
void OrdinateShare::to_rows(AngularField<Real>& field) const {
  if (field.packed()) {
    exchange_rows(field.float16, false);
  } else {
    exchange_rows(field.data, false);
  }
  field.cells = field.all_cells;
  field.first_cell = 0;
}

template <class Real>
void OrdinateShare::to_cells(AngularField<Real>& field) const {
  if (field.packed()) {
    exchange_rows(field.float16, true);
  } else {
    exchange_rows(field.data, true);
  }
  const auto own = static_cast<std::size_t>(ranks_->rank());
  field.cells = begin_[own + 1] - begin_[own];
  field.first_cell = begin_[own];
}

template <class Real>
void OrdinateShare::to_first(AngularField<Real>& field) const {
  const auto gather = [&](auto& rows) {
    using Stored = typename std::decay_t<decltype(rows)>::value_type::value_type;
    for (auto& row : rows) {  // one at a time: the first rank keeps both for no longer
      const std::span<const Stored> own(row.data(), field.cells);
      if (!ranks_->is_first()) {
        const std::array<Ranks::Outgoing, 1> outgoing{{{0, std::as_bytes(own)}}};
        ranks_->exchange(outgoing, {});
        std::decay_t<decltype(row)>().swap(row);
        continue;
      }
      std::decay_t<decltype(row)> whole(AngularField<Real>::padded(field.all_cells));
      std::copy(own.begin(), own.end(), whole.begin());
      std::vector<Ranks::Incoming> incoming;
      for (std::size_t r = 1; r < of_rank_.size(); ++r) {
        const std::span<Stored> piece(whole.data() + begin_[r], begin_[r + 1] - begin_[r]);
        incoming.push_back({static_cast<int>(r), std::as_writable_bytes(piece)});
      }
      ranks_->exchange({}, incoming);
      row = std::move(whole);
    }
  };
  if (field.packed()) {
    gather(field.float16);
  } else {
    gather(field.data);
  }
  if (!ranks_->is_first()) {
    field = {};
    return;
  }
  field.cells = field.all_cells;
  field.first_cell = 0;
}

template <class Real>
void OrdinateShare::gather_cells(std::span<Real> sets) const {
  const std::size_t all = begin_.back();
  for (std::size_t first = 0; first < sets.size(); first += all) gather_ranges(*ranks_, begin_, sets.data() + first);
}

template <class Value>
void OrdinateShare::gather_ordinates(std::span<const std::span<Value>> of_ordinate) const {
  std::vector<Ranks::Outgoing> outgoing;
  std::vector<Ranks::Incoming> incoming;
  for (int d = 0; d < static_cast<int>(of_ordinate.size()); ++d) {
    const std::span<Value> values = of_ordinate[static_cast<std::size_t>(d)];
    if (values.empty()) continue;
    if (!has(d)) incoming.push_back({owner_[static_cast<std::size_t>(d)], std::as_writable_bytes(values)});
    for (int r = 0; has(d) && r < ranks_->size(); ++r) {
      if (r != ranks_->rank()) outgoing.push_back({r, std::as_bytes(values)});
    }
  }
  ranks_->exchange(outgoing, incoming);
}

template <class Real>
void OrdinateShare::gather_octants(LightSlopes<Real>& slopes) const {
  std::vector<Ranks::Outgoing> outgoing;
  std::vector<Ranks::Incoming> incoming;
  for (int octant = 0; octant < octants; ++octant) {
    const int owner = owner_of_octant(octant);
    for (std::vector<Real>& axis : slopes.of_radiance[static_cast<std::size_t>(octant)]) {
      const std::span<Real> values(axis.data(), begin_.back());
      if (owner != ranks_->rank()) incoming.push_back({owner, std::as_writable_bytes(values)});
      for (int r = 0; owner == ranks_->rank() && r < ranks_->size(); ++r) {
        if (r != owner) outgoing.push_back({r, std::as_bytes(values)});
      }
    }
  }
  ranks_->exchange(outgoing, incoming);
}

template AngularField<float> OrdinateShare::own_cells<float>(std::optional<float>) const;
template void OrdinateShare::to_rows<float>(AngularField<float>&) const;
template void OrdinateShare::to_cells<float>(AngularField<float>&) const;
template void OrdinateShare::to_first<float>(AngularField<float>&) const;
template void OrdinateShare::gather_cells<float>(std::span<float>) const;
template void OrdinateShare::gather_ordinates<float>(std::span<const std::span<float>>) const;
template void OrdinateShare::gather_octants<float>(LightSlopes<float>&) const;
template AngularField<double> OrdinateShare::own_cells<double>(std::optional<double>) const;
template void OrdinateShare::to_rows<double>(AngularField<double>&) const;
template void OrdinateShare::to_cells<double>(AngularField<double>&) const;
template void OrdinateShare::to_first<double>(AngularField<double>&) const;
template void OrdinateShare::gather_cells<double>(std::span<double>) const;
template void OrdinateShare::gather_ordinates<double>(std::span<const std::span<double>>) const;
template void OrdinateShare::gather_octants<double>(LightSlopes<double>&) const;
template void OrdinateShare::gather_ordinates<int>(std::span<const std::span<int>>) const;

}  // namespace cloudbow
