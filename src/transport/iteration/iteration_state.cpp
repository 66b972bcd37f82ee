#include "transport/iteration/iteration_state.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <string>
#include <type_traits>

#include "cloudbow/core/digest.hpp"

namespace cloudbow {
namespace {

template <class T>
std::span<const T> values_of(const std::vector<T>& of) {
  return of;
}

template <class Matrix>
void add_matrix(Digest& digest, const Matrix& matrix) {
  using Scalar = typename Matrix::Scalar;
  digest.add(matrix.rows());
  digest.add(std::span<const Scalar>(matrix.data(), static_cast<std::size_t>(matrix.size())));
}

template <class Real>
void add_layout(Digest& digest, const TransportSystem<Real>& system, bool packed) {
  digest.add(sizeof(Real));
  digest.add(packed);
  digest.add(system.independent_columns);
  digest.add(system.slopes.has_value());
  const BoxGrid& box = system.box;
  for (const int number : {box.nx, box.ny, static_cast<int>(box.periodic)}) digest.add(number);
  for (const double length : {box.dx_m, box.dy_m}) digest.add(length);
  digest.add(values_of(box.z_edge_m));
  for (const Direction& d : system.ordinates.direction) add_matrix(digest, d);
  digest.add(values_of(system.ordinates.weight));
  digest.add(values_of(system.cells->rows.level_cell));
  for (const ActiveRow& row : system.cells->rows.rows) {
    digest.add(row.j);
    digest.add(row.first_span);
  }
  for (const RowSpan& span : system.cells->rows.spans) {
    digest.add(span.i);
    digest.add(span.n);
  }
  for (const AirBlocks& air : system.cells->rows.air) {
    for (const int number : {air.x, air.y, air.width_x, air.width_y}) digest.add(number);
  }
}

template <class Real>
void add_problem(Digest& digest, const TransportSystem<Real>& system) {
  const Cells<Real>& cells = *system.cells;
  digest.add(system.linear_source);
  digest.add(values_of(cells.extinction).first(cells.size()));
  for (const auto& scattered : cells.scattered) digest.add(values_of(scattered));
  for (const auto& scale : cells.scale) digest.add(values_of(scale));
  for (const auto& matrix : system.scattering.matrix()) add_matrix(digest, matrix);
  for (const BeamSource<Real>& beam : system.beam.source) {
    add_matrix(digest, beam.direction);
    digest.add(values_of(beam.intensity));
  }
  digest.add(values_of(system.emission));
  digest.add(values_of(system.absorption));
  digest.add(values_of(system.beam.irradiance));
  digest.add(values_of(system.beam.surface_flux));
  for (const auto& radiance : system.side_radiance) digest.add(values_of(radiance));
  for (const double power : {system.sky_radiance, system.power}) digest.add(power);
  system.ground.add_to(digest);
}

template <class T>
StateArray array_of(std::string name, std::vector<T>& of) {
  return {std::move(name), sizeof(T), of.size(), {of.data()}};
}

template <class Real>
StateArray radiance_of(AngularField<Real>& radiance) {
  StateArray array{"radiance", radiance.packed() ? sizeof(std::uint16_t) : sizeof(Real), radiance.cells, {}};
  for (int d = 0; d < radiance.rows; ++d) {
    array.rows.push_back(radiance.packed() ? static_cast<void*>(radiance.float16[d].data())
                                           : static_cast<void*>(radiance.data[d].data()));
  }
  return array;
}

// Everything that is no array, in one.
constexpr std::size_t number_count = 28;

template <class Real, class Use>
void for_each_number(IterationState<Real>& state, const Use& use) {
  IterationReport& report = state.result.report;
  EnergyLedger& ledger = state.result.ledger;
  SweepFluxes<Real>& fluxes = state.result.fluxes;
  use(state.nearly_done);
  use(state.done);
  use(state.finds_slopes);
  use(state.slope_sweeps);
  use(state.slopes_from);
  use(report.converged);
  use(report.sweeps);
  for (double* const number :
       {&report.estimated_error, &report.seconds_sweeps, &report.seconds_scattering, &report.seconds_acceleration,
        &ledger.power, &ledger.incident, &ledger.surface_emission, &ledger.reflectance, &ledger.transmittance,
        &ledger.transmittance_direct, &ledger.absorptance, &ledger.surface_absorptance, &ledger.side_gain,
        &ledger.side_loss, &ledger.residual, &fluxes.up_top, &fluxes.side_gain, &fluxes.side_loss,
        &fluxes.surface_absorbed})
    use(*number);
}

template <class Real>
void make_room(const TransportSystem<Real>& system, SweepFluxes<Real>& fluxes) {
  const std::size_t columns = system.box.columns();
  const std::size_t levels = system.box.z_edge_m.size();
  fluxes.surface_flux.resize(columns);
  fluxes.profile_up.resize(levels);
  fluxes.profile_down.resize(levels);
  if (system.has_independent_columns()) {
    fluxes.column_up.resize(columns * levels);
    fluxes.column_down.resize(columns * levels);
  }
  if (!system.ground.is_lambertian()) {
    fluxes.surface_arriving.resize(system.ordinates.size());
    for (int d = 0; d < system.ordinates.size(); ++d)
      fluxes.surface_arriving[d].resize(system.ordinates.direction[d].z() < 0 ? columns : 0);
  }
}

template <class Real>
void add_slopes(IterationResult<Real>& result, std::vector<StateArray>& arrays) {
  if (!result.slopes || !result.slopes->fitted) return;
  const auto add = [&](const char* name, std::array<Slope<Real>, octants>& of) {
    StateArray slopes{name, sizeof(Real), result.radiance.cells, {}};
    for (auto& octant : of) {
      for (auto& axis : octant) slopes.rows.push_back(axis.data());
    }
    arrays.push_back(std::move(slopes));
  };
  add("source_slopes", result.slopes->of_octant);
  add("radiance_slopes", result.slopes->of_radiance);
}

template <class Real>
std::vector<StateArray> arrays_of_result(IterationResult<Real>& result) {
  SweepFluxes<Real>& fluxes = result.fluxes;
  std::vector<StateArray> arrays{array_of("moments", result.moments), array_of("surface_flux", fluxes.surface_flux),
                                 array_of("profile_up", fluxes.profile_up),
                                 array_of("profile_down", fluxes.profile_down)};
  if (!fluxes.column_up.empty()) {
    arrays.push_back(array_of("column_up", fluxes.column_up));
    arrays.push_back(array_of("column_down", fluxes.column_down));
  }
  if (!fluxes.surface_arriving.empty()) {
    StateArray arriving{"surface_arriving", sizeof(Real), 0, {}};
    for (auto& row : fluxes.surface_arriving) {
      if (row.empty()) continue;
      arriving.length = row.size();
      arriving.rows.push_back(row.data());
    }
    arrays.push_back(std::move(arriving));
  }
  add_slopes(result, arrays);
  return arrays;
}

template <class Real>
std::vector<StateArray> arrays_between_sweeps(IterationState<Real>& state) {
  std::vector<StateArray> arrays{array_of("scattering_moments", state.x), array_of("moment_change", state.change),
                                 array_of("steps", state.steps)};
  AndersonHistory<Real>& history = state.mixer.history();
  arrays.push_back(array_of("last_residual", history.last_residual));
  arrays.push_back(array_of("last_iterate", history.last_g));
  for (std::size_t n = 0; n < history.residual_change.size(); ++n) {
    arrays.push_back(array_of("residual_change_" + std::to_string(n), history.residual_change[n]));
    arrays.push_back(array_of("iterate_change_" + std::to_string(n), history.g_change[n]));
  }
  add_slopes(state.result, arrays);
  return arrays;
}

void load_all(Checkpoints& checkpoints, const std::vector<StateArray>& arrays) {
  for (const StateArray& array : arrays) checkpoints.load(array);
}

bool within(const IterationOptions& options, const IterationReport& report) {
  return report.sweeps >= options.max_sweeps || (report.converged && report.estimated_error <= options.tolerance);
}

}  // namespace

template <class Real>
StateKey state_key(const TransportSystem<Real>& system, const IterationState<Real>& state) {
  Digest digest;
  add_layout(digest, system, state.result.radiance.packed());
  const std::uint64_t layout = digest.value();
  add_problem(digest, system);
  return {layout, digest.value()};
}

template <class Real>
void save_state(const TransportSystem<Real>& system, IterationState<Real>& state, Checkpoints& checkpoints) {
  std::vector<double> numbers;
  numbers.reserve(number_count);
  for_each_number(state, [&](auto& number) { numbers.push_back(static_cast<double>(number)); });
  numbers.push_back(static_cast<double>(state.mixer.history().residual_change.size()));
  numbers.push_back(static_cast<double>(state.result.radiance.unit));
  assert(numbers.size() == number_count);
  std::vector<StateArray> arrays{array_of("numbers", numbers), radiance_of(state.result.radiance)};
  for (StateArray& array : state.done ? arrays_of_result(state.result) : arrays_between_sweeps(state))
    arrays.push_back(std::move(array));
  checkpoints.save(state_key(system, state), arrays);
}

template <class Real>
bool restore_state(const TransportSystem<Real>& system, const IterationOptions& options, IterationState<Real>& state,
                   Checkpoints& checkpoints) {
  const Checkpoints::Found found = checkpoints.find(state_key(system, state));
  if (found == Checkpoints::Found::nothing) return false;
  const std::size_t n = system.cells->size();
  IterationResult<Real>& result = state.result;

  std::vector<double> numbers(number_count);
  checkpoints.load(array_of("numbers", numbers));
  constexpr double most_sweeps = 1e6;  // as scenes may request
  const double mixed = numbers[number_count - 2];
  for (const double number : numbers) {
    if (!std::isfinite(number)) checkpoints.refuse(fmt::format("numbers (found {}, allowed finite ones)", number));
  }
  if (numbers[3] < 0 || numbers[3] > most_sweeps || std::abs(numbers[4]) > most_sweeps || numbers[6] < 0 ||
      numbers[6] > most_sweeps || mixed < 0 || mixed > state.mixer.depth()) {
    checkpoints.refuse(fmt::format("{} sweeps, {} changes (allowed up to {} and {})", numbers[6], mixed, most_sweeps,
                                   state.mixer.depth()));
  }
  std::size_t next = 0;
  for_each_number(
      state, [&](auto& number) { number = static_cast<std::remove_reference_t<decltype(number)>>(numbers[next++]); });
  result.radiance.unit = static_cast<Real>(numbers.back());
  checkpoints.load(radiance_of(result.radiance));
  state.dark = false;

  if (found == Checkpoints::Found::same_layout || (state.done && !within(options, result.report))) {
    result.report = {};
    state.done = state.nearly_done = state.finds_slopes = false;
    state.slope_sweeps = 0;
    state.slopes_from = -1;
    system.moments(result.radiance, result.moments);
    state.x = result.moments;
    state.change.clear();
  } else if (state.done) {
    make_room(system, result.fluxes);
    if (result.slopes) result.slopes->fitted = state.slope_sweeps > 0;
    load_all(checkpoints, arrays_of_result(result));
  } else {
    state.x.resize(low_moments * n);
    state.change.resize(low_moments * n);
    state.steps.resize(static_cast<std::size_t>(result.report.sweeps));
    state.mixer.history().make_room(4 * n, static_cast<std::size_t>(mixed));
    if (result.slopes) result.slopes->fitted = state.slope_sweeps > 0;
    load_all(checkpoints, arrays_between_sweeps(state));
  }
  checkpoints.loaded(result.report.sweeps);
  return true;
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                                \
  template StateKey state_key<Real>(const TransportSystem<Real>&, const IterationState<Real>&);                   \
  template void save_state<Real>(const TransportSystem<Real>&, IterationState<Real>&, Checkpoints&);              \
  template bool restore_state<Real>(const TransportSystem<Real>&, const IterationOptions&, IterationState<Real>&, \
                                    Checkpoints&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
