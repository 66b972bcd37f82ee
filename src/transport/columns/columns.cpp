#include "transport/columns/columns.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/not_negative.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "transport/columns/column_emission.hpp"
#include "transport/columns/column_layers.hpp"
#include "transport/columns/distinct_columns.hpp"
#include "transport/columns/isotropic_basis.hpp"
#include "transport/columns/polar_streams.hpp"
#include "transport/grid/cells.hpp"
#include "transport/problem/power.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {
namespace {

constexpr double pi = std::numbers::pi;

// Sums over columns, W m-2.
struct Sums {
  explicit Sums(int levels) : up(levels, 0.), down(levels, 0.), direct(levels, 0.) {}
  void add(const Sums& other) {
    for (std::size_t e = 0; e < up.size(); ++e) {
      up[e] += other.up[e];
      down[e] += other.down[e];
      direct[e] += other.direct[e];
    }
    arriving += other.arriving;
    absorbed += other.absorbed;
    kept_by_surface += other.kept_by_surface;
    squared_imbalance += other.squared_imbalance;
  }
  std::vector<double> up, down, direct;  // [nz+1]; down: all diffuse light
  double arriving = 0;                   // at the surface
  double absorbed = 0;
  double kept_by_surface = 0;
  double squared_imbalance = 0;
};

template <class Real>
class ColumnSolver {
 public:
  ColumnSolver(const Problem& problem, const SolverOptions& options, const PolarStreams& streams,
               const ColumnCells& cells, const std::optional<SlantedBeam>& beam, const DistinctColumns& distinct,
               Solution& solution)
      : basis_(streams, problem.sun.has_value()),
        problem_(problem),
        grid_(problem.grid),
        options_(options),
        streams_(streams),
        cells_(cells),
        beam_(beam),
        distinct_(distinct),
        solution_(solution),
        columns_(problem.grid.box.columns()),
        place_of_level_(problem.grid.box.nz() + 1, -1),
        n_(streams.size()),
        isotropic_(static_cast<Real>(basis_.isotropic)),
        emits_(problem.emits()) {
    for (std::size_t f = 0; f < solution.flux_level.size(); ++f)
      place_of_level_[solution.flux_level[f]] = static_cast<int>(f);
  }

  // Columns 8 batch to 8 batch + 7 of the distinct ones.
  void solve_batch(std::size_t batch, Sums& sums) const;

 private:
  using V = Lanes<Real>;

  // A cell of each column of a batch, from the bottom up.
  struct Cells {
    V used;                    // 1 or 0
    V thickness;               // optical, forward peaks truncated
    V absorbed;                // share of the extinction
    V decay;                   // kappa
    std::vector<V> scattered;  // [p] share of the extinction
    std::vector<V> beam;       // [p] scattered share of the beam, over 4 pi
    columns::Emission<Real> emission;
  };
  // Fluxes and mean radiances of a cell.
  struct Faces {
    V opaque;                // 1 or 0, for emission
    V mean;                  // 4 pi times mean diffuse radiance in the cell; in opaque lanes less 4 pi B
    V below_mean, net, sum;  // at the face below it: 4 pi times mean radiance, fluxes from d and s
  };

  double albedo(std::size_t column) const {
    const auto& map = problem_.surface.albedo_map;
    return map.empty() ? problem_.surface.albedo : static_cast<double>(map[column]);
  }
  double planck_of_ground(std::size_t column) const {
    const auto& map = problem_.surface.planck_map;
    return map.empty() ? problem_.surface.planck : static_cast<double>(map[column]);
  }
  double mu0() const { return problem_.sun ? -problem_.sun->travel.z() : 1; }

  void fill_lane(std::size_t column, int lane, std::vector<Cells>& cells, V& ground) const;
  void fill_emission(std::size_t column, int lane, std::vector<Cells>& cells, V& ground, V& top) const;
  void make_layer(const Cells& cell, columns::Layer<Real>& layer) const;
  void write_column(std::size_t column, int lane, const std::vector<Faces>& faces, const Faces& top, Sums& sums) const;

  // In its basis are s, d and all of columns::.
  columns::IsotropicBasis<Real> basis_;
  const Problem& problem_;
  const OpticalGrid& grid_;
  const SolverOptions& options_;
  const PolarStreams& streams_;
  const ColumnCells& cells_;
  const std::optional<SlantedBeam>& beam_;
  const DistinctColumns& distinct_;
  Solution& solution_;
  std::size_t columns_;
  std::vector<int> place_of_level_;
  int n_;
  Real isotropic_;  // length of the vector of isotropic light
  bool emits_;
};

// Optical path of a cell without the fraction f of the scattering by each phase function.
double extinction(const OpticalGrid& grid, std::size_t cell, const PolarStreams& streams,
                  double PolarStreams::Scattering::*fraction) {
  double sum = grid.absorption[cell];
  for (std::size_t p = 0; p < grid.scattering.size(); ++p)
    sum += (1 - streams.phase[p].*fraction) * grid.scattering[p][cell];
  return sum;
}

template <class Real>
void ColumnSolver<Real>::fill_lane(std::size_t column, int lane, std::vector<Cells>& cells, V& ground) const {
  const auto of_column = cells_.of(column);
  double path = 0;  // of the beam, from the top
  std::size_t level = grid_.box.nz() - 1;
  for (std::size_t r = of_column.size(); r-- > 0;) {
    const std::uint32_t c = of_column[r];
    while (cells_.level_cell[level] > c) --level;
    const double dz = grid_.box.thickness_m(static_cast<int>(level));
    const double sigma = extinction(grid_, c, streams_, &PolarStreams::Scattering::diffuse_fraction);
    const double sigma_b = extinction(grid_, c, streams_, &PolarStreams::Scattering::beam_fraction);
    Cells& cell = cells[r];
    cell.used[lane] = 1;
    cell.thickness[lane] = static_cast<Real>(sigma * dz);
    cell.absorbed[lane] = static_cast<Real>(grid_.absorption[c] / sigma);
    double irradiance = 0;  // to which sources refer: at the top of the cell, or its mean
    if (beam_) {
      irradiance = beam_->at(c, level * columns_ + column);
    } else if (problem_.sun) {
      irradiance = problem_.sun->irradiance * std::exp(-path);
      path += sigma_b * dz / mu0();
      cell.decay[lane] = static_cast<Real>(sigma_b / sigma / mu0());
    }
    for (std::size_t p = 0; p < basis_.shapes.size(); ++p) {
      const double scattering = grid_.scattering[p][c] / sigma;
      cell.scattered[p][lane] = static_cast<Real>((1 - streams_.phase[p].diffuse_fraction) * scattering);
      cell.beam[p][lane] =
          static_cast<Real>((1 - streams_.phase[p].beam_fraction) * scattering * irradiance / (4 * pi));
    }
  }
  double arriving = 0;
  if (beam_) {
    arriving = beam_->carried[column];
  } else if (problem_.sun) {
    arriving = problem_.sun->irradiance * mu0() * std::exp(-path);
  }
  ground[lane] = static_cast<Real>(arriving);
}

// @param ground reference of the face above it, less its Planck radiance
// @param top reference there
template <class Real>
void ColumnSolver<Real>::fill_emission(std::size_t column, int lane, std::vector<Cells>& cells, V& ground,
                                       V& top) const {
  const auto of_column = cells_.of(column);
  double above_ground = 0, reference = 0;
  for (std::size_t r = 0; grid_.emits() && r < of_column.size(); ++r) {
    const std::uint32_t c = of_column[r];
    const double thickness = static_cast<double>(cells[r].thickness[lane]);
    const columns::CellEmission of_cell(thickness, thickness * static_cast<double>(cells[r].absorbed[lane]),
                                        grid_.planck[c], -static_cast<double>(grid_.planck_step[c]));
    if (r == 0) above_ground = reference = of_cell.bottom;
    columns::set_emission<Real>(lane, of_cell, reference, cells[r].emission);
    reference = of_cell.top;
  }
  ground[lane] = static_cast<Real>(above_ground - planck_of_ground(column));
  top[lane] = static_cast<Real>(reference);
}

template <class Real>
void ColumnSolver<Real>::make_layer(const Cells& cell, columns::Layer<Real>& layer) const {
  const int n = n_;
  columns::Matter<Real> matter;
  columns::Triangle<Real> odd;
  for (int e = 0; e < columns::entries(n); ++e) matter.loss[e] = odd[e] = V{};
  for (int i = 0; i < n; ++i) matter.source_of_sum[i] = matter.source_of_difference[i] = V{};
  for (std::size_t p = 0; p < basis_.shapes.size(); ++p) {
    const auto& shape = basis_.shapes[p];
    const V b = cell.scattered[p];
    bool any = false;
    for (int lane = 0; lane < lanes; ++lane) any = any || b[lane] > 0;
    if (!any) continue;
    for (int e = 0; e < columns::entries(n); ++e) {
      matter.loss[e] -= b * shape.even[e];
      odd[e] -= b * shape.odd[e];
    }
    for (int i = 0; i < n; ++i) {
      matter.source_of_sum[i] += cell.beam[p] * shape.from_beam_even[i];
      matter.source_of_difference[i] += cell.beam[p] * shape.from_beam_odd[i];
    }
  }
  // B: its first row is the loss of isotropic light by absorption alone (Eq. 36), to the last digit.
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) {
      V& loss = matter.loss[columns::place(i, j)];
      loss = j == 0 ? cell.absorbed * basis_.loss_of_isotropic[i] : loss + basis_.inverse_cosine[columns::place(i, j)];
    }
    odd[columns::place(i, i)] += Real(1);
  }
  // A^-1 = M^1/2 (1 - K-)^-1 M^1/2
  columns::factorise<Real>(n, odd);
  columns::Matrix<Real> root;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) root[i][j] = V{} + basis_.root[i * n + j];
  }
  columns::forward<Real>(n, n, odd, root);
  columns::gram<Real>(n, n, odd, root, matter.length);
  matter.decay = cell.decay;

  // Thin: half of it is crossed by the most grazing stream, and by the sun, without much loss.
  constexpr double thin = .7;
  Real steps = 0;
  for (int lane = 0; lane < lanes; ++lane) {
    const Real reach = std::max(cell.thickness[lane] / static_cast<Real>(2 * thin * streams_.cosine[0]),
                                cell.thickness[lane] * cell.decay[lane]);
    steps = std::max(steps, reach);
  }
  const int doublings = steps > 1 ? static_cast<int>(std::ceil(std::log2(static_cast<double>(steps)))) : 0;
  const V start = cell.thickness * static_cast<Real>(std::ldexp(1., -doublings));
  V left, passed, lost;
  for (int lane = 0; lane < lanes; ++lane) {
    const Real path = cell.decay[lane] * start[lane];
    lost[lane] = -std::expm1(-path);
    passed[lane] = 1 - lost[lane];
    left[lane] = path > 0 ? lost[lane] / path : Real(1);
  }
  columns::make_thin_layer<Real>(n, matter, start, left, basis_.mean, layer);
  columns::Vector<Real> odd_source;
  if (grid_.emits())
    columns::make_odd_source<Real>(n, Real(.5) * start * cell.absorbed, basis_.loss_of_isotropic.data(), odd_source);
  for (int step = 0; step < doublings; ++step) {
    if (grid_.emits()) columns::double_odd_source<Real>(n, layer.shunt, odd_source);
    columns::double_layer<Real>(n, passed, lost, layer);
    lost *= Real(1) + passed;
    passed *= passed;
  }
  if (grid_.emits()) columns::add_emission<Real>(n, isotropic_, cell.emission, matter.length, odd_source, layer);
}

template <class Real>
void ColumnSolver<Real>::solve_batch(std::size_t batch, Sums& sums) const {
  const int n = n_;
  const std::size_t first = batch * lanes;
  const int width = static_cast<int>(std::min<std::size_t>(lanes, distinct_.first.size() - first));
  const std::size_t height = cells_.of(distinct_.first[first]).size();  // sorted: the tallest
  const std::vector<V> nothing(basis_.shapes.size(), V{});
  const Cells none{V{}, V{} + Real(1), V{} + Real(1), V{}, nothing, nothing, {}};
  std::vector<Cells> cells(height, none);
  V ground{}, reflected{}, kept = V{} + Real(1), reference_at_ground{}, reference{};
  for (int lane = 0; lane < width; ++lane) {
    const std::size_t column = distinct_.first[first + lane];
    fill_lane(column, lane, cells, ground);
    reflected[lane] = static_cast<Real>(albedo(column));
    kept[lane] = Real(1) - reflected[lane];
    if (!emits_) continue;
    kept[lane] = static_cast<Real>(1 - albedo(column));  // the emissivity, with all its digits
    fill_emission(column, lane, cells, reference_at_ground, reference);
  }

  // The ground: G = 1 - 2A/(1 + A) u u^T of the first axis u, and c.
  columns::Below<Real> below;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) below.conductance[columns::place(i, j)] = V{} + Real(i == j);
    below.source[i] = V{};
  }
  below.conductance[0] = kept / (Real(1) + reflected);
  below.source[0] = Real(-2) * reflected / (Real(1) + reflected) * ground * static_cast<Real>(basis_.isotropic / pi);
  if (emits_) columns::raise_reference<Real>(n, isotropic_, reference_at_ground, below);
  std::vector<V> memory(height * columns::Passage<Real>::size(n));
  const auto passage = [&](std::size_t r) {
    return columns::Passage<Real>(n, memory.data() + r * columns::Passage<Real>::size(n));
  };
  columns::Layer<Real> layer;
  for (std::size_t r = 0; r < height; ++r) {
    make_layer(cells[r], layer);
    if (emits_) columns::raise_reference<Real>(n, isotropic_, cells[r].emission.jump, below);
    columns::stack<Real>(n, layer, basis_.flux, cells[r].used > Real(0), below, passage(r));
  }

  // At the top (1 + G) s + c is twice the incident light.
  columns::Triangle<Real> factors;
  for (int e = 0; e < columns::entries(n); ++e) factors[e] = below.conductance[e];
  const V sky = V{} + static_cast<Real>(2 * problem_.sky_radiance * basis_.isotropic);
  const V from_above = emits_ ? Real(2) * isotropic_ * (static_cast<Real>(problem_.sky_radiance) - reference) : sky;
  columns::Vector<Real> s;
  for (int i = 0; i < n; ++i) {
    factors[columns::place(i, i)] += Real(1);
    s[i] = (i == 0 ? from_above : V{}) - below.source[i];
  }
  columns::factorise<Real>(n, factors);
  columns::solve<Real>(n, factors, s);

  const auto look = [&](Faces& face) {
    face.below_mean = face.sum = V{};
    for (int i = 0; i < n; ++i) {
      face.below_mean += basis_.mean[i] * s[i];
      face.sum += basis_.flux[i] * s[i];
    }
    if (!emits_) return;
    face.below_mean += static_cast<Real>(4 * pi) * reference;
    face.sum += static_cast<Real>(2 * pi) * reference;
  };
  Faces top{};
  look(top);
  columns::Vector<Real> d;
  for (int i = 0; i < n; ++i) d[i] = below.source[i];
  columns::add_product<Real>(n, below.conductance, s, d);
  for (int i = 0; i < n; ++i) top.net += basis_.flux[i] * d[i];
  std::vector<Faces> faces(height);
  for (std::size_t r = height; r-- > 0;) {
    const auto through = passage(r);
    const auto used = cells[r].used > Real(0);
    columns::Vector<Real> next;
    columns::pass<Real>(n, through, s, next);
    Faces& face = faces[r];
    face.mean = *through.own_mean;
    face.net = *through.own_net;
    for (int i = 0; i < n; ++i) {
      face.mean += through.mean[i] * Real(.5) * (s[i] + next[i]);
      face.net += through.net[i] * next[i];
      s[i] = used ? next[i] : s[i];
    }
    if (emits_) {
      face.opaque = cells[r].emission.opaque;
      reference = used ? cells[r].emission.reference : reference;
    }
    look(face);
    if (emits_) s[0] += Real(2) * isotropic_ * cells[r].emission.jump;
  }
  for (int lane = 0; lane < width; ++lane) write_column(distinct_.first[first + lane], lane, faces, top, sums);
}

template <class Real>
void ColumnSolver<Real>::write_column(std::size_t column, int lane, const std::vector<Faces>& faces, const Faces& top,
                                      Sums& sums) const {
  const BoxGrid& box = grid_.box;
  const auto of_column = cells_.of(column);
  std::vector<std::uint32_t> alike{static_cast<std::uint32_t>(column)};
  while (distinct_.next[alike.back()] != alike.back()) alike.push_back(distinct_.next[alike.back()]);
  const double count = static_cast<double>(alike.size());
  const double irradiance = problem_.sun ? problem_.sun->irradiance : 0;

  double true_path = 0, beam_path = 0;
  double scattered = 0, absorbed_diffuse = 0;
  double up = 0, down = 0, carried = 0;
  const Faces* face = &top;
  const auto write_level = [&](int level) {
    up = .5 * static_cast<double>(face->sum[lane] - face->net[lane]);
    down = .5 * static_cast<double>(face->sum[lane] + face->net[lane]);
    double direct = 0;
    carried = 0;
    if (beam_) {
      carried = beam_->carried[level * columns_ + column];
      direct = beam_->direct[level * columns_ + column];
    } else if (problem_.sun) {
      carried = irradiance * mu0() * std::exp(-beam_path);
      direct = irradiance * mu0() * std::exp(-true_path);
    }
    // In very dark cells rounding can make the flux slightly negative.
    const double upward = not_negative(up);
    const double diffuse = not_negative(down + carried - direct);
    sums.up[level] += count * upward;
    sums.down[level] += count * diffuse;
    sums.direct[level] += count * direct;
    if (place_of_level_[level] < 0) return;
    const std::size_t at = static_cast<std::size_t>(place_of_level_[level]) * columns_;
    for (const std::uint32_t c : alike) {
      solution_.upwelling_flux[at + c] = static_cast<float>(upward);
      solution_.downwelling_diffuse_flux[at + c] = static_cast<float>(diffuse);
      solution_.direct_flux[at + c] = static_cast<float>(direct);
    }
  };

  write_level(box.nz());
  const double up_top = up;
  double absorbed = 0;
  std::size_t r = of_column.size();
  for (int k = box.nz() - 1; k >= 0; --k) {
    double beam_mean = irradiance * std::exp(-beam_path);
    double actinic = static_cast<double>(face->below_mean[lane]);
    const std::size_t place = static_cast<std::size_t>(k) * columns_;
    if (r > 0 && of_column[r - 1] >= cells_.level_cell[k]) {
      const std::uint32_t c = of_column[--r];
      const double dz = box.thickness_m(k);
      face = &faces[r];
      double diffuse = static_cast<double>(face->mean[lane]);
      double net = diffuse;  // of emission
      if (grid_.emits()) {
        // In opaque cells the mean is net, and closes with the fluxes without a difference of large numbers.
        const double emitted = 4 * pi * static_cast<double>(grid_.planck[c]);
        if (face->opaque[lane] > 0) {
          diffuse += emitted;
        } else {
          net -= emitted;
        }
      }
      if (beam_) {
        beam_mean = beam_->at(c, place + column);
      } else if (problem_.sun) {
        double sigma = grid_.absorption[c];
        for (const auto& scattering : grid_.scattering) sigma += scattering[c];
        const double path = extinction(grid_, c, streams_, &PolarStreams::Scattering::beam_fraction) * dz / mu0();
        beam_mean *= path > 0 ? -std::expm1(-path) / path : 1;
        true_path += sigma * dz / mu0();
        beam_path += path;
      }
      actinic = diffuse + beam_mean;
      absorbed_diffuse += grid_.absorption[c] * net * dz;
      absorbed += grid_.absorption[c] * (net + beam_mean) * dz;
      for (std::size_t p = 0; p < basis_.shapes.size(); ++p)
        scattered += (1 - streams_.phase[p].beam_fraction) * grid_.scattering[p][c] * beam_mean * dz;
      if (options_.absorption) {
        for (const std::uint32_t a : alike)
          solution_.absorbed_power[place + a] = static_cast<float>(grid_.absorption[c] * (net + beam_mean));
      }
    } else if (options_.actinic && problem_.sun) {
      actinic += beam_ ? beam_->at(0, place + column) : beam_mean;
    }
    if (options_.actinic) {
      for (const std::uint32_t a : alike) solution_.actinic_flux[place + a] = static_cast<float>(actinic);
    }
    write_level(k);
  }
  const double kept = 1 - albedo(column);
  sums.arriving += count * (down + carried);
  sums.absorbed += count * absorbed;
  sums.kept_by_surface += count * kept * (down + carried);
  double imbalance =
      scattered + pi * problem_.sky_radiance + albedo(column) * carried - (up_top + absorbed_diffuse + kept * down);
  if (emits_) imbalance += kept * pi * planck_of_ground(column);
  sums.squared_imbalance += count * imbalance * imbalance;
}

template <class Real>
Sums solve_distinct(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress,
                    const PolarStreams& streams, const std::optional<SlantedBeam>& beam, Solution& solution) {
  const ColumnCells cells = column_cells(problem.grid);
  const DistinctColumns distinct = distinct_columns(problem, cells, beam);
  const ColumnSolver<Real> solver(problem, options, streams, cells, beam, distinct, solution);
  const std::size_t batches = (distinct.first.size() + lanes - 1) / lanes;
  // Sums go by groups of batches and then in one order, whatever the number of threads.
  constexpr std::size_t group = 8;
  std::vector<Sums> sums((batches + group - 1) / group, Sums(problem.grid.box.nz() + 1));
  std::atomic<std::size_t> done = 0;
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t g = 0; g < sums.size(); ++g) {
    errors.run([&] {
      for (std::size_t b = g * group; b < std::min(batches, (g + 1) * group); ++b) solver.solve_batch(b, sums[g]);
      ++done;
      if (omp_get_thread_num() != 0 || !progress) return;
      progress({"columns", 1, 0, 0, static_cast<double>(done) / static_cast<double>(sums.size())});
    });
  }
  errors.rethrow();
  for (std::size_t g = 1; g < sums.size(); ++g) sums.front().add(sums[g]);
  return std::move(sums.front());
}

}  // namespace

template <class Real>
Solution solve_columns(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress) {
  if (options.column_streams < 2 || options.column_streams > columns::most_streams) {
    throw InputError(
        fmt::format("column_streams: found {}, allowed 2 to {}", options.column_streams, columns::most_streams));
  }
  const BoxGrid& box = problem.grid.box;
  const double columns = static_cast<double>(box.columns());
  const double mu0 = problem.sun ? -problem.sun->travel.z() : 1;
  Solution solution;
  solution.box = box;
  solution.sun = problem.sun;
  solution.emits = problem.emits();
  solution.flux_level = flux_levels(box, options);
  for (const OutputField& field : output_fields()) {
    const bool has_own_key = field.key == nullptr;
    if (has_own_key || (field.asked != nullptr && !(options.*field.asked))) continue;
    const bool at_levels = field.grid == OutputField::Grid::levels;
    const std::size_t planes = at_levels ? solution.flux_level.size() : static_cast<std::size_t>(box.nz());
    (solution.*field.values).assign(planes * box.columns(), 0.F);
  }

  const PolarStreams streams = make_polar_streams(options.column_streams, problem.phase,
                                                  problem.sun ? std::optional<double>(mu0) : std::nullopt);
  const std::optional<SlantedBeam> beam = slanted_beam(problem, options, streams);
  const Sums sums = solve_distinct<Real>(problem, options, progress, streams, beam, solution);

  const auto profile = [&](const std::vector<double>& sum) {
    std::vector<double> mean = sum;
    for (double& m : mean) m /= columns;
    return mean;
  };
  solution.profile_upwelling_flux = profile(sums.up);
  solution.profile_downwelling_diffuse_flux = profile(sums.down);
  solution.profile_direct_flux = profile(sums.direct);
  const double incident = incident_power(problem);
  const double from_ground = ground_emission(problem);
  const double power = incident + from_ground + matter_emission(problem);
  SolverReport& report = solution.report;
  report.sweeps = 1;
  report.directions = fmt::format("double-gauss-{}", 2 * options.column_streams);
  report.surface_largest_albedo = problem.surface.albedo_map.empty()
                                      ? problem.surface.albedo
                                      : static_cast<double>(*std::max_element(problem.surface.albedo_map.begin(),
                                                                              problem.surface.albedo_map.end()));
  report.converged = true;
  if (power == 0) return solution;  // a dark scene closes trivially
  EnergyLedger& ledger = solution.ledger;
  ledger.power = power;
  ledger.incident = incident / power;
  ledger.surface_emission = from_ground / power;
  ledger.reflectance = solution.profile_upwelling_flux.back() / power;
  ledger.transmittance = sums.arriving / columns / power;
  ledger.transmittance_direct = solution.profile_direct_flux.front() / power;
  ledger.absorptance = sums.absorbed / columns / power;
  ledger.surface_absorptance = sums.kept_by_surface / columns / power;
  if (beam) {
    ledger.side_gain = beam->side_gain / power;
    ledger.side_loss = beam->side_loss / power;
  }
  ledger.residual = ledger.incident + ledger.surface_emission + ledger.side_gain -
                    (ledger.reflectance + ledger.absorptance + ledger.surface_absorptance + ledger.side_loss);
  report.estimated_error = std::sqrt(sums.squared_imbalance / columns) / power;
  report.converged =
      report.estimated_error <= options.tolerance && std::abs(ledger.residual) <= options.energy_tolerance;
  return solution;
}

template Solution solve_columns<float>(const Problem&, const SolverOptions&, const ProgressCallback&);
template Solution solve_columns<double>(const Problem&, const SolverOptions&, const ProgressCallback&);

}  // namespace cloudbow
