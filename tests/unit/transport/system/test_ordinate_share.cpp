// A solve shared by ranks. Truth: the same solve by one rank, with the same bits.
#include <gtest/gtest.h>

#include <mutex>

#include "../../thread_ranks.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/system/ordinate_share.hpp"
#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

struct Case {
  const char* name;
  bool packed = false;
  bool open = false;
  bool linear = true;
};
constexpr Case cases[] = {
    {"as usual"}, {"float16", true}, {"open sides", false, true}, {"constant", false, false, false}};

/// Two clouds, some of whose cells are thick, over a ground that is not Lambertian.
Problem clouds(const Case& of) {
  BoxGrid box = make_box(22, 18, 6);
  box.periodic = !of.open;
  box.dx_m = box.dy_m = 60;
  for (double& z : box.z_edge_m) z *= 40;
  std::vector<float> extinction = random_extinction(box, .06, 5);
  for (std::size_t c = 0; c < extinction.size(); ++c) {
    if (c % 22 > 13) extinction[c] = 0;
  }
  Problem problem;
  problem.grid = make_grid(box, extinction, .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  problem.sun = Sun{travel_along(-.3, 30), 1.};
  problem.surface.albedo = .2;
  return problem;
}

SolverOptions options_of(const Case& of) {
  SolverOptions options = coarse_options();
  options.max_sweeps = 9;
  options.half_precision_radiance = of.packed;
  options.linear_source = of.linear;
  options.circumsolar_half_angle = .01;  // so that slopes of the radiance are kept
  return options;
}

template <class Real>
struct Solved {
  IterationResult<Real> result;
  std::uint64_t bytes_sent = 0;
  CellRange range{};
  std::array<bool, octants> has_octant{};
};

/// Whether values [cells of a rank] are those of its cells.
template <class Real>
bool are_of(const CellRange& range, const Real* here, const Real* truth) {
  return std::equal(here, here + range.size(), truth + range.first);
}

/// @param ranks null: one process alone
template <class Real>
Solved<Real> solved(const Case& of, Ranks* ranks) {
  const Problem problem = clouds(of);
  const SolverOptions options = options_of(of);
  const Discretisation discretisation = discretise(problem.phase, problem.sun->travel, options);
  const TransportSystem<Real> system = make_system<Real>(problem, discretisation, options);
  if (ranks == nullptr) return {iterate_source<Real>(system, options, {})};
  const OrdinateShare share(*ranks, system.ordinates, system.cells->size());
  Solved<Real> solved{iterate_source<Real>(system, options, {}, nullptr, &share)};
  solved.bytes_sent = ranks->bytes_sent();
  solved.range = share.range();
  for (int octant = 0; octant < octants; ++octant) solved.has_octant[octant] = share.has_octant(octant);
  share.to_first(solved.result.radiance);
  return solved;
}

template <class Real>
void expect_same(const Solved<Real>& solved, const IterationResult<Real>& truth, bool is_first) {
  const IterationResult<Real>& here = solved.result;
  const std::size_t n = truth.moments.size() / low_moments;
  ASSERT_EQ(here.moments.size(), low_moments * solved.range.size());
  for (std::size_t m = 0; m < low_moments; ++m)
    EXPECT_TRUE(are_of(solved.range, here.moments.data() + m * solved.range.size(), truth.moments.data() + m * n)) << m;
  EXPECT_EQ(here.fluxes.up_top, truth.fluxes.up_top);
  EXPECT_EQ(here.fluxes.profile_down, truth.fluxes.profile_down);
  EXPECT_EQ(here.fluxes.side_loss, truth.fluxes.side_loss);
  EXPECT_EQ(here.fluxes.surface_flux, truth.fluxes.surface_flux);
  EXPECT_EQ(here.ledger.residual, truth.ledger.residual);
  EXPECT_EQ(here.report.sweeps, truth.report.sweeps);
  EXPECT_EQ(here.slopes.has_value(), truth.slopes.has_value());
  if (here.slopes && truth.slopes) {
    for (std::size_t q = 0; q < octants; ++q) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(
            are_of(solved.range, here.slopes->of_radiance[q][axis].data(), truth.slopes->of_radiance[q][axis].data()));
        if (solved.has_octant[q]) {
          EXPECT_TRUE(are_of({0, n}, here.slopes->of_octant[q][axis].data(), truth.slopes->of_octant[q][axis].data()));
        } else {
          EXPECT_TRUE(here.slopes->of_octant[q][axis].empty());
        }
      }
    }
  }
  if (!is_first) {
    EXPECT_EQ(here.radiance.rows, 0);
    return;
  }
  ASSERT_EQ(here.radiance.rows, truth.radiance.rows);
  for (int d = 0; d < truth.radiance.rows; ++d) {
    // Beyond the cells there is room, whose content has no meaning.
    std::vector<Real> room(truth.radiance.cells), room_of_truth(truth.radiance.cells);
    const Real* const row = here.radiance.stored_row(d).read(0, truth.radiance.cells, room.data());
    const Real* const of_truth = truth.radiance.stored_row(d).read(0, truth.radiance.cells, room_of_truth.data());
    EXPECT_TRUE(std::equal(row, row + truth.radiance.cells, of_truth)) << d;
  }
}

template <class Real>
void check(const Case& of) {
  SCOPED_TRACE(of.name);
  const Solved<Real> truth = solved<Real>(of, nullptr);
  for (const int size : {1, 2, 3, 4, 8, 9}) {
    SCOPED_TRACE(size);
    std::mutex one_at_a_time;  // to compare
    ThreadRanks::run(size, [&](Ranks& ranks) {
      const Solved<Real> here = solved<Real>(of, &ranks);
      const std::lock_guard lock(one_at_a_time);
      expect_same(here, truth.result, ranks.is_first());
    });
  }
}

TEST(OrdinateShare, HasTheBitsOfOneRank) {
  for (const Case& of : cases) check<float>(of);
}

TEST(OrdinateShare, HasTheBitsOfOneRankInDouble) { check<double>(cases[0]); }

// Truth: docs/mpi.md, "Bytes", for sweeps without slopes. It leaves out sums over cells, by blocks, which are 1 %, and
// sums of fluxes, which small fields alone notice.
TEST(OrdinateShare, SendsTheBytesOfTheFormula) {
  constexpr double tolerance = .02;
  const Case& of = cases[3];
  const Problem problem = clouds(of);
  const double d = make_ordinate_set(options_of(of).directions).size();
  const double n = static_cast<double>(problem.grid.active_cells());
  const double c = static_cast<double>(problem.grid.box.columns());
  for (const int size : {2, 4}) {
    std::mutex one_at_a_time;
    double sent = 0;
    int sweeps = 0;
    ThreadRanks::run(size, [&](Ranks& ranks) {
      const Solved<float> here = solved<float>(of, &ranks);
      const std::lock_guard lock(one_at_a_time);
      sent += static_cast<double>(here.bytes_sent);
      sweeps = here.result.report.sweeps;
    });
    const double of_sweep = sizeof(float) * (2 * d * n / size + 10 * n) + sizeof(double) * 4 * c;
    const double of_rank = (1 - 1. / size) * (sweeps * of_sweep + sizeof(float) * 9 * n);
    const double more = sweeps * (size - 1) * d * 3 * sizeof(double);
    EXPECT_NEAR(sent, size * of_rank + more, tolerance * sent) << size;
  }
}

TEST(OrdinateShare, RowsAndCellsAreTheSameField) {
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-4x8");
  constexpr std::size_t cells = 1000;
  for (const int size : {1, 2, 3, 5, 12}) {
    ThreadRanks::run(size, [&](Ranks& ranks) {
      const OrdinateShare share(ranks, ordinates, cells);
      AngularField<float> field = share.own_cells<float>(std::nullopt);
      const auto value = [](int d, std::size_t c) { return static_cast<float>(1000 * d + static_cast<int>(c)); };
      for (int d = 0; d < field.rows; ++d) {
        for (std::size_t c = 0; c < field.cells; ++c) field.row(d)[c] = value(d, field.first_cell + c);
      }
      const std::size_t own = field.cells;
      share.to_rows(field);
      EXPECT_EQ(field.cells, cells);
      for (int d = 0; d < field.rows; ++d) {
        EXPECT_EQ(field.data[d].empty(), !share.has(d));
        for (std::size_t c = 0; share.has(d) && c < cells; ++c) ASSERT_EQ(field.row(d)[c], value(d, c));
      }
      share.to_cells(field);
      EXPECT_EQ(field.cells, own);
      share.to_first(field);
      for (int d = 0; ranks.is_first() && d < ordinates.size(); ++d) {
        for (std::size_t c = 0; c < cells; ++c) ASSERT_EQ(field.row(d)[c], value(d, c));
      }
    });
  }
}

}  // namespace
}  // namespace cloudbow
