#include "transport/system/ordinate_share.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace cloudbow {
namespace {

std::vector<std::size_t> ranges(int ranks, std::size_t cells) {
  constexpr std::size_t block = OrdinateShare::block_cells;
  const std::size_t blocks = (cells + block - 1) / block;
  std::vector<std::size_t> begin;
  for (int r = 0; r <= ranks; ++r)
    begin.push_back(std::min(cells, block * (blocks * static_cast<std::size_t>(r) / static_cast<std::size_t>(ranks))));
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

CellRange OrdinateShare::range() const {
  const auto own = static_cast<std::size_t>(ranks_->rank());
  return {begin_[own], begin_[own + 1]};
}

// The pieces of all ranks' cells become one array at one of them; the others have none left.
template <class Array>
void OrdinateShare::collect(int rank, Array& values, std::size_t size) const {
  const std::span own(values.data(), range().size());
  const std::array<Ranks::Outgoing, 1> outgoing{{{rank, std::as_bytes(own)}}};
  if (rank != ranks_->rank()) {
    ranks_->exchange(outgoing, {});
    Array().swap(values);
    return;
  }
  Array whole(size);
  std::vector<Ranks::Incoming> incoming;
  for (std::size_t r = 0; r < of_rank_.size(); ++r) {
    const std::span piece(whole.data() + begin_[r], begin_[r + 1] - begin_[r]);
    incoming.push_back({static_cast<int>(r), std::as_writable_bytes(piece)});
  }
  ranks_->exchange(outgoing, incoming);
  values.swap(whole);
}

template <class Real>
void OrdinateShare::to_first(AngularField<Real>& field) const {
  const auto gather = [&](auto& rows) {  // one at a time: the first rank keeps both for no longer
    for (auto& row : rows) collect(0, row, AngularField<Real>::padded(field.all_cells));
  };
  if (field.packed()) {
    gather(field.float16);
  } else {
    gather(field.data);
  }
  if (!is_first()) {
    field = {};
    return;
  }
  field.cells = field.all_cells;
  field.first_cell = 0;
}

template <class Real>
void OrdinateShare::to_needed_rows(AngularField<Real>& field, const std::vector<std::vector<bool>>& needs) const {
  const auto own = static_cast<std::size_t>(ranks_->rank());
  const auto spread = [&](auto& rows) {
    using Row = typename std::decay_t<decltype(rows)>::value_type;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      Row whole(needs[own][r] ? AngularField<Real>::padded(field.all_cells) : 0);
      std::vector<Ranks::Outgoing> outgoing;
      std::vector<Ranks::Incoming> incoming;
      for (std::size_t rank = 0; rank < of_rank_.size(); ++rank) {
        if (needs[rank][r])
          outgoing.push_back({static_cast<int>(rank), std::as_bytes(std::span(rows[r].data(), field.cells))});
        if (needs[own][r]) {
          const std::span piece(whole.data() + begin_[rank], begin_[rank + 1] - begin_[rank]);
          incoming.push_back({static_cast<int>(rank), std::as_writable_bytes(piece)});
        }
      }
      ranks_->exchange(outgoing, incoming);
      rows[r].swap(whole);
    }
  };
  if (field.packed()) {
    spread(field.float16);
  } else {
    spread(field.data);
  }
  field.cells = field.all_cells;
  field.first_cell = 0;
}

template <class Real>
void OrdinateShare::gather_cells(std::span<const Real> own, std::span<Real> all) const {
  std::copy(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(range().first));
  gather_ranges(*ranks_, begin_, all.data());
}

template <class Real>
void OrdinateShare::cells_to_first(std::vector<Real>& own) const {
  collect(0, own, begin_.back());
}

std::vector<double> OrdinateShare::gather_blocks(std::span<const double> own) const {
  std::vector<std::size_t> begin;
  for (const std::size_t cell : begin_) begin.push_back((cell + block_cells - 1) / block_cells);
  std::vector<double> all(begin.back());
  std::copy(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(begin[ranks_->rank()]));
  gather_ranges(*ranks_, begin, all.data());
  return all;
}

template <class Value>
void OrdinateShare::gather_owned(std::span<const std::span<Value>> arrays, const std::function<int(int)>& owner) const {
  std::vector<Ranks::Outgoing> outgoing;
  std::vector<Ranks::Incoming> incoming;
  for (int a = 0; a < static_cast<int>(arrays.size()); ++a) {
    const std::span<Value> values = arrays[static_cast<std::size_t>(a)];
    if (values.empty()) continue;
    const bool own = owner(a) == ranks_->rank();
    if (!own) incoming.push_back({owner(a), std::as_writable_bytes(values)});
    for (int r = 0; own && r < ranks_->size(); ++r) {
      if (r != ranks_->rank()) outgoing.push_back({r, std::as_bytes(values)});
    }
  }
  ranks_->exchange(outgoing, incoming);
}

template <class Value>
void OrdinateShare::gather_ordinates(std::span<const std::span<Value>> of_ordinate) const {
  gather_owned(of_ordinate, [this](int d) { return owner_[static_cast<std::size_t>(d)]; });
}

template <class Value>
void OrdinateShare::gather_octants(std::span<const std::span<Value>> of_octant) const {
  gather_owned(of_octant, [this](int octant) { return owner_of_octant(octant); });
}

template <class Value>
void OrdinateShare::from_first(std::span<Value> values) const {
  const std::array<std::span<Value>, 1> array{values};
  gather_owned<Value>(array, [](int) { return 0; });
}

template <class Real>
void OrdinateShare::octants_to_cells(std::array<Slope<Real>, octants>& slopes) const {
  for (int octant = 0; octant < octants; ++octant) {
    const int owner = owner_of_octant(octant);
    for (std::vector<Real>& axis : slopes[static_cast<std::size_t>(octant)]) {
      std::vector<Ranks::Outgoing> outgoing;
      for (std::size_t r = 0; owner == ranks_->rank() && r < of_rank_.size(); ++r) {
        const std::span<const Real> piece(axis.data() + begin_[r], begin_[r + 1] - begin_[r]);
        outgoing.push_back({static_cast<int>(r), std::as_bytes(piece)});
      }
      std::vector<Real> own(range().size() + lane_padding);
      const std::array<Ranks::Incoming, 1> incoming{
          {{owner, std::as_writable_bytes(std::span(own.data(), range().size()))}}};
      ranks_->exchange(outgoing, incoming);
      axis.swap(own);
    }
  }
}

template <class Real>
void OrdinateShare::octants_to_rows(std::array<Slope<Real>, octants>& slopes) const {
  for (int octant = 0; octant < octants; ++octant) {
    for (std::vector<Real>& axis : slopes[static_cast<std::size_t>(octant)])
      collect(owner_of_octant(octant), axis, begin_.back() + lane_padding);
  }
}

template <class Real>
void OrdinateShare::cells_to_first(std::array<Slope<Real>, octants>& slopes) const {
  for (Slope<Real>& octant : slopes) {
    for (std::vector<Real>& axis : octant) collect(0, axis, begin_.back() + lane_padding);
  }
}

template <class Real>
void OrdinateShare::rows_to_first(std::array<Slope<Real>, octants>& slopes) const {
  for (int octant = 0; octant < octants; ++octant) {
    const int owner = owner_of_octant(octant);
    for (std::vector<Real>& axis : slopes[static_cast<std::size_t>(octant)]) {
      std::vector<Ranks::Outgoing> outgoing;
      std::vector<Ranks::Incoming> incoming;
      if (has_octant(octant)) outgoing.push_back({0, std::as_bytes(std::span(axis))});
      std::vector<Real> whole(is_first() ? begin_.back() + lane_padding : 0);
      if (is_first()) incoming.push_back({owner, std::as_writable_bytes(std::span(whole))});
      ranks_->exchange(outgoing, incoming);
      if (is_first()) axis.swap(whole);
    }
  }
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                                     \
  template AngularField<Real> OrdinateShare::own_cells<Real>(std::optional<Real>) const;                               \
  template void OrdinateShare::to_rows<Real>(AngularField<Real>&) const;                                               \
  template void OrdinateShare::to_cells<Real>(AngularField<Real>&) const;                                              \
  template void OrdinateShare::to_first<Real>(AngularField<Real>&) const;                                              \
  template void OrdinateShare::to_needed_rows<Real>(AngularField<Real>&, const std::vector<std::vector<bool>>&) const; \
  template void OrdinateShare::gather_cells<Real>(std::span<const Real>, std::span<Real>) const;                       \
  template void OrdinateShare::cells_to_first<Real>(std::vector<Real>&) const;                                         \
  template void OrdinateShare::gather_ordinates<Real>(std::span<const std::span<Real>>) const;                         \
  template void OrdinateShare::from_first<Real>(std::span<Real>) const;                                                \
  template void OrdinateShare::octants_to_cells<Real>(std::array<Slope<Real>, octants>&) const;                        \
  template void OrdinateShare::octants_to_rows<Real>(std::array<Slope<Real>, octants>&) const;                         \
  template void OrdinateShare::cells_to_first<Real>(std::array<Slope<Real>, octants>&) const;                          \
  template void OrdinateShare::rows_to_first<Real>(std::array<Slope<Real>, octants>&) const
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE
template void OrdinateShare::gather_ordinates<int>(std::span<const std::span<int>>) const;
template void OrdinateShare::gather_octants<double>(std::span<const std::span<double>>) const;

}  // namespace cloudbow
