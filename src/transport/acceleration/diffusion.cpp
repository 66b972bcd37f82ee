#include "transport/acceleration/diffusion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "transport/acceleration/anderson.hpp"

namespace cloudbow {

// Below this many cells a parallel loop costs more than it saves.
constexpr std::size_t worth_threads = 100000;

ColumnSet::ColumnSet(int columns_x, int columns_y, bool periodic, std::vector<std::uint32_t> places)
    : nx(columns_x), ny(columns_y), place(std::move(places)) {
  const auto none = static_cast<std::uint32_t>(size());
  const std::vector<std::uint32_t> at = by_place();
  const auto of = [&](int i, int j) {
    if (periodic && i < 0) i += nx;
    if (periodic && i >= nx) i -= nx;
    if (periodic && j < 0) j += ny;
    if (periodic && j >= ny) j -= ny;
    const bool inside = i >= 0 && i < nx && j >= 0 && j < ny;
    return inside ? at[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)] : none;
  };
  beside.resize(size());
  for (std::size_t c = 0; c < size(); ++c) {
    const int x = i(c), y = j(c);
    beside[c] = {nx > 1 ? of(x + 1, y) : none, nx > 1 ? of(x - 1, y) : none, ny > 1 ? of(x, y + 1) : none,
                 ny > 1 ? of(x, y - 1) : none};
  }
}

ColumnSet ColumnSet::of(const BoxGrid& box) {
  std::vector<std::uint32_t> places(box.columns());
  std::iota(places.begin(), places.end(), 0U);
  return {box.nx, box.ny, box.periodic, std::move(places)};
}

std::vector<std::uint32_t> ColumnSet::by_place() const {
  const auto none = static_cast<std::uint32_t>(size());
  std::vector<std::uint32_t> at(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), none);
  for (std::uint32_t c = 0; c < none; ++c) at[place[c]] = c;
  return at;
}

// One grid of the multigrid. Arrays of cells are column by column. They have one column more: that of the neighbours
// which are not there. Its couplings are 0.
struct DiffusionOperator::Level {
  ColumnSet columns;
  std::size_t nz;
  std::array<std::vector<std::uint32_t>, 2> of_colour;  // columns, as on a chessboard
  bool colours_are_independent = true;                  // no column is beside one of its colour
  // Couplings to the cell to the east, to the north and above. In float: their sums, on the diagonal, are not rounded.
  std::vector<float> east, north, up;
  std::vector<double> diagonal;
  // LDL^T of each column: 1 / pivots, and couplings upward over them.
  std::vector<float> inverse, upper;
  // [column] of the next coarser level.
  std::vector<std::uint32_t> coarse_column;

  Level(ColumnSet set, std::size_t levels) : columns(std::move(set)), nz(levels) {
    for (std::uint32_t c = 0; c < columns.size(); ++c) {
      const auto colour = [&](std::uint32_t of) { return static_cast<std::size_t>(columns.i(of) + columns.j(of)) % 2; };
      of_colour[colour(c)].push_back(c);
      for (const std::uint32_t other : columns.beside[c]) {
        if (other < columns.size() && colour(other) == colour(c)) colours_are_independent = false;
      }
    }
    for (auto* const values : {&east, &north, &up, &inverse, &upper}) values->assign(size(), 0.F);
  }

  std::size_t size() const { return (columns.size() + 1) * nz; }  // of arrays
  bool is_worth_threads() const { return size() > worth_threads; }

  // diagonal = leakage + losses of each cell through its couplings.
  void close(std::vector<double> leakage) {
    diagonal = std::move(leakage);
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const std::size_t to_east = columns.beside[column][ColumnSet::east] * nz;
      const std::size_t to_north = columns.beside[column][ColumnSet::north] * nz;
      for (std::size_t k = 0; k < nz; ++k) {
        const std::size_t c = column * nz + k;
        const double to_the_east = east[c], to_the_north = north[c];
        diagonal[c] += to_the_east + to_the_north;
        diagonal[to_east + k] += to_the_east;
        diagonal[to_north + k] += to_the_north;
        if (k + 1 < nz) {
          const double upward = up[c];
          diagonal[c] += upward;
          diagonal[c + 1] += upward;
        }
      }
    }
    for (std::size_t column = 0; column < columns.size(); ++column) {
      for (std::size_t k = 0; k < nz; ++k) {
        const std::size_t c = column * nz + k;
        const double below = k > 0 ? static_cast<double>(up[c - 1]) * static_cast<double>(upper[c - 1]) : 0;
        inverse[c] = static_cast<float>(1 / (diagonal[c] - below));
        upper[c] = up[c] * inverse[c];
      }
    }
  }

  // Flow into the cells of a column from the columns beside it.
  template <class Value>
  void flow_in(std::size_t column, const Value* x, Value* to) const {
    const auto& beside = columns.beside[column];
    const float* const coupling_east = east.data() + column * nz;
    const float* const coupling_west = east.data() + beside[ColumnSet::west] * nz;
    const float* const coupling_north = north.data() + column * nz;
    const float* const coupling_south = north.data() + beside[ColumnSet::south] * nz;
    const Value* const x_east = x + beside[ColumnSet::east] * nz;
    const Value* const x_west = x + beside[ColumnSet::west] * nz;
    const Value* const x_north = x + beside[ColumnSet::north] * nz;
    const Value* const x_south = x + beside[ColumnSet::south] * nz;
#pragma omp simd
    for (std::size_t k = 0; k < nz; ++k) {
      const Value in_line =
          static_cast<Value>(coupling_east[k]) * x_east[k] + static_cast<Value>(coupling_west[k]) * x_west[k];
      to[k] += in_line + static_cast<Value>(coupling_north[k]) * x_north[k] +
               static_cast<Value>(coupling_south[k]) * x_south[k];
    }
  }

  // y = b - A x
  // @param b null: 0.
  template <class Value>
  void residual(const Value* b, const Value* x, Value* y) const {
    // Nothing throws here.
#pragma omp parallel for schedule(static) if (is_worth_threads())
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const std::size_t first = column * nz;
      for (std::size_t k = 0; k < nz; ++k) {
        const std::size_t c = first + k;
        Value sum = (b != nullptr ? b[c] : Value(0)) - static_cast<Value>(diagonal[c]) * x[c];
        if (k + 1 < nz) sum += static_cast<Value>(up[c]) * x[c + 1];
        if (k > 0) sum += static_cast<Value>(up[c - 1]) * x[c - 1];
        y[c] = sum;
      }
      flow_in(column, x, y + first);
    }
  }

  // Zebra Gauss-Seidel over whole columns: one colour, then the other; `reversed` makes the pair symmetric.
  // @param work [size()]
  void smooth(float* x, const float* b, bool reversed, float* work) const {
    for (int half = 0; half < 2; ++half) {
      const std::vector<std::uint32_t>& coloured = of_colour[reversed ? 1 - half : half];
      // With odd periodic sizes two columns of one colour are neighbours at the seam. The order matters there, so it
      // stays serial. Nothing throws here.
#pragma omp parallel for schedule(static) if (colours_are_independent && is_worth_threads())
      for (const std::uint32_t column : coloured) solve_column(column, x, b, work + column * nz);
    }
  }

  void solve_column(std::size_t column, float* x, const float* b, float* value) const {
    const std::size_t first = column * nz;
    std::copy_n(b + first, nz, value);
    flow_in(column, x, value);
    const float* const above = upper.data() + first;
    for (std::size_t k = 1; k < nz; ++k) value[k] += above[k - 1] * value[k - 1];
    const float* const pivot = inverse.data() + first;
#pragma omp simd
    for (std::size_t k = 0; k < nz; ++k) value[k] *= pivot[k];
    float* const found = x + first;
    found[nz - 1] = value[nz - 1];
    for (std::size_t k = nz - 1; k-- > 0;) found[k] = value[k] + above[k] * found[k + 1];
  }

  // Aggregates pairs of columns; couplings are divided by the pair's width (a plain Galerkin sum would be too stiff).
  // @param periodic the sides of the box.
  std::unique_ptr<Level> coarser(bool periodic) {
    const int nx = columns.nx, ny = columns.ny;
    const int fx = nx > 2 ? 2 : 1;
    const int fy = ny > 2 ? 2 : 1;
    if (fx * fy == 1) return nullptr;
    const int coarse_nx = (nx + fx - 1) / fx;
    const int coarse_ny = (ny + fy - 1) / fy;
    const auto coarse_place = [&](std::size_t c) {
      return static_cast<std::uint32_t>(columns.j(c) / fy * coarse_nx + columns.i(c) / fx);
    };
    std::vector<std::uint32_t> places;
    for (std::size_t c = 0; c < columns.size(); ++c) places.push_back(coarse_place(c));
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    auto coarse = std::make_unique<Level>(ColumnSet(coarse_nx, coarse_ny, periodic, places), nz);
    coarse_column.resize(columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
      coarse_column[c] =
          static_cast<std::uint32_t>(std::lower_bound(places.begin(), places.end(), coarse_place(c)) - places.begin());
    }
    std::vector<double> leakage(coarse->size(), 0.);
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const auto& beside = columns.beside[column];
      const auto leaves_pair = [&](ColumnSet::Side side) {
        return beside[side] < columns.size() && coarse_column[beside[side]] != coarse_column[column];
      };
      const bool east_leaves = leaves_pair(ColumnSet::east);
      const bool north_leaves = leaves_pair(ColumnSet::north);
      for (std::size_t k = 0; k < nz; ++k) {
        const std::size_t c = column * nz + k;
        const std::size_t to = coarse_column[column] * nz + k;
        double taken = 0;
        for (const float coupling :
             {east[c], east[beside[ColumnSet::west] * nz + k], north[c], north[beside[ColumnSet::south] * nz + k]})
          taken += static_cast<double>(coupling);
        if (k + 1 < nz) taken += static_cast<double>(up[c]);
        if (k > 0) taken += static_cast<double>(up[c - 1]);
        leakage[to] += diagonal[c] - taken;
        if (east_leaves) coarse->east[to] += east[c] / static_cast<float>(fx);
        if (north_leaves) coarse->north[to] += north[c] / static_cast<float>(fy);
        coarse->up[to] += k + 1 < nz ? up[c] : 0;
      }
    }
    coarse->close(std::move(leakage));
    return coarse;
  }
};

namespace {

// h of (23): smallest edge of the cells of level k, of the axes that the field varies along.
double smallest_edge(const BoxGrid& box, int k, double depth) {
  return std::min({box.nx > 1 ? box.dx_m : depth, box.ny > 1 ? box.dy_m : depth, box.thickness_m(k)});
}

}  // namespace

double longest_free_path(const BoxGrid& box, int k, double depth_m) {
  return std::max(4 * smallest_edge(box, k, depth_m), .05 * depth_m);
}

DiffusionOperator::DiffusionOperator(const BoxGrid& box, ColumnSet taking_part, const DiffusionCoefficients& given) {
  const auto nz = static_cast<std::size_t>(box.nz());
  auto level = std::make_unique<Level>(std::move(taking_part), nz);
  const ColumnSet& columns = level->columns;
  const double depth = box.z_edge_m.back() - box.z_edge_m.front();
  // Voids would diffuse infinitely fast and thick cells too slowly: both are bounded, or the correction makes the
  // iteration diverge.
  std::vector<double> diffusivity(columns.size() * nz);
  free_diffusivity_.reserve(diffusivity.size());
  diffusivity_.reserve(diffusivity.size());
  for (std::size_t c = 0; c < diffusivity.size(); ++c) {
    const int k = static_cast<int>(c % nz);
    const double edge = smallest_edge(box, k, depth);
    const double x = 1.5 * given.extinction[c] * edge;
    const double thick = x < 1e-2 ? x / 6 : 1 / std::tanh(x / 2) - 2 / x;
    const double free = 1 / (3 * std::max<double>(given.transport[c], 1 / longest_free_path(box, k, depth)));
    diffusivity[c] = free + edge / 4 * thick;
    free_diffusivity_.push_back(static_cast<float>(free));
    diffusivity_.push_back(static_cast<float>(diffusivity[c]));
  }

  std::vector<double> leakage(level->size(), 0.);
  // Marshak: outward current = (1 - albedo)/(2 (1 + albedo)) times the flux at the face, half a cell away.
  const double surface = (1 - given.surface_albedo) / (2 * (1 + given.surface_albedo));
  const auto boundary = [](double area, double half_width, double d, double exchange) {
    return exchange > 0 ? area / (1 / exchange + half_width / d) : 0;
  };
  for (std::size_t column = 0; column < columns.size(); ++column) {
    for (std::size_t k = 0; k < nz; ++k) {
      const std::size_t c = column * nz + k;
      const double dz = box.thickness_m(static_cast<int>(k));
      const double d = diffusivity[c];
      leakage[c] += given.absorption[c] * box.dx_m * box.dy_m * dz;
      const auto exchange = [&](ColumnSet::Side side, int count, double area, double width) {
        if (given.independent_columns || (count == 1 && box.periodic)) return 0.;
        const std::size_t other = columns.beside[column][side];
        if (other < columns.size()) {
          const double beyond = diffusivity[other * nz + k];
          return 2 * d * beyond / (d + beyond) * area / width;
        }
        leakage[c] += boundary(area, width / 2, d, .5);
        return 0.;
      };
      level->east[c] = static_cast<float>(exchange(ColumnSet::east, box.nx, box.dy_m * dz, box.dx_m));
      level->north[c] = static_cast<float>(exchange(ColumnSet::north, box.ny, box.dx_m * dz, box.dy_m));
      exchange(ColumnSet::west, box.nx, box.dy_m * dz, box.dx_m);
      exchange(ColumnSet::south, box.ny, box.dx_m * dz, box.dy_m);
      const double area = box.dx_m * box.dy_m;
      if (k + 1 < nz) {
        const double above = box.thickness_m(static_cast<int>(k) + 1);
        level->up[c] = static_cast<float>(area / (dz / (2 * d) + above / (2 * diffusivity[c + 1])));
      } else {
        leakage[c] += boundary(area, dz / 2, d, .5);
      }
      if (k == 0) leakage[c] += boundary(area, dz / 2, d, surface);
    }
  }
  level->close(std::move(leakage));
  // A wholly closed system (white surface, no absorption) leaks through the top alone, which is enough for a unique
  // solution.
  levels_.push_back(std::move(level));
  while (auto coarse = levels_.back()->coarser(box.periodic)) levels_.push_back(std::move(coarse));
}

DiffusionOperator::~DiffusionOperator() = default;
DiffusionOperator::DiffusionOperator(DiffusionOperator&&) noexcept = default;
DiffusionOperator& DiffusionOperator::operator=(DiffusionOperator&&) noexcept = default;

const ColumnSet& DiffusionOperator::columns() const { return levels_.front()->columns; }

// x of the finest grid from its right side. In float: it need only be near the solution.
void DiffusionOperator::cycle(Workspace& w) const {
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    const Level& level = *levels_[l];
    std::fill(w.x[l].begin(), w.x[l].end(), 0.F);
    level.smooth(w.x[l].data(), w.right[l].data(), false, w.work[l].data());
    if (l + 1 == levels_.size()) {
      for (int s = 0; s < 4; ++s) level.smooth(w.x[l].data(), w.right[l].data(), s % 2 == 0, w.work[l].data());
      break;
    }
    level.residual(w.right[l].data(), w.x[l].data(), w.work[l].data());
    std::fill(w.right[l + 1].begin(), w.right[l + 1].end(), 0.F);
    for (std::size_t column = 0; column < level.columns.size(); ++column) {
      const float* const from = w.work[l].data() + column * level.nz;
      float* const to = w.right[l + 1].data() + level.coarse_column[column] * level.nz;
      for (std::size_t k = 0; k < level.nz; ++k) to[k] += from[k];
    }
  }
  for (std::size_t l = levels_.size(); l-- > 0;) {
    const Level& level = *levels_[l];
    if (l + 1 < levels_.size()) {
      for (std::size_t column = 0; column < level.columns.size(); ++column) {
        const float* const from = w.x[l + 1].data() + level.coarse_column[column] * level.nz;
        float* const to = w.x[l].data() + column * level.nz;
        for (std::size_t k = 0; k < level.nz; ++k) to[k] += from[k];
      }
    }
    level.smooth(w.x[l].data(), w.right[l].data(), true, w.work[l].data());
  }
}

void DiffusionOperator::solve(std::span<const double> source, std::span<double> correction, double tolerance,
                              Workspace& work) const {
  for (auto* const arrays : {&work.x, &work.right, &work.work}) {
    arrays->resize(levels_.size());
    for (std::size_t l = 0; l < levels_.size(); ++l) (*arrays)[l].resize(levels_[l]->size());
  }
  for (auto* const array : {&work.residual, &work.direction, &work.product}) array->resize(levels_.front()->size());
  const std::size_t n = source.size();
  std::vector<double>&r = work.residual, &p = work.direction, &ap = work.product;
  const std::vector<float>& z = work.x.front();  // preconditioned residual
  const auto dot = [](std::span<const double> a, std::span<const double> b) { return ordered_dot<double>(a, b); };

  std::fill(correction.begin(), correction.end(), 0.);
  std::copy(source.begin(), source.end(), r.begin());
  const double size = dot(r, r);
  const double target = tolerance * tolerance * size;
  if (target == 0) return;
  const double scale = 1 / std::sqrt(size);  // for the range of float
  const auto precondition = [&] {
    std::transform(r.begin(), r.end(), work.right.front().begin(),
                   [scale](double value) { return static_cast<float>(scale * value); });
    cycle(work);
  };
  precondition();
  std::copy(z.begin(), z.end(), p.begin());
  double rz = dot(r, p);
  constexpr int most_iterations = 60;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    levels_.front()->residual<double>(nullptr, p.data(), ap.data());  // -A p
    const double curvature = -dot(p, ap);
    if (!(curvature > 0)) return;
    const double step = rz / curvature;
    for (std::size_t c = 0; c < n; ++c) {
      correction[c] += step * p[c];
      r[c] += step * ap[c];
    }
    if (dot(r, r) < target) return;
    precondition();
    std::copy(z.begin(), z.end(), ap.begin());
    const double next = dot(r, ap);
    const double beta = next / rz;
    rz = next;
    for (std::size_t c = 0; c < n; ++c) p[c] = ap[c] + beta * p[c];
  }
}

}  // namespace cloudbow
