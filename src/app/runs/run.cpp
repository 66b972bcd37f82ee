#include "app/runs/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>
#include <string>

#include "app/planning/broadband.hpp"
#include "app/planning/clear_sky.hpp"
#include "app/planning/run_checkpoints.hpp"
#include "app/planning/run_options.hpp"
#include "app/planning/solve_scenes.hpp"
#include "app/planning/solve_share.hpp"
#include "app/planning/target_run.hpp"
#include "app/process/cache_directory.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/history.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/process/version.hpp"
#include "app/runs/merge.hpp"
#include "app/runs/rank_figures.hpp"
#include "app/runs/run_part.hpp"
#include "cloudbow/app/assemble.hpp"
#include "cloudbow/app/scene.hpp"
#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/core/ranks.hpp"
#include "cloudbow/core/thread_scope.hpp"
#include "cloudbow/io/result_file.hpp"
#include "cloudbow/medium/cloud_files.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/results/energy_fluxes.hpp"
#include "cloudbow/results/summary.hpp"

namespace cloudbow {
namespace {

std::string classes_text(const PhaseClassReport& classes) {
  return fmt::format("{} of {} functions, which changes fluxes by about {:.1e} of the incident", classes.classes,
                     classes.functions, classes.estimated_error);
}

void check_comparable(const Scene& scene) {
  if (scene.solver.mode == SolveMode::independent_columns) {
    throw InputError(
        fmt::format("{}: --compare sets a solution beside independent columns (found independent-columns "
                    "itself, allowed auto, 3d)",
                    scene.where("solver.mode")));
  }
}

/// Sums over g-points are solved in one way.
void check_broadband_options(const RunOptions& options, const Scene& scene) {
  const auto refuse = [&scene](const char* option, const char* way_out) {
    throw InputError(fmt::format("{}: excludes {} (found both, allowed one of the two) {}",
                                 scene.where("spectrum.gas_model"), option, way_out));
  };
  if (options.compare)
    refuse("--compare", "a second run with --set spectrum.method=columns solves independent columns");
  if (options.target) refuse("--target-error and --budget", "choose the level by solver.accuracy");
  if (!options.checkpoint.empty()) refuse("--checkpoint", "g-points are short runs, which keep no state");
  if (!options.resume.empty()) refuse("--resume", "g-points are short runs, which keep no state");
}

void check_memory(const Scene& scene, const CostEstimate& cost, std::uint64_t available) {
  if (cost.memory <= available) return;
  constexpr double megabyte = 1e6;
  // Rounded away from each other, so that close numbers are seen to differ.
  const double needed = std::ceil(static_cast<double>(cost.memory) / megabyte);
  const double allowed = std::floor(static_cast<double>(available) / megabyte);
  throw InputError(
      fmt::format("{}: needs more memory than is available (found {:.0f} MB needed, allowed {:.0f} MB); a smaller "
                  "domain, fewer solver.control_points or a lower solver.accuracy need less",
                  scene.path.string(), needed, allowed));
}

std::string figures_text(const ColumnFigures& figures, double columns, const char* unit) {
  return fmt::format("mean of all columns {:.4g}{}, largest of a column {:.4g}{}", figures.sum / columns, unit,
                     figures.largest, unit);
}

std::string thermal_text(const Scene& scene, const AssembledScene& assembled) {
  const SceneThermal& thermal = *scene.thermal;
  const BoxGrid& box = assembled.problem.grid.box;
  const Atmosphere& air = scene.atmosphere->air;
  std::string text = thermal.wavelength_um
                         ? fmt::format("{} um", *thermal.wavelength_um)
                         : fmt::format("{:.6g} to {:.6g} um", (*thermal.band_um)[0], (*thermal.band_um)[1]);
  text += scene.surface_temperature_k ? fmt::format("; ground {:.5g} K", *scene.surface_temperature_k)
                                      : fmt::format("; ground {}", scene.temperature_map.filename().string());
  text += fmt::format("; air {:.5g} K at the bottom, {:.5g} K at the top", air.temperature_at(box.z_edge_m.front()),
                      air.temperature_at(box.z_edge_m.back()));
  for (const CloudFigures& cloud : assembled.clouds) {
    if (!cloud.temperature_k) continue;
    const auto [lowest, highest] = *cloud.temperature_k;
    text += fmt::format("; {} {:.5g} to {:.5g} K", cloud.name.empty() ? "cloud" : cloud.name, lowest, highest);
  }
  return text;
}

std::string cloud_text(const CloudFigures& cloud, bool has_g_points, double columns) {
  const std::string of = cloud.name.empty() ? "" : cloud.name + ": ";
  const std::string at = cloud.optical_depth_um ? fmt::format(" at {} um", *cloud.optical_depth_um)
                         : has_g_points         ? " at the first g-point"
                                                : "";
  std::string text =
      fmt::format("cloud     {}optical depth{}: {}\n", of, at, figures_text(cloud.optical_depth, columns, ""));
  if (cloud.water_path_g_m2) {
    text += fmt::format("water     {}path: {}; content up to {:.4g} g/m3\n", of,
                        figures_text(*cloud.water_path_g_m2, columns, " g/m2"), cloud.largest_water_content_g_m3);
  }
  if (cloud.effective_radius_um) {
    const auto [least, largest] = *cloud.effective_radius_um;
    text +=
        fmt::format("radius    {}{}{:.4g} um\n", of, least < largest ? fmt::format("{:.4g} to ", least) : "", largest);
  }
  return text;
}

/// @returns 0 to 360, clockwise from north. @param azimuth_deg counter-clockwise from east.
double bearing_of(double azimuth_deg) {
  const double bearing = std::fmod(90 - azimuth_deg, 360);
  return bearing < 0 ? bearing + 360 : bearing;
}

/// By these a wrong unit is seen.
std::string figures_of(const Scene& scene, const AssembledScene& assembled) {
  std::string text;
  const auto out = std::back_inserter(text);
  const BoxGrid& box = assembled.problem.grid.box;
  const double x_max = box.x_min_m + box.nx * box.dx_m, y_max = box.y_min_m + box.ny * box.dy_m;
  if (!assembled.clouds.empty()) {
    fmt::format_to(out, "domain    {:.10g} to {:.10g} m, {:.10g} to {:.10g} m, {:.10g} to {:.10g} m along x, y, z\n",
                   box.x_min_m, x_max, box.y_min_m, y_max, box.z_edge_m.front(), box.z_edge_m.back());
    for (const CloudFigures& cloud : assembled.clouds)
      text += cloud_text(cloud, scene.broadband.has_value(), static_cast<double>(box.columns()));
  } else {
    fmt::format_to(out, "domain    {:.10g} to {:.10g} m along z\n", box.z_edge_m.front(), box.z_edge_m.back());
  }
  if (scene.thermal) fmt::format_to(out, "thermal   {}\n", thermal_text(scene, assembled));
  double layers = 0;
  for (const Layer& layer : scene.layers) layers += layer.optical_depth;
  if (!scene.layers.empty()) fmt::format_to(out, "layers    optical depth: {:.4g}\n", layers);
  return text;
}

std::string plan_text(const std::vector<Scene>& scenes, const PlannedScene& planned, const CostEstimate& cost,
                      std::uint64_t available) {
  std::string text;
  const auto out = std::back_inserter(text);
  const AssembledScene& first = *planned.scene;
  const OpticalGrid& grid = first.problem.grid;
  fmt::format_to(out, "grid      {} x {} columns, {} levels, {} cells with matter\n", grid.box.nx, grid.box.ny,
                 grid.box.nz(), grid.active_cells());
  text += figures_of(scenes.front(), first);
  if (planned.plan.by_polar_streams()) {
    fmt::format_to(out, "solver    independent columns, {} polar directions per hemisphere\n",
                   first.options.column_streams);
  } else {
    fmt::format_to(out, "solver    {} control points, {}, tolerance {}\n", first.options.control_points,
                   first.options.directions, first.options.tolerance);
  }
  if (scenes.front().broadband) {
    const SceneBroadband& broadband = *scenes.front().broadband;
    fmt::format_to(out, "spectrum  {} g-points of {}\n", broadband.model->points(), broadband.file);
  }
  if (scenes.front().wavelength_um) {
    std::string list;
    for (const Scene& scene : scenes) list += fmt::format("{}{}", list.empty() ? "" : ", ", *scene.wavelength_um);
    fmt::format_to(out, "spectrum  {} um\n", list);
  }
  if (first.phase_classes) fmt::format_to(out, "phase     {}\n", classes_text(*first.phase_classes));
  fmt::format_to(out, "memory    {} predicted, {:.1f} GB available\n", memory_text(cost.memory),
                 static_cast<double>(available) / 1e9);
  fmt::format_to(out, "time      {} predicted\n", time_text(cost.seconds));
  return text;
}

/// Each once: the scenes of a spectrum share their files.
void tell_notes(const std::vector<Scene>& scenes, std::set<std::string>& printed) {
  for (const Scene& scene : scenes) {
    for (const std::string& note : scene.notes) {
      if (printed.insert(note).second) tell("cloudbow: {}\n", printable(note));
    }
  }
}

std::filesystem::path output_file(const RunOptions& options, const Scene& scene) {
  if (!options.output.empty()) return options.output;
  if (!scene.output.file.empty()) return scene.output.file;
  return scene.path.stem().string() + ".h5";
}

/// Effect of the clouds on the fluxes, and heating in K per day.
void print_effects(const Solution& solution, const ResultInfo& info, std::size_t n, const std::string& flux_units) {
  if (!info.clear_sky.empty()) {
    const EnergyFluxes here = energy_fluxes(solution.ledger), clear = energy_fluxes(info.clear_sky[n].ledger);
    fmt::print("{:<21}{:+.4g} at the top, {:+.4g} at the ground {}\n", "cloud effect",
               clear.upwelling_top - here.upwelling_top,
               (here.surface_absorbed - here.surface_emitted) - (clear.surface_absorbed - clear.surface_emitted),
               flux_units);
  }
  if (!info.heating_rates.empty() && flux_units == "W m-2") {
    constexpr double day = 86400;
    const auto [least, most] =
        std::minmax_element(info.heating_rates[n].profile.begin(), info.heating_rates[n].profile.end());
    fmt::print("{:<21}{:.4g} to {:.4g} K/day, means of levels\n", "heating", *least * day, *most * day);
  }
}

void print_summaries(const std::vector<Scene>& scenes, const Solved& solved, const ResultInfo& info) {
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    if (scenes[n].wavelength_um)
      fmt::print("{}{:<21}{} um\n", n == 0 ? "" : "\n", "wavelength", *scenes[n].wavelength_um);
    if (!solved.phase_classes.empty())
      fmt::print("{:<21}{}\n", "phase functions", classes_text(solved.phase_classes[n]));
    const std::string flux_units = scenes[n].thermal ? scenes[n].thermal->flux_units() : "W m-2";
    fmt::print("{}", summary_table(solved.solutions[n], flux_units));
    print_effects(solved.solutions[n], info, n, flux_units);
    if (!solved.errors.empty()) fmt::print("{}", error_line(solved.errors[n]));
    if (!solved.independent_columns.empty()) {
      const EnergyLedger &ledger = solved.solutions[n].ledger, &columns = solved.independent_columns[n].ledger;
      if (scenes[n].thermal) {
        const EnergyFluxes here = energy_fluxes(ledger), there = energy_fluxes(columns);
        fmt::print("{:<21}up at the top {:+.4g}, down at the ground {:+.4g} {}\n", "minus columns",
                   here.upwelling_top - there.upwelling_top, here.downwelling_bottom - there.downwelling_bottom,
                   flux_units);
        continue;
      }
      fmt::print("{:<21}reflectance {:+.6f}, transmittance {:+.6f}\n", "minus columns",
                 ledger.reflectance - columns.reflectance, ledger.transmittance - columns.transmittance);
    }
  }
}

/// Names of the grids from which clouds have their own temperature, each once.
std::string temperature_grids(const Scene& scene) {
  std::set<std::string> names;
  for (const SceneCloud& cloud : scene.clouds) {
    if (!cloud.temperature_grid.empty()) names.insert(cloud.temperature_grid);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Emission and heating rates, for the result. Absorbed power that only these needed is given up.
void add_thermal(const std::vector<Scene>& scenes, Solved& solved, ResultInfo& info) {
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    const Scene& scene = scenes[n];
    if (scene.output.heating_rate) {
      Solution& solution = solved.solutions[n];
      info.heating_rates.push_back(heating_rate(solution, scene.atmosphere->air));
      if (!scene.output.absorption) solution.absorbed_power = {};
    }
    if (!scene.thermal) continue;
    info.thermal.push_back({scene.thermal->black_body, scene.thermal->wavelength_um, scene.thermal->band_um,
                            scene.atmosphere->source, scene.surface_temperature_k, scene.temperature_map.filename(),
                            temperature_grids(scene), scene.sky_temperature_k});
  }
  for (const SceneRadiance& radiance : scenes.front().radiances) {
    if (radiance.brightness_temperature) info.brightness_temperatures.push_back(radiance.name);
  }
  const std::vector<std::string>& cameras = scenes.front().thermal_cameras;
  info.brightness_temperatures.insert(info.brightness_temperatures.end(), cameras.begin(), cameras.end());
}

/// Constituents that have names, for the result. @param columns of the domain
std::vector<ConstituentInfo> constituents_of(const Scene& scene, const Solved& solved, double columns) {
  std::vector<ConstituentInfo> constituents;
  for (std::size_t n = 0; n < scene.clouds.size(); ++n) {
    if (scene.clouds[n].name.empty()) continue;
    ConstituentInfo info{scene.clouds[n].name};
    for (const std::vector<CloudFigures>& of_solve : solved.clouds) {
      const CloudFigures& cloud = of_solve[n];
      if (!scene.broadband) info.optical_depth.push_back(cloud.optical_depth.sum / columns);
      if (cloud.water_path_g_m2) info.water_path_g_m2.push_back(cloud.water_path_g_m2->sum / columns);
    }
    constituents.push_back(std::move(info));
  }
  return constituents;
}

/// The wavelength of the clouds' optical depth, if g-points have different ones and the result holds that of visible
/// light.
std::optional<double> visible_depth_um(const Scene& scene) {
  const bool visible = std::any_of(scene.clouds.begin(), scene.clouds.end(), [](const SceneCloud& cloud) {
    return cloud.relative_extinction || !cloud.visible_m2_per_g.empty();
  });
  return visible ? std::optional(SceneCloud::visible_um) : std::nullopt;
}

/// Sentences about solutions that are not converged.
void add_unconverged(const std::vector<Scene>& scenes, const std::vector<Solution>& solutions, const std::string& which,
                     const std::string& output, std::vector<std::string>& sentences) {
  for (std::size_t n = 0; n < solutions.size(); ++n) {
    const Solution& solution = solutions[n];
    if (solution.report.converged) continue;
    const std::string at = which + (scenes[n].wavelength_um ? fmt::format(" at {} um", *scenes[n].wavelength_um) : "");
    sentences.push_back(fmt::format(
        "not converged{}: {}estimated error {:.2e} after {} sweeps, energy residual {:.2e}; {} is marked so", at,
        solution.report.stalled ? fmt::format("stalled in {}, ", solution.report.radiance_storage) : "",
        solution.report.estimated_error, solution.report.sweeps, solution.ledger.residual, output));
  }
}

/// Tables of the cache are written without a request.
void check_not_of_cache(const std::vector<std::filesystem::path>& files) {
  const std::filesystem::path cache = cache_directory();
  for (const std::filesystem::path& file : files) {
    if (file.empty() || !is_cached_table(file)) continue;
    if (same_file(written_file(file).parent_path(), cache)) {
      throw InputError(
          fmt::format("{}: would be overwritten (found the name of a table in the cache's folder, allowed any other)",
                      file.string()));
    }
  }
}

/// No output of a run may overwrite its inputs or another output.
void check_files(const RunOptions& options, std::size_t solves, const std::filesystem::path& output,
                 const Scene& scene) {
  std::vector<OutputFile> outputs{{output, "the result", OutputKind::hdf5}};
  std::vector<std::filesystem::path> files = scene.inputs;
  for (std::size_t of = 0; of < solves; ++of) {
    const std::filesystem::path kept = checkpoint_file(options.checkpoint, of, solves);
    const std::filesystem::path resumed = checkpoint_file(options.resume, of, solves);
    outputs.push_back({kept, "the checkpoint", OutputKind::checkpoint});
    // A solve may keep its state in the file from which it continues, but in that of no other solve.
    if (!same_file(kept, resumed)) files.push_back(resumed);
  }
  std::vector<std::filesystem::path> all = files;
  if (options.part) outputs.push_back({part_file(output, *options.part), "the part", OutputKind::any});
  for (const OutputFile& file : outputs) all.push_back(file.path);
  check_not_of_cache(all);
  check_distinct(outputs, files);
  if (options.ranks != nullptr && !options.ranks->is_first()) return;
  for (const OutputFile& file : outputs) {
    if (file.path.empty()) continue;
    if (options.dry_run) {
      check_target(file.path);
    } else {
      check_writable(file.path);
    }
  }
}

/// A run is shared out by its solves.
void check_shared(const RunOptions& options, const std::vector<Scene>& scenes) {
  const Scene& scene = scenes.front();
  const char* const by = options.part ? "--part" : "mpirun";
  if (!options.part && options.ranks == nullptr) return;
  if (options.part && options.ranks != nullptr) {
    throw InputError(
        "--part: excludes mpirun (found both, allowed one of the two) mpirun shares the solves out itself");
  }
  if (options.target) {
    throw InputError(
        fmt::format("{}: excludes --target-error and --budget (found both, allowed one of the two) choose "
                    "the level by solver.accuracy",
                    by));
  }
  if (options.ranks != nullptr && scenes.size() == 1 && !(options.checkpoint.empty() && options.resume.empty())) {
    throw InputError(
        "mpirun: excludes --checkpoint and --resume if the run is one solve (found both, allowed one of the "
        "two)");
  }
  if (options.part && scenes.size() == 1) {
    throw InputError(
        fmt::format("{}: --part: nothing to share out (found one solve, allowed several wavelengths or "
                    "g-points) run it without --part",
                    scene.path.string()));
  }
}

CloudFiles cloud_files(const std::vector<Scene>& scenes, const RunOptions& options) {
  return CloudFiles(scenes.size() > 1, [quiet = options.quiet](const std::string& sentence) {
    if (!quiet) tell("cloudbow: {}\n", printable(sentence));
  });
}

ResultInfo result_info(const std::vector<Scene>& scenes, Solved& solved, const RunOptions& options) {
  ResultInfo info{scenes.front().title, fmt::format("cloudbow {}", version()), history_line(options.command),
                  scenes.front().text};
  info.error_estimates = solved.errors;
  for (const PhaseClassReport& classes : solved.phase_classes) {
    info.phase_classes.push_back(classes.classes);
    info.phase_class_error.push_back(classes.estimated_error);
  }
  info.cloud_optical_depth = std::move(solved.cloud_optical_depth);
  info.cloud_extinction = std::move(solved.cloud_extinction);
  info.cloud_optical_depth_um = visible_depth_um(scenes.front());
  if (const double angle = scenes.front().output.circumsolar_half_angle; angle > 0)
    info.circumsolar_deg = angle * 180 / std::numbers::pi;
  info.constituents =
      constituents_of(scenes.front(), solved, static_cast<double>(solved.solutions.front().box.columns()));
  add_thermal(scenes, solved, info);
  if (const std::optional<SceneSun>& sun = scenes.front().sun)
    info.sun = {sun->zenith_deg, bearing_of(sun->azimuth_deg)};
  for (const Scene& scene : scenes) {
    if (scene.wavelength_um) info.wavelengths_um.push_back(*scene.wavelength_um);
  }
  return info;
}

std::map<std::string, std::vector<double>> coordinates_of(const std::vector<Scene>& scenes,
                                                          const PlannedScene& planned) {
  const AssembledScene& scene = *planned.scene;
  const BoxGrid& box = scene.problem.grid.box;
  std::map<std::string, std::vector<double>> coordinates{{"x", {static_cast<double>(box.nx), box.x_min_m, box.dx_m}},
                                                         {"y", {static_cast<double>(box.ny), box.y_min_m, box.dy_m}},
                                                         {"z_edge", box.z_edge_m}};
  std::vector<double>& fluxes = coordinates["z_flux"];
  for (const int level : flux_levels(box, scene.options)) fluxes.push_back(level);
  for (const Scene& one : scenes) {
    if (one.wavelength_um) coordinates["wavelength"].push_back(*one.wavelength_um);
  }
  for (const View& view : scene.options.views)
    coordinates["x_" + view.name] = {static_cast<double>(view.width), static_cast<double>(view.height)};
  for (const Camera& camera : scene.options.cameras)
    coordinates["row_" + camera.name] = {static_cast<double>(camera.width), static_cast<double>(camera.height)};
  if (scene.options.radiance_field) {
    coordinates["control_point"] = {static_cast<double>(scene.options.control_points)};
    coordinates["active_voxel"] = {static_cast<double>(scene.problem.grid.active_cells())};
  }
  return coordinates;
}

// Ranks that share the one solve of a run.
int ranks_together(const std::vector<Scene>& scenes, const RunOptions& options) {
  return options.ranks != nullptr && scenes.size() == 1 ? options.ranks->size() : 1;
}

}  // namespace

std::uint64_t available_memory(const RunOptions& options) {
  const int processes = options.ranks != nullptr ? options.ranks->on_this_machine() : 1;
  return available_memory_bytes() / static_cast<std::uint64_t>(processes);
}

PreparedRun prepare_run(const RunOptions& options) {
  std::set<std::string> printed;
  return prepare_run(options, printed);
}

PreparedRun prepare_run(const RunOptions& options, std::set<std::string>& printed) {
  PreparedRun prepared{read_scenes(options.scene, options.overrides), {}};
  const Scene& first = prepared.scenes.front();
  tell_notes(prepared.scenes, printed);
  prepared.output = output_file(options, first);
  check_files(options, prepared.scenes.size(), prepared.output, first);
  if (options.compare) check_comparable(first);
  if (first.broadband) check_broadband_options(options, first);
  if (options.clear_sky) check_clear_sky(first);
  check_shared(options, prepared.scenes);
  return prepared;
}

RunEstimate estimate_run(const std::vector<Scene>& scenes, const RunOptions& options) {
  CloudFiles files = cloud_files(scenes, options);
  const InterruptGuard guard;
  return estimate_run(scenes, options, files);
}

RunEstimate estimate_run(const std::vector<Scene>& scenes, const RunOptions& options, CloudFiles& files) {
  const std::uint64_t available = available_memory(options);
  CostEstimate expected =
      estimate_cost(scenes, available, options.threads, options.compare, files, ranks_together(scenes, options));
  check_memory(scenes.front(), expected, available);
  const PlannedScene planned = expected.only
                                   ? std::move(*expected.only)
                                   : plan_scene(scenes.front(), available, files, expected.levels_m, options.threads);
  const OpticalGrid& grid = planned.scene->problem.grid;
  return {{grid.box.nx, grid.box.ny, grid.box.nz()},
          grid.active_cells(),
          expected.memory,
          available,
          expected.seconds,
          plan_text(scenes, planned, expected, available),
          coordinates_of(scenes, planned)};
}

SolvedRun solve_run(const std::vector<Scene>& scenes, const RunOptions& options) {
  CloudFiles files = cloud_files(scenes, options);
  return solve_run(scenes, options, files);
}

SolvedRun solve_run(const std::vector<Scene>& scenes, const RunOptions& options, CloudFiles& files) {
  const std::uint64_t available = available_memory(options);
  SolvedRun run{scenes, {}, {}};
  std::optional<TargetReport> target;
  std::optional<SpectralInfo> spectral;
  std::vector<BandProfile> bands;
  if (options.target) {
    TargetRun done = reach_target(options, available, files);
    run.scenes = std::move(done.scenes);
    run.solved = std::move(done.solved);
    target = std::move(done.report);
  } else {
    CostEstimate expected =
        estimate_cost(scenes, available, options.threads, options.compare, files, ranks_together(scenes, options));
    check_memory(scenes.front(), expected, available);
    if (scenes.front().broadband) {
      BroadbandRun broadband = solve_broadband(scenes, expected, options, available, files);
      run.scenes.resize(1);
      run.solved = std::move(broadband.solved);
      spectral = std::move(broadband.info);
      bands = std::move(broadband.bands);
    } else {
      run.solved = solve_all(scenes, std::move(expected), options, available, files);
    }
  }
  if (!collects(options.share.get())) return run;
  std::vector<Solution> clear_sky;
  if (options.clear_sky) clear_sky = solve_clear_sky(scenes, options, available, files);
  run.info = result_info(run.scenes, run.solved, options);
  run.info.target = target;
  run.info.spectral = spectral;
  run.info.bands = std::move(bands);
  run.info.clear_sky = std::move(clear_sky);
  return run;
}

void write_run(const std::filesystem::path& output, const SolvedRun& run, int threads) {
  const ThreadScope scope(threads);
  write_result(output, run.solved.solutions, run.info, run.solved.independent_columns);
  InterruptGuard::check();
}

std::vector<std::string> shortcomings(const SolvedRun& run, const std::string& output) {
  std::vector<std::string> sentences;
  add_unconverged(run.scenes, run.solved.solutions, "", output, sentences);
  add_unconverged(run.scenes, run.solved.independent_columns, " as independent columns", output, sentences);
  const std::optional<TargetReport>& target = run.info.target;
  if (target && !target->met) {
    sentences.push_back(fmt::format("`{}` misses what was asked for, and no better level fits: {} is marked so",
                                    target->accuracy, output));
  }
  return sentences;
}

namespace {

/// Several solves are made apart. One is made together.
std::shared_ptr<SolveShare> share_of_ranks(Ranks& ranks, std::size_t solves) {
  if (solves == 1) return std::make_shared<SolvedTogether>(ranks);
  return std::make_shared<SharedByRanks>(ranks);
}

}  // namespace

int finish_run(const PreparedRun& prepared, const SolvedRun& solved, const RunOptions& options) {
  write_run(prepared.output, solved, options.threads);
  if (!options.quiet) {
    print_summaries(solved.scenes, solved.solved, solved.info);
    fmt::print("\nwritten to {}\n", prepared.output.string());
  }
  const std::vector<std::string> misses = shortcomings(solved, prepared.output.string());
  for (const std::string& sentence : misses) tell("cloudbow: {}\n", sentence);
  return misses.empty() ? exit_done : exit_not_converged;
}

int run(const RunOptions& given) {
  const PreparedRun prepared = prepare_run(given);
  const bool prints = given.ranks == nullptr || given.ranks->is_first();
  if (given.dry_run && !given.target) {
    const RunEstimate estimate = estimate_run(prepared.scenes, given);
    if (prints) fmt::print("{}", estimate.text);
    return exit_done;
  }
  const InterruptGuard guard;
  if (given.part) return solve_part(prepared, given);
  RunOptions options = given;
  if (options.ranks != nullptr) options.share = share_of_ranks(*options.ranks, prepared.scenes.size());
  const SolvedRun solved = solve_run(prepared.scenes, options);
  if (options.ranks == nullptr) return finish_run(prepared, solved, options);
  const std::vector<RankFigures> figures = rank_figures(*options.ranks);
  if (!prints) return exit_done;
  const int code = finish_run(prepared, solved, options);
  if (!options.quiet) fmt::print("{}", rank_figures_line(figures));
  return code;
}

}  // namespace cloudbow
