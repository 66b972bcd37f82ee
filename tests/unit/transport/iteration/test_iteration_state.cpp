// An iteration that was stopped and goes on elsewhere: the truth is the same iteration without a stop.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "transport/iteration/iteration_state.hpp"
#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

// Keeps the last state saved, as a file would.
class Kept : public Checkpoints {
 public:
  struct Stopped {};

  int stop_after = 0;  // sweeps; 0: never
  int saves = 0;
  int went_on_after = -1;

  Found find(const StateKey& key) override {
    if (arrays_.empty()) return Found::nothing;
    if (key.layout != key_.layout) throw std::invalid_argument("another layout");
    return key == key_ ? Found::same_problem : Found::same_layout;
  }
  void load(const StateArray& array) override {
    const std::vector<std::vector<char>>& rows = arrays_.at(array.name);
    ASSERT_EQ(rows.size(), array.rows.size()) << array.name;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      ASSERT_EQ(rows[r].size(), array.length * array.value_bytes) << array.name;
      std::memcpy(array.rows[r], rows[r].data(), rows[r].size());
    }
  }
  void refuse(const std::string& problem) override { throw std::invalid_argument(problem); }
  void loaded(int sweeps) override {
    went_on_after = sweeps;
    asked_ = sweeps;
  }
  bool due() override { return ++asked_ == stop_after; }
  void save(const StateKey& key, std::span<const StateArray> state) override {
    key_ = key;
    arrays_.clear();
    for (const StateArray& array : state) {
      for (const void* row : array.rows) {
        const char* const bytes = static_cast<const char*>(row);
        arrays_[array.name].emplace_back(bytes, bytes + array.length * array.value_bytes);
      }
      arrays_.try_emplace(array.name);
    }
    ++saves;
    if (asked_ == stop_after) throw Stopped{};
  }

 private:
  StateKey key_;
  int asked_ = 0;
  std::map<std::string, std::vector<std::vector<char>>> arrays_;
};

struct Case {
  Problem problem;
  SolverOptions options;
  IterationOptions iteration;

  explicit Case(const BoxGrid& box) {
    problem.grid = make_grid(box, random_extinction(box, 3, 3), .999);
    problem.phase = {PhaseFunction::henyey_greenstein(.8)};
    problem.sun = Sun{travel_along(-.6, 37), 1.};
    problem.surface.albedo = .3;
    options = coarse_options();
  }

  template <class Real>
  TransportSystem<Real> system() const {
    return make_system<Real>(problem, discretise(problem.phase, problem.sun->travel, options), options);
  }
};

template <class Real>
void expect_same_bits(const IterationResult<Real>& a, const IterationResult<Real>& b) {
  EXPECT_EQ(a.radiance.data, b.radiance.data);
  EXPECT_EQ(a.radiance.float16, b.radiance.float16);
  EXPECT_EQ(a.moments, b.moments);
  EXPECT_EQ(a.fluxes.surface_flux, b.fluxes.surface_flux);
  EXPECT_EQ(a.fluxes.surface_arriving, b.fluxes.surface_arriving);
  EXPECT_EQ(a.fluxes.profile_up, b.fluxes.profile_up);
  EXPECT_EQ(a.fluxes.profile_down, b.fluxes.profile_down);
  EXPECT_EQ(a.fluxes.column_up, b.fluxes.column_up);
  EXPECT_EQ(a.fluxes.column_down, b.fluxes.column_down);
  EXPECT_EQ(a.fluxes.up_top, b.fluxes.up_top);
  EXPECT_EQ(a.fluxes.side_loss, b.fluxes.side_loss);
  EXPECT_EQ(a.ledger.residual, b.ledger.residual);
  EXPECT_EQ(a.ledger.absorptance, b.ledger.absorptance);
  EXPECT_EQ(a.report.sweeps, b.report.sweeps);
  EXPECT_EQ(a.report.estimated_error, b.report.estimated_error);
  EXPECT_EQ(a.report.converged, b.report.converged);
}

// Stops after every possible sweep, continues from there, and restores the final state that this wrote.
template <class Real>
void expect_to_go_on(const Case& of) {
  const TransportSystem<Real> system = of.system<Real>();
  const IterationResult<Real> truth = iterate_source(system, of.iteration, {});
  ASSERT_TRUE(truth.report.converged);
  ASSERT_GT(truth.report.sweeps, 3);
  for (int stop = 1; stop < truth.report.sweeps; ++stop) {
    Kept kept;
    kept.stop_after = stop;
    EXPECT_THROW(iterate_source(system, of.iteration, {}, &kept), Kept::Stopped) << stop;
    kept.stop_after = 0;
    expect_same_bits(iterate_source(system, of.iteration, {}, &kept), truth);
    EXPECT_EQ(kept.went_on_after, stop);
    expect_same_bits(iterate_source(system, of.iteration, {}, &kept), truth);
    EXPECT_EQ(kept.went_on_after, truth.report.sweeps);
    EXPECT_EQ(kept.saves, 2);
  }
}

TEST(IterationState, GoesOnToTheSameBits) {
  expect_to_go_on<float>(Case(make_box(5, 4, 6)));
  expect_to_go_on<double>(Case(make_box(5, 4, 6)));
  expect_to_go_on<float>(Case(make_box(5, 4, 6, false)));
}

TEST(IterationState, GoesOnInHalfPrecision) {
  Case of(make_box(5, 4, 6));
  of.iteration.half_precision_radiance = true;
  of.iteration.tolerance = of.iteration.energy_tolerance = 1e-3;  // so few cells do not level the rounding out
  expect_to_go_on<float>(of);
}

TEST(IterationState, GoesOnOverASurfaceThatReflectsUnevenly) {
  Case of(make_box(4, 3, 3));
  of.problem.surface.brdf = SurfaceBrdf::rpv(.1, .7, -.24, .1);
  expect_to_go_on<float>(of);
}

TEST(IterationState, GoesOnInOneColumn) { expect_to_go_on<double>(Case(make_box(1, 1, 12))); }

TEST(IterationState, AnotherSunBeginsWithTheLightThereIs) {
  // The answer is that of a start from nothing, but for the slopes of light. These are found near the end of the
  // iteration and depend on the way there.
  Case of(make_box(5, 4, 6));
  Kept kept;
  iterate_source(of.system<double>(), of.iteration, {}, &kept);
  of.problem.sun->travel = travel_along(-.601, 37);
  const TransportSystem<double> system = of.system<double>();
  const IterationResult<double> fresh = iterate_source(system, of.iteration, {});
  const IterationResult<double> warm = iterate_source(system, of.iteration, {}, &kept);
  EXPECT_EQ(kept.went_on_after, 0);
  EXPECT_TRUE(warm.report.converged);
  EXPECT_LT(warm.report.sweeps, fresh.report.sweeps);
  EXPECT_NEAR(warm.ledger.reflectance, fresh.ledger.reflectance, 5e-4);
  EXPECT_NEAR(warm.ledger.transmittance, fresh.ledger.transmittance, 5e-4);
}

TEST(IterationState, ATighterToleranceBeginsWithTheLightThereIs) {
  Case of(make_box(5, 4, 6));
  const TransportSystem<double> system = of.system<double>();
  Kept kept;
  iterate_source(system, of.iteration, {}, &kept);
  of.iteration.tolerance = 1e-7;
  of.iteration.energy_tolerance = 1e-8;
  const IterationResult<double> fresh = iterate_source(system, of.iteration, {});
  const IterationResult<double> warm = iterate_source(system, of.iteration, {}, &kept);
  EXPECT_TRUE(warm.report.converged);
  EXPECT_LT(warm.report.sweeps, fresh.report.sweeps);
  EXPECT_NEAR(warm.ledger.reflectance, fresh.ledger.reflectance, 5e-4) << "by slopes, as above";
}

TEST(IterationState, SlopesThatWereNotFoundAreNoneAfterItsEndToo) {
  // Two sweeps end before slopes are found: sweeps and observers take differences, also when the state is read again.
  Case of(make_box(5, 4, 6));
  of.iteration.max_sweeps = 2;
  const TransportSystem<double> system = of.system<double>();
  ASSERT_TRUE(system.slopes);
  Kept kept;
  EXPECT_FALSE(iterate_source(system, of.iteration, {}, &kept).slopes);
  EXPECT_FALSE(iterate_source(system, of.iteration, {}, &kept).slopes);
  of.iteration.max_sweeps = 200;
  const IterationResult<double> found = iterate_source(system, of.iteration, {}, &kept);
  ASSERT_TRUE(found.slopes);
  EXPECT_EQ(iterate_source(system, of.iteration, {}, &kept).slopes->of_radiance, found.slopes->of_radiance);
}

TEST(IterationState, AKeyTellsWhatMatters) {
  const Case of(make_box(3, 3, 3));
  const auto key = [](const Case& some) {
    const IterationState<double> state(AndersonMixer<double>(3));
    return state_key(some.system<double>(), state);
  };
  const StateKey first = key(of);
  EXPECT_EQ(first, key(of));
  const auto changed = [&](const auto& change, bool same_layout) {
    Case other = of;
    change(other);
    const StateKey its = key(other);
    EXPECT_EQ(its.layout == first.layout, same_layout);
    EXPECT_NE(its.problem, first.problem);
  };
  changed([](Case& c) { c.problem.sun->travel = travel_along(-.6, 38); }, true);
  changed([](Case& c) { c.problem.surface.albedo = .31; }, true);
  changed([](Case& c) { c.problem.surface.brdf = SurfaceBrdf::rpv(.1, .7, -.24, .1); }, true);
  changed([](Case& c) { c.problem.sky_radiance = 1e-3; }, true);
  changed([](Case& c) { c.problem.phase = {PhaseFunction::henyey_greenstein(.79)}; }, true);
  changed([](Case& c) { c.problem.grid.scattering[0][4] *= 1.0001F; }, true);
  changed([](Case& c) { c.options.linear_source = false; }, false);  // no slopes are kept
  changed([](Case& c) { c.options.directions = "double-gauss-6x12"; }, false);
  changed([](Case& c) { c.problem.grid.box.dx_m = 1.1; }, false);
  changed([](Case& c) { c.problem.grid.box.periodic = false; }, false);
}

TEST(IterationState, NumbersThatMakeNoSenseAreRefused) {
  class Spoilt : public Kept {
   public:
    void load(const StateArray& array) override {
      Kept::load(array);
      if (array.name == "numbers") static_cast<double*>(array.rows[0])[place] = value;
    }
    std::size_t place = 0;
    double value = 0;
  };
  const Case of(make_box(3, 3, 3));
  const TransportSystem<double> system = of.system<double>();
  Spoilt kept;
  kept.stop_after = 2;
  EXPECT_THROW(iterate_source(system, of.iteration, {}, &kept), Kept::Stopped);
  kept.stop_after = 0;
  for (const auto& [place, value] : std::vector<std::pair<std::size_t, double>>{
           {3, -1.}, {4, 1e9}, {6, -1.}, {6, 1e9}, {7, std::nan("")}, {26, 1e6}, {26, -1.}}) {
    kept.place = place;
    kept.value = value;
    EXPECT_THROW(iterate_source(system, of.iteration, {}, &kept), std::invalid_argument) << place << ' ' << value;
  }
}

}  // namespace
}  // namespace cloudbow
