#include "transport/acceleration/diffusion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cloudbow/core/parallel_errors.hpp"

namespace cloudbow {

// Below this many cells a parallel loop costs more than it saves.
constexpr std::size_t worth_threads = 100000;

// One grid of the multigrid: couplings to the next cell along each axis (periodic neighbour included) and the diagonal.
struct DiffusionOperator::Level {
  int nx = 1, ny = 1, nz = 1;
  int factor_x = 1, factor_y = 1;  // cells of the next finer level in one of this level
  std::vector<double> east, north, up, diagonal;

  std::size_t size() const { return diagonal.size(); }
  std::size_t at(int i, int j, int k) const { return (static_cast<std::size_t>(k) * ny + j) * nx + i; }
  int next(int i, int n) const { return i + 1 < n ? i + 1 : 0; }
  int before(int i, int n) const { return i > 0 ? i - 1 : n - 1; }

  // diagonal = leakage + losses of each cell through its couplings.
  void close(std::vector<double> leakage) {
    diagonal = std::move(leakage);
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
          const std::size_t c = at(i, j, k);
          diagonal[c] += east[c] + north[c];
          diagonal[at(next(i, nx), j, k)] += east[c];
          diagonal[at(i, next(j, ny), k)] += north[c];
          if (k + 1 < nz) {
            diagonal[c] += up[c];
            diagonal[at(i, j, k + 1)] += up[c];
          }
        }
      }
    }
  }

  void apply(std::span<const double> x, std::span<double> y) const {
    // Nothing throws here.
#pragma omp parallel for schedule(static) if (size() > worth_threads)
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
          const std::size_t c = at(i, j, k);
          const std::size_t west = at(before(i, nx), j, k);
          const std::size_t south = at(i, before(j, ny), k);
          double sum = diagonal[c] * x[c] - east[c] * x[at(next(i, nx), j, k)] - east[west] * x[west] -
                       north[c] * x[at(i, next(j, ny), k)] - north[south] * x[south];
          if (k + 1 < nz) sum -= up[c] * x[at(i, j, k + 1)];
          if (k > 0) sum -= up[at(i, j, k - 1)] * x[at(i, j, k - 1)];
          y[c] = sum;
        }
      }
    }
  }

  // Zebra Gauss-Seidel over whole columns: one colour, then the other; `reversed` makes the pair symmetric.
  void smooth(std::span<double> x, std::span<const double> b, bool reversed) const {
    for (int half = 0; half < 2; ++half) {
      const int colour = reversed ? 1 - half : half;
      // With odd periodic sizes two columns of one colour are neighbours at the seam. The order of rows matters there,
      // so it stays serial.
      const bool independent = (nx == 1 || nx % 2 == 0) && (ny == 1 || ny % 2 == 0) && size() > worth_threads;
      ParallelErrors errors;
#pragma omp parallel if (independent)
      {
        std::vector<double> upper, value;
        errors.run([&] {
          upper.resize(static_cast<std::size_t>(nz));
          value.resize(static_cast<std::size_t>(nz));
        });
#pragma omp for schedule(static)
        for (int j = 0; j < ny; ++j) {
          errors.run([&] {
            for (int i = (colour + j) & 1; i < nx; i += 2) solve_column(i, j, x, b, upper, value);
          });
        }
      }
      errors.rethrow();
    }
  }

  void solve_column(int i, int j, std::span<double> x, std::span<const double> b, std::vector<double>& upper,
                    std::vector<double>& value) const {
    const int east_i = next(i, nx), west_i = before(i, nx), north_j = next(j, ny), south_j = before(j, ny);
    for (int k = 0; k < nz; ++k) {
      const std::size_t c = at(i, j, k);
      double right = b[c];
      // On a periodic axis of one cell, the cell would be its own neighbour; its couplings are zero.
      right += east[c] * x[at(east_i, j, k)] + east[at(west_i, j, k)] * x[at(west_i, j, k)];
      right += north[c] * x[at(i, north_j, k)] + north[at(i, south_j, k)] * x[at(i, south_j, k)];
      const double below = k > 0 ? up[at(i, j, k - 1)] : 0;
      const double pivot = diagonal[c] - (k > 0 ? below * upper[k - 1] : 0);
      upper[k] = (k + 1 < nz ? up[c] : 0) / pivot;
      value[k] = (right + (k > 0 ? below * value[k - 1] : 0)) / pivot;
    }
    double above = 0;
    for (int k = nz - 1; k >= 0; --k) {
      above = value[k] + (k + 1 < nz ? upper[k] * above : 0);
      x[at(i, j, k)] = above;
    }
  }

  // Aggregates pairs of columns; couplings are divided by the pair's width (a plain Galerkin sum would be too stiff).
  std::unique_ptr<Level> coarser() const {
    const int fx = nx > 2 ? 2 : 1;
    const int fy = ny > 2 ? 2 : 1;
    if (fx * fy == 1) return nullptr;
    auto coarse = std::make_unique<Level>();
    coarse->nx = (nx + fx - 1) / fx;
    coarse->ny = (ny + fy - 1) / fy;
    coarse->nz = nz;
    coarse->factor_x = fx;
    coarse->factor_y = fy;
    const std::size_t n = static_cast<std::size_t>(coarse->nx) * coarse->ny * nz;
    coarse->east.assign(n, 0.);
    coarse->north.assign(n, 0.);
    coarse->up.assign(n, 0.);
    std::vector<double> leakage(n, 0.);
    for (int k = 0; k < nz; ++k) {
      for (int j = 0; j < ny; ++j) {
        for (int i = 0; i < nx; ++i) {
          const std::size_t c = at(i, j, k);
          const std::size_t to = coarse->at(i / fx, j / fy, k);
          double taken = east[c] + east[at(before(i, nx), j, k)] + north[c] + north[at(i, before(j, ny), k)];
          if (k + 1 < nz) taken += up[c];
          if (k > 0) taken += up[at(i, j, k - 1)];
          leakage[to] += diagonal[c] - taken;
          if (next(i, nx) / fx != i / fx) coarse->east[to] += east[c] / fx;
          if (next(j, ny) / fy != j / fy) coarse->north[to] += north[c] / fy;
          coarse->up[to] += k + 1 < nz ? up[c] : 0;
        }
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

DiffusionOperator::DiffusionOperator(const BoxGrid& box, const DiffusionCoefficients& given) {
  auto level = std::make_unique<Level>();
  level->nx = box.nx;
  level->ny = box.ny;
  level->nz = box.nz();
  const std::size_t n = box.columns() * static_cast<std::size_t>(box.nz());
  const double depth = box.z_edge_m.back() - box.z_edge_m.front();
  // Voids would diffuse infinitely fast and thick cells too slowly: both are bounded, or the correction makes the
  // iteration diverge.
  std::vector<double> diffusivity(n);
  for (std::size_t c = 0; c < n; ++c) {
    const int k = static_cast<int>(c / box.columns());
    const double edge = smallest_edge(box, k, depth);
    const double x = 1.5 * given.extinction[c] * edge;
    const double thick = x < 1e-2 ? x / 6 : 1 / std::tanh(x / 2) - 2 / x;
    const double free = 1 / (3 * std::max<double>(given.transport[c], 1 / longest_free_path(box, k, depth)));
    diffusivity[c] = free + edge / 4 * thick;
    free_diffusivity_.push_back(static_cast<float>(free));
    diffusivity_.push_back(static_cast<float>(diffusivity[c]));
  }

  level->east.assign(n, 0.);
  level->north.assign(n, 0.);
  level->up.assign(n, 0.);
  std::vector<double> leakage(n);
  // Marshak: outward current = (1 - albedo)/(2 (1 + albedo)) times the flux at the face, half a cell away.
  const double surface = (1 - given.surface_albedo) / (2 * (1 + given.surface_albedo));
  const auto boundary = [](double area, double half_width, double d, double exchange) {
    return exchange > 0 ? area / (1 / exchange + half_width / d) : 0;
  };
  for (int k = 0; k < box.nz(); ++k) {
    const double dz = box.thickness_m(k);
    for (int j = 0; j < box.ny; ++j) {
      for (int i = 0; i < box.nx; ++i) {
        const std::size_t c = level->at(i, j, k);
        const double d = diffusivity[c];
        leakage[c] = given.absorption[c] * box.dx_m * box.dy_m * dz;
        const auto harmonic = [&](std::size_t other) { return 2 * d * diffusivity[other] / (d + diffusivity[other]); };
        const auto side = [&](std::vector<double>& coupling, int position, int count, std::size_t other, double area,
                              double width) {
          if (given.independent_columns || (count == 1 && box.periodic)) return;
          if (position + 1 < count || (box.periodic && count > 1)) {
            coupling[c] = harmonic(other) * area / width;
          }
          if (!box.periodic)
            leakage[c] += ((position == 0) + (position == count - 1)) * boundary(area, width / 2, d, .5);
        };
        side(level->east, i, box.nx, level->at(level->next(i, box.nx), j, k), box.dy_m * dz, box.dx_m);
        side(level->north, j, box.ny, level->at(i, level->next(j, box.ny), k), box.dx_m * dz, box.dy_m);
        const double area = box.dx_m * box.dy_m;
        if (k + 1 < box.nz()) {
          const double above = box.thickness_m(k + 1);
          level->up[c] = area / (dz / (2 * d) + above / (2 * diffusivity[level->at(i, j, k + 1)]));
        } else {
          leakage[c] += boundary(area, dz / 2, d, .5);
        }
        if (k == 0) leakage[c] += boundary(area, dz / 2, d, surface);
      }
    }
  }
  level->close(std::move(leakage));
  // A wholly closed system (white surface, no absorption) leaks through the top alone, which is enough for a unique
  // solution.
  levels_.push_back(std::move(level));
  while (auto coarse = levels_.back()->coarser()) levels_.push_back(std::move(coarse));
}

DiffusionOperator::~DiffusionOperator() = default;
DiffusionOperator::DiffusionOperator(DiffusionOperator&&) noexcept = default;
DiffusionOperator& DiffusionOperator::operator=(DiffusionOperator&&) noexcept = default;

void DiffusionOperator::solve(std::span<const double> source, std::span<double> correction, double tolerance) const {
  const std::size_t n = levels_.front()->size();
  std::vector<std::vector<double>> x(levels_.size()), right(levels_.size()), residual(levels_.size());
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    x[l].resize(levels_[l]->size());
    right[l].resize(levels_[l]->size());
    residual[l].resize(levels_[l]->size());
  }
  const auto v_cycle = [&](std::span<const double> b, std::span<double> out) {
    std::copy(b.begin(), b.end(), right[0].begin());
    for (std::size_t l = 0; l < levels_.size(); ++l) {
      const Level& level = *levels_[l];
      std::fill(x[l].begin(), x[l].end(), 0.);
      level.smooth(x[l], right[l], false);
      if (l + 1 == levels_.size()) {
        for (int s = 0; s < 4; ++s) level.smooth(x[l], right[l], s % 2 == 0);
        break;
      }
      level.apply(x[l], residual[l]);
      for (std::size_t c = 0; c < level.size(); ++c) residual[l][c] = right[l][c] - residual[l][c];
      const Level& coarse = *levels_[l + 1];
      std::fill(right[l + 1].begin(), right[l + 1].end(), 0.);
      for (int k = 0; k < level.nz; ++k)
        for (int j = 0; j < level.ny; ++j)
          for (int i = 0; i < level.nx; ++i)
            right[l + 1][coarse.at(i / coarse.factor_x, j / coarse.factor_y, k)] += residual[l][level.at(i, j, k)];
    }
    for (std::size_t l = levels_.size(); l-- > 0;) {
      const Level& level = *levels_[l];
      if (l + 1 < levels_.size()) {
        const Level& coarse = *levels_[l + 1];
        for (int k = 0; k < level.nz; ++k)
          for (int j = 0; j < level.ny; ++j)
            for (int i = 0; i < level.nx; ++i)
              x[l][level.at(i, j, k)] += x[l + 1][coarse.at(i / coarse.factor_x, j / coarse.factor_y, k)];
      }
      level.smooth(x[l], right[l], true);
    }
    std::copy(x[0].begin(), x[0].end(), out.begin());
  };
  const auto dot = [](std::span<const double> a, std::span<const double> b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.);
  };

  std::fill(correction.begin(), correction.end(), 0.);
  std::vector<double> r(source.begin(), source.end()), z(n), p, ap(n);
  const double target = tolerance * tolerance * dot(r, r);
  if (target == 0) return;
  v_cycle(r, z);
  p = z;
  double rz = dot(r, z);
  constexpr int most_iterations = 60;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    levels_.front()->apply(p, ap);
    const double curvature = dot(p, ap);
    if (!(curvature > 0)) return;
    const double step = rz / curvature;
    for (std::size_t c = 0; c < n; ++c) {
      correction[c] += step * p[c];
      r[c] -= step * ap[c];
    }
    if (dot(r, r) < target) return;
    v_cycle(r, z);
    const double next = dot(r, z);
    const double beta = next / rz;
    rz = next;
    for (std::size_t c = 0; c < n; ++c) p[c] = z[c] + beta * p[c];
  }
}

}  // namespace cloudbow
