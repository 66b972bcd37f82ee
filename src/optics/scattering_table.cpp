#include "cloudbow/optics/scattering_table.hpp"

#include <fmt/format.h>

#include <Eigen/Sparse>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <numbers>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "column_fit.hpp"
#include "table_cache.hpp"

namespace cloudbow {
namespace {

constexpr double four_pi = 4 * std::numbers::pi;
constexpr double same_direction = 1 - 1e-10;  // dot product; neighbours are farther apart than 1e-5 rad

void check(const FitOptions& options) {
  const int n = options.delta_m_order, beam = options.beam_delta_m_order;
  if (n < 1 || beam < n || beam > 64) {
    throw InputError(fmt::format(
        "scattering table: delta-M orders {} and, for the beam, {} (allowed: 1 <= order <= beam order <= 64)", n,
        beam));
  }
  if (options.exact_moments < 0 || options.exact_moments > 12) {
    throw InputError(fmt::format("scattering table: exact moments up to {} (allowed: 0 to 12)", options.exact_moments));
  }
  if (options.beam_half_range_rows < 0 || options.beam_half_range_rows > 6) {
    throw InputError(
        fmt::format("scattering table: {} half-range rows (allowed: 0 to 6)", options.beam_half_range_rows));
  }
}

Eigen::SparseMatrix<double> interpolation(const ControlPoints& points, const OrdinateSet& ordinates) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int d = 0; d < ordinates.size(); ++d) {
    const Stencil s = points.stencil(ordinates.direction[d]);
    for (int k = 0; k < 3; ++k) {
      if (s.weight[k] > 0) entries.emplace_back(d, s.index[k], s.weight[k]);
    }
  }
  Eigen::SparseMatrix<double> matrix(ordinates.size(), points.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Image of each control point under a map; empty if it does not map the points onto themselves.
std::vector<int> permutation(const ControlPoints& points, const Eigen::Matrix3d& map) {
  std::vector<int> to;
  for (const Direction& v : points.directions()) {
    const Stencil s = points.stencil(map * v);
    const auto nearest = std::max_element(s.weight.begin(), s.weight.end()) - s.weight.begin();
    to.push_back(s.index[nearest]);
    if (points.directions()[to.back()].dot(map * v) < same_direction) return {};
  }
  return to;
}

struct SymmetryMap {
  Eigen::Matrix3d map;
  std::vector<int> control_point_to;
};

/// An ordinate whose column is a permutation of its representative's: by each of the maps that take the one to the
/// other.
struct Member {
  int ordinate;
  std::vector<const SymmetryMap*> maps;
};
struct Orbit {
  int representative;
  std::vector<Member> members;
};

std::vector<SymmetryMap> common_symmetry(const ControlPoints& points, const OrdinateSet& ordinates) {
  std::vector<SymmetryMap> maps;
  for (const auto& map : ordinates.symmetry) {
    std::vector<int> to = permutation(points, map);
    if (!to.empty()) maps.push_back({map, std::move(to)});
  }
  if (maps.empty()) maps.push_back({Eigen::Matrix3d::Identity(), permutation(points, Eigen::Matrix3d::Identity())});
  return maps;
}

std::vector<Orbit> orbits_of(const OrdinateSet& ordinates, const std::vector<SymmetryMap>& maps) {
  std::vector<Orbit> orbits;
  std::vector<bool> reached(ordinates.size(), false);
  for (int r = 0; r < ordinates.size(); ++r) {
    if (reached[r]) continue;
    Orbit orbit{r, {}};
    for (const SymmetryMap& map : maps) {
      const Direction image = map.map * ordinates.direction[r];
      for (int d = 0; d < ordinates.size(); ++d) {
        if (ordinates.direction[d].dot(image) < same_direction) continue;
        if (!reached[d]) orbit.members.push_back({d, {}});
        reached[d] = true;
        std::find_if(orbit.members.begin(), orbit.members.end(), [&](const Member& m) {
          return m.ordinate == d;
        })->maps.push_back(&map);
      }
    }
    orbits.push_back(std::move(orbit));
  }
  return orbits;
}

/// Column of a member: if several maps lead to it, their mean, which has the symmetry of the direction itself.
Eigen::VectorXd permuted(const Eigen::VectorXd& column, const Member& member) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(column.size());
  for (const SymmetryMap* map : member.maps) {
    for (Eigen::Index m = 0; m < column.size(); ++m) result[map->control_point_to[m]] += column[m];
  }
  return result / static_cast<double>(member.maps.size());
}

/// Adds a fitted column, which represents so many of the table, to a report.
void add(FitReport& report, const FittedColumn& column, std::size_t copies) {
  report.linear_programmes += column.linear_programmes;
  report.fallbacks += column.fell_back ? static_cast<int>(copies) : 0;
  report.max_error = std::max(report.max_error, column.max_error);
  report.least_value = std::min(report.least_value, column.value.minCoeff());
}

FitReport joined(const FitReport& a, const FitReport& b) {
  FitReport report = a;
  report.linear_programmes += b.linear_programmes;
  report.fallbacks += b.fallbacks;
  report.max_error = std::max(a.max_error, b.max_error);
  report.least_value = std::min(a.least_value, b.least_value);
  return report;
}

/// One column to fit: about a direction of arrival.
struct Job {
  const PhaseFunction* phase;
  Direction travel;
  int half_range_rows;
};

std::vector<FittedColumn> fit(const ColumnFit& column_fit, const std::vector<Job>& jobs) {
  const auto count = static_cast<int>(jobs.size());
  std::vector<FittedColumn> fitted(count);
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic)
  for (int j = 0; j < count; ++j) {
    errors.run([&] { fitted[j] = column_fit.fit(*jobs[j].phase, jobs[j].travel, jobs[j].half_range_rows); });
  }
  errors.rethrow();
  return fitted;
}

/// Text of every input that the columns share.
std::string common_key(const PhaseFunction& phase, const ControlPoints& points, const OrdinateSet& ordinates,
                       const FitOptions& options) {
  std::string key = fmt::format("phase {}; points {}; ordinates {}; method {}; exact moments {}; minimax {}; rotation",
                                phase.key(), points.size(), ordinates.name, static_cast<int>(options.method),
                                options.exact_moments, options.minimax);
  for (const double r : points.rotation().reshaped()) key += fmt::format(" {}", r);
  return key;
}

}  // namespace

ScatteringTable make_scattering_table(const PhaseFunction& phase, const ControlPoints& points,
                                      const OrdinateSet& ordinates, const std::optional<Direction>& beam,
                                      const FitOptions& options) {
  check(options);
  const auto start = std::chrono::steady_clock::now();
  // If the ordinates are control points, a half range is not resolved well enough to be prescribed. Without its rows
  // the beam is more accurate with the order of the diffuse light.
  const int beam_order = ordinates.is_control_points ? options.delta_m_order : options.beam_delta_m_order;
  const int half_range_rows = ordinates.is_control_points ? 0 : options.beam_half_range_rows;
  const DeltaM diffuse = delta_m(phase, options.delta_m_order);
  const DeltaM direct = delta_m(phase, beam_order);

  // The two are kept apart on disk: another sun needs only its own column.
  const std::string key = common_key(phase, points, ordinates, options);
  const TableCache diffuse_cache(options.cache_directory, fmt::format("{}; delta-m {}", key, options.delta_m_order));
  const Direction sun = beam.value_or(Direction::Zero());
  const TableCache beam_cache(options.cache_directory,
                              fmt::format("{}; delta-m {}; half-range rows {}; beam {} {} {}", key, beam_order,
                                          half_range_rows, sun.x(), sun.y(), sun.z()));
  std::optional<FittedColumns> diffuse_columns = diffuse_cache.load();
  std::optional<FittedColumns> beam_column = beam ? beam_cache.load() : std::nullopt;

  ScatteringTable table;
  table.forward_fraction = diffuse.forward_fraction;
  table.beam_forward_fraction = direct.forward_fraction;
  table.report.from_cache = diffuse_columns && (beam_column || !beam);
  if (!table.report.from_cache) {
    const std::vector<SymmetryMap> maps = common_symmetry(points, ordinates);
    const std::vector<Orbit> orbits = orbits_of(ordinates, maps);
    std::vector<Job> jobs;
    const bool fit_beam = beam && !beam_column, fit_diffuse = !diffuse_columns;
    if (fit_beam) jobs.push_back({&direct.truncated, *beam, half_range_rows});
    for (std::size_t o = 0; fit_diffuse && o < orbits.size(); ++o) {
      jobs.push_back({&diffuse.truncated, ordinates.direction[orbits[o].representative], 0});
    }
    const std::vector<FittedColumn> fitted = fit(ColumnFit(points, ordinates, options), jobs);

    if (fit_beam) {
      beam_column.emplace(fitted[0].value, FitReport{});
      add(beam_column->report, fitted[0], 1);
      beam_cache.store(*beam_column);
    }
    if (fit_diffuse) {
      diffuse_columns.emplace(Eigen::MatrixXd(points.size(), ordinates.size()), FitReport{});
      for (std::size_t o = 0; o < orbits.size(); ++o) {
        const FittedColumn& column = fitted[o + (fit_beam ? 1 : 0)];
        for (const Member& member : orbits[o].members) {
          diffuse_columns->value.col(member.ordinate) = permuted(column.value, member);
        }
        add(diffuse_columns->report, column, orbits[o].members.size());
      }
      diffuse_cache.store(*diffuse_columns);
    }
  }

  const Eigen::SparseMatrix<double> to_ordinates = interpolation(points, ordinates);
  const Eigen::Map<const Eigen::VectorXd> weight(ordinates.weight.data(), ordinates.size());
  table.report = joined(table.report, diffuse_columns->report);
  table.points_from_ordinates = diffuse_columns->value * (weight / four_pi).asDiagonal();
  // Columns are fitted one by one. Isotropic light would become light of a few percent more in some directions. Each
  // direction gets the rest as a share of the mean radiance. These shares sum to 0, because columns conserve light.
  const Eigen::VectorXd lacking = 1 - table.points_from_ordinates.rowwise().sum().array();
  table.points_from_ordinates += lacking * (weight / four_pi).transpose();
  table.ordinates_from_ordinates = to_ordinates * table.points_from_ordinates;
  table.report.closure =
      ((weight.transpose() * table.ordinates_from_ordinates).transpose().array() / weight.array() - 1).abs().maxCoeff();
  if (beam) {
    table.report = joined(table.report, beam_column->report);
    table.points_from_beam = beam_column->value.col(0) / four_pi;
    table.ordinates_from_beam = to_ordinates * table.points_from_beam;
    table.report.closure = std::max(table.report.closure, std::abs(weight.dot(table.ordinates_from_beam) - 1));
  }
  table.report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return table;
}

}  // namespace cloudbow
