#!/usr/bin/env python3
"""The limits of accuracy: scenes at the ends of every range, run as a user would, each judged as solved, doubtful (farther from the truth than the
limit, but within twice the error that the result itself estimates), inaccurate (farther than that, with exit code 0 and all in order), not converged (exit code 3, and marked so), refused (exit code 2, one message) or wrong: anything else, a crash,
a number that is none, a ledger that does not close, a law of physics broken.

Parts: `columns`, the whole product of optical depth, single-scattering albedo, asymmetry, height of the sun and surface albedo in one column;
`voxels`, the same column made of voxels; `shapes`, `aspect`, `contrast`, `densities`, `offset`, `fields`: small clouds in 3D.

Truth: tests/reference/thick_slabs (doubling, in 80 bits) for all columns, kept in tests/data/extreme_columns.csv (`--make-truth` makes it anew, minutes;
with other numbers of angles it agrees to 1e-5 of the incident flux, 1e-3 for g .98 under mu0 .001); Beer's law in closed form without scattering; what does not scatter
neither reflects, what does not absorb loses nothing; tests/reference/monte_carlo for small clouds; the same cloud elsewhere for offsets.

usage: extremes.py [--part columns ...] [--quick] [--jobs 1] [--csv FILE] [--document docs/limits.md] | --make-truth
"""
import csv
import itertools
import json
import math
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

import monte_carlo
import support
from support import ROOT

OPTICAL_DEPTHS = (0.0, 1e-8, 1e-6, 1e-4, 0.01, 1.0, 10.0, 100.0, 1e3, 1e4, 1e5)
ALBEDOS = (0.0, 1e-6, 0.5, 0.999999, 1.0)
ASYMMETRIES = (-0.95, -0.5, 0.0, 0.5, 0.85, 0.95, 0.98)
SUNS = (1.0, 0.5, 0.05, 0.01, 0.001)
SURFACES = (0.0, 1.0)
HEIGHT_M = 1000.0
TRUTH = ROOT / "tests/data/extreme_columns.csv"

# In % of the incident flux. A column's reflectance and transmittance at `balanced`; small clouds of coarse voxels.
COLUMN_LIMIT = 0.5
FIELD_LIMIT = 1.0
LEDGER = 1e-5  # the program's promise
LEDGER_OF_HALVES = 1e-4  # with radiance in half precision
SINGLE = 2e-7  # a rounding of fields stored in 32 bits
SUMMED = 1e-4  # of optical paths summed in 32 bits along a grazing ray, over thousands of voxels
VERDICTS = ("solved", "doubtful", "inaccurate", "not converged", "refused", "wrong")


@dataclass
class Row:
    """Outcome of one run. Errors are in % of the incident flux; `relative` is of the smaller of R and T, in % of itself."""
    part: str
    name: str
    verdict: str
    why: str = ""
    error: float = math.nan
    relative: float = math.nan
    values: dict = field(default_factory=dict)


@dataclass(frozen=True)
class Column:
    tau: float
    ssa: float
    g: float
    mu0: float
    surface: float

    @property
    def name(self):
        return f"tau {self.tau:g}, ssa {self.ssa:.7g}, g {self.g:g}, mu0 {self.mu0:g}, surface {self.surface:g}"

    def tables(self, **solver):
        return [
            ("", {"title": self.name}),
            ("[layer]", {"bottom_m": 0.0, "top_m": HEIGHT_M, "optical_depth": self.tau, "single_scattering_albedo": self.ssa, "phase_function": "hg"}),
            *light_tables(self.g, self.mu0, self.surface), ("solver", solver)]


def light_tables(g, mu0, surface):
    return [("phase_function.hg", {"type": "henyey-greenstein", "asymmetry_parameter": g}),
            # Unit flux through the horizontal.
            ("sun", {"zenith_deg": support.zenith_deg(mu0), "azimuth_deg": 20.0, "irradiance_w_m2": 1 / mu0}),
            ("surface", {"type": "lambertian", "albedo": surface})]


class Runner:
    def __init__(self, options, folder):
        self.program = str(options.cloudbow)
        self.folder = folder
        self.threads = options.threads or 1
        self.settings = [word for setting in options.set for word in ("--set", setting)]

    def run(self, name, tables, estimate=False):
        """Exit code, messages, and the result, if there is one that can be read."""
        scene, output = self.folder / f"{name}.toml", self.folder / f"{name}.h5"
        scene.write_text(support.scene_text(tables))
        output.unlink(missing_ok=True)
        done = subprocess.run([self.program, "run", str(scene), "-o", str(output), "--quiet", "--threads", str(self.threads), "--set",
                               f"output.error_estimate={str(estimate).lower()}", *self.settings], capture_output=True, text=True)
        result = support.Result(output, done.returncode, 0, 0) if output.exists() else None
        return done.returncode, done.stderr, result

    def cloud(self, name, cell_m, values, first=(0, 0, 0)):
        """A VDB file of the extinction values [z, y, x], its first cell at index `first`."""
        text, cloud = self.folder / f"{name}.txt", self.folder / f"{name}.vdb"
        with open(text, "w") as file:
            for k, j, i in zip(*np.nonzero(values)):
                file.write(f"{i + first[0]} {j + first[1]} {k + first[2]} {values[k, j, i]:.9g}\n")
        columns = [values.shape[2] + first[0], values.shape[1] + first[1]]
        done = subprocess.run([self.program, "cloud", "import", str(text), "--format", "columns", "--quiet", "--voxel-size-m", *map(repr, map(float, cell_m)),
                               "--columns", *map(str, columns), "-o", str(cloud)], capture_output=True, text=True)
        return done.returncode, done.stderr, cloud


def one_message(text):
    lines = text.strip().splitlines()
    return len(lines) == 1 and lines[0].startswith("cloudbow: ") and "internal error" not in lines[0]


def without_result(part, name, code, text, result):
    """The verdict of a run that did not end with 0 or 3."""
    if code == 2:
        if one_message(text) and result is None:
            return Row(part, name, "refused", text.strip())
        return Row(part, name, "wrong", f"exit code 2 with {'a result' if result else 'messages'}: {text.strip()}")
    return Row(part, name, "wrong", f"exit code {code}: {text.strip()[:300]}")


def ledger_faults(result, conserves, surface):
    """Faults that a solved result may not show, whatever the scene."""
    found = []
    for name, values in {**result.fields, **{f"profile {name}": values for name, values in result.profile.items()}}.items():
        if not np.issubdtype(np.asarray(values).dtype, np.floating):
            continue
        if not np.all(np.isfinite(values)):
            found.append(f"{name} is not finite")
        elif "flux" in name and np.min(values) < -SINGLE:
            found.append(f"{name} is {np.min(values):.2e}")
    if any(not math.isfinite(value) for value in result.summary.values()):
        return [*found, "the summary is not finite"]
    ledger = LEDGER_OF_HALVES if result.solver.get("radiance_storage") == "float16" else LEDGER
    if result.exit_code == 0 and (result.solver["converged"] != 1 or abs(result.summary["energy_residual"]) > ledger):
        found.append(f"converged {result.solver['converged']}, residual {result.summary['energy_residual']:.1e} with exit code 0")
    if result.exit_code == 3 and result.solver["converged"] != 0:
        found.append("exit code 3 without mark")
    if conserves and (result.summary["absorptance"] != 0 or np.any(result.fields["absorbed_power"] != 0)):
        found.append(f"absorbs {result.summary['absorptance']:.1e} without absorbing")
    if surface == 1 and result.summary["surface_absorptance"] > ledger:
        found.append(f"a white surface absorbs {result.summary['surface_absorptance']:.1e}")
    return found


def judge(part, name, outcome, truth, limit, conserves, surface, more=lambda result: []):
    """truth: reflectance, transmittance and, if they have any, their standard errors; or None."""
    code, text, result = outcome
    if code not in (0, 3):
        return without_result(part, name, code, text, result)
    if result is None:
        return Row(part, name, "wrong", f"exit code {code} without a result")
    faults = ledger_faults(result, conserves, surface)
    if code == 3:
        if "not converged" not in text:
            faults.append("exit code 3 without a word")
        return Row(part, name, "wrong" if faults else "not converged", "; ".join(faults) or text.strip())
    faults += more(result)
    row = Row(part, name, "solved")
    found = (result.summary["reflectance"], result.summary["transmittance"])
    row.values = {"reflectance": found[0], "transmittance": found[1], "sweeps": result.solver["sweeps"]}
    if truth is not None:
        noise = truth[2:] or (0, 0)
        errors = [100 * abs(f - t) for f, t in zip(found, truth)]
        row.error = max(errors)
        small = min((0, 1), key=lambda n: truth[n])
        row.relative = errors[small] / truth[small] if truth[small] > 0 else math.nan
        row.values |= {"true_reflectance": truth[0], "true_transmittance": truth[1]}
        if not all(error - 300 * sigma <= limit for error, sigma in zip(errors, noise)):
            row.verdict = "inaccurate"
            row.why = f"reflectance {found[0]:.6g} for {truth[0]:.6g}, transmittance {found[1]:.6g} for {truth[1]:.6g}"
    if faults:
        row.verdict, row.why = "wrong", "; ".join(faults)
    return row


def ask_estimate(row, again):
    """Whether the result itself says how far off it is."""
    code, _, result = again()
    if code == 0:
        row.values["estimate"] = 100 * result.error_estimate["domain"]
        if row.error <= 2 * row.values["estimate"]:
            row.verdict = "doubtful"


def solve_slabs(options, slabs, angles=48):
    """Reflectance and transmittance of (g, tau, ssa, surface, mu0, mu0, ...), one after the other for the suns of each."""
    text = "".join(" ".join(map(repr, slab)) + "\n" for slab in slabs)
    done = subprocess.run([str(options.thick_slabs), str(angles)], input=text, capture_output=True, text=True, check=True)
    return [list(map(float, line.split())) for line in done.stdout.splitlines()]


def make_truth(options):
    slabs = list(itertools.product(ASYMMETRIES, OPTICAL_DEPTHS, ALBEDOS, SURFACES))
    with open(TRUTH, "w") as file:
        file.write("# made by tests/validation/extremes.py --make-truth: reflectance and transmittance for each cosine of the sun\n")
        file.write("g,optical_depth,ssa,surface," + ",".join(f"R {mu0},T {mu0}" for mu0 in SUNS) + "\n")
        for slab in slabs:
            # Strong peaks under a grazing sun need more angles.
            numbers, = solve_slabs(options, [(*slab, *SUNS)], 144 if slab[0] > 0.9 else 72)
            file.write(",".join(f"{number:.8g}" for number in [*slab, *numbers]) + "\n")


def read_truth():
    """Column to (reflectance, transmittance)."""
    truth = {}
    with open(TRUTH) as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        next(rows)
        for row in rows:
            g, tau, ssa, surface, *numbers = map(float, row)
            for n, mu0 in enumerate(SUNS):
                truth[Column(tau, ssa, g, mu0, surface)] = numbers[2 * n], numbers[2 * n + 1]
    return truth


def diffuse_transmittance(tau):
    """2 E3(tau): of isotropic light through an absorber."""
    node, weight = np.polynomial.legendre.leggauss(400)
    mu = (1 + node) / 2
    return float(np.sum(weight * mu * np.exp(-tau / mu)))


def column_faults(column, result, precision=SINGLE):
    """Closed forms that leave nothing to the angles."""
    found = []
    beam = math.exp(-column.tau / column.mu0)
    direct = float(result.profile["direct_flux"][0])
    # A layer's extinction coefficient is kept in 32 bits, so its optical depth is.
    if abs(direct - beam) > precision * (1 + column.tau / column.mu0) * beam + 1e-30:
        found.append(f"direct light {direct!r}, by Beer's law {beam!r}")
    if column.tau == 0 and abs(result.summary["reflectance"] - column.surface) > SINGLE:
        found.append(f"no matter, and reflectance {result.summary['reflectance']!r}")
    if column.ssa == 0:
        reflected = column.surface * beam * diffuse_transmittance(column.tau)
        if abs(result.summary["reflectance"] - reflected) > COLUMN_LIMIT / 100 or abs(result.summary["transmittance"] - beam) > SINGLE:
            found.append(f"an absorber reflects {result.summary['reflectance']!r} for {reflected!r}, transmits {result.summary['transmittance']!r} for {beam!r}")
    if column.ssa == 1 and column.surface == 1 and abs(result.summary["reflectance"] - 1) > LEDGER:
        found.append(f"nothing absorbs, and reflectance {result.summary['reflectance']!r}")
    return found


def not_monotone(rows):
    """Over a black surface more matter lets no more light through; and reflects no less, as all of it is of one kind."""
    found = []
    by_key = {row.values["column"]: row for row in rows if row.verdict == "solved"}
    slack = COLUMN_LIMIT / 100
    for key in itertools.product(ALBEDOS, ASYMMETRIES, SUNS):
        ladder = [by_key[column] for tau in OPTICAL_DEPTHS if (column := Column(tau, *key, 0.0)) in by_key]
        for one, next_ in zip(ladder, ladder[1:]):
            if next_.values["transmittance"] > one.values["transmittance"] + slack or next_.values["reflectance"] < one.values["reflectance"] - slack:
                found.append(Row(one.part, next_.name, "wrong", f"more light through than with {one.name}, or less back"))
    return found


def column_part(options, runner, columns, part="columns", make=None):
    truth = read_truth()

    def solve(numbered):
        number, c = numbered
        def outcome_of(estimate=False):
            return make(f"{part}_{number % 64}", c, estimate) if make else runner.run(f"{part}_{number % 64}", c.tables(), estimate)
        outcome = outcome_of()
        row = judge(part, c.name, outcome, truth[c], COLUMN_LIMIT, c.ssa == 1, c.surface,
                    lambda result: column_faults(c, result, SUMMED if part == "voxels" else SINGLE))
        row.values["column"] = c
        if row.verdict == "inaccurate":
            ask_estimate(row, lambda: outcome_of(True))
        if row.verdict == "wrong":
            print(line(row), flush=True)
        return row
    rows = support.in_parallel(options.jobs, solve, enumerate(columns))
    return rows + not_monotone(rows)


def columns_part(options, runner):
    columns = [Column(*values) for values in itertools.product(OPTICAL_DEPTHS, ALBEDOS, ASYMMETRIES, SUNS, SURFACES)]
    return column_part(options, runner, columns[::67] if options.quick else columns)


def columns_by_ordinates_part(options, runner):
    """Some of them by ordinates and iteration, as scenes with images or uneven ground are solved."""
    columns = [Column(*values) for values in itertools.product(OPTICAL_DEPTHS, ALBEDOS, ASYMMETRIES, SUNS, SURFACES)]
    return column_part(options, runner, columns[::371] if options.quick else columns[::7], "ordinates",
                       lambda name, c, estimate: runner.run(name, c.tables(mode="3d"), estimate))


def levels_part(options, runner):
    columns = [Column(*values) for values in itertools.product(OPTICAL_DEPTHS, ALBEDOS, ASYMMETRIES, SUNS, SURFACES)]
    chosen = columns[::771] if options.quick else columns[::31]
    return column_part(options, runner, chosen, "accuracy fine", lambda name, c, estimate: runner.run(name, c.tables(accuracy="fine"), estimate))


def voxels_part(options, runner):
    """Columns as 2 x 2 x 20 voxels in 3D: the grid of a user who cuts no layers finely as light falls off."""
    columns = [Column(*values) for values in itertools.product(OPTICAL_DEPTHS[1:], (0.5, 0.999999, 1.0), (-0.95, 0.0, 0.85, 0.98), SUNS, SURFACES)]

    def make(name, c, estimate):
        code, text, cloud = runner.cloud(name, (50, 50, HEIGHT_M / 20), np.full((20, 2, 2), c.tau / HEIGHT_M))
        if code != 0:
            return code, text, None
        return runner.run(name, [("", {"title": c.name}), cloud_table(cloud, c.ssa), *light_tables(c.g, c.mu0, c.surface), ("solver", {"mode": "3d"})], estimate)
    return column_part(options, runner, columns[::389] if options.quick else columns[::11], "voxels", make)


def cloud_table(cloud, ssa):
    return ("cloud", {"file": str(cloud), "quantity": "extinction", "single_scattering_albedo": ssa, "phase_function": "hg"})


@dataclass(frozen=True)
class Field:
    """A small cloud: extinction [z, y, x] as 32-bit floats."""
    name: str
    values: np.ndarray
    cell_m: tuple
    zenith_deg: float = 50.0
    ssa: float = 1.0
    g: float = 0.85
    surface: float = 0.2
    open_sides: bool = False
    photons: float = 0  # of the truth; 0: none
    first: tuple = (0, 0, 0)
    solver: tuple = ()
    output: tuple = ()

    def tables(self, cloud, extra=()):
        corner = np.multiply(self.first, self.cell_m)
        size = np.multiply(self.values.shape[::-1], self.cell_m)
        tables = [("", {"title": self.name}), cloud_table(cloud, self.ssa),
                  ("domain", {"boundary": "open" if self.open_sides else "periodic", "min_m": list(corner), "max_m": list(corner + size)}),
                  *light_tables(self.g, math.cos(math.radians(self.zenith_deg)), self.surface), ("solver", dict(self.solver)), *extra]
        return [*tables, ("output", dict(self.output))] if self.output else tables

    def truth(self, program):
        if not self.photons:
            return None
        nz, ny, nx = self.values.shape
        job = monte_carlo.Job(self.cell_m[2] * np.arange(nz + 1), (nx, ny), self.cell_m[:2],
                              [(self.ssa, monte_carlo.henyey_greenstein(self.g), self.values)], (self.zenith_deg, 20.0), self.surface,
                              self.open_sides, [0, nz])
        solution = program.run(job, self.photons)
        return solution.up[1].mean, solution.down[0].mean, solution.up[1].mean_error, solution.down[0].mean_error


def solve_field(part, case, options, runner, number=0, extra=()):
    """The row, and the result itself."""
    name = f"{part}_{number % 64}".replace(" ", "_")
    code, text, cloud = runner.cloud(name, case.cell_m, case.values, case.first)
    if code != 0:
        return without_result(part, case.name, code, text, None), None
    tables = case.tables(cloud, extra)
    outcome = runner.run(name, tables)
    truth = case.truth(monte_carlo.MonteCarlo(options.monte_carlo)) if outcome[0] == 0 else None
    row = judge(part, case.name, outcome, truth, FIELD_LIMIT, case.ssa == 1, case.surface)
    if row.verdict == "inaccurate":
        ask_estimate(row, lambda: runner.run(name, tables, True))
    return row, outcome[2]


def solve_fields(part, cases, options, runner):
    rows = support.in_parallel(options.jobs, lambda numbered: solve_field(part, numbered[1], options, runner, numbered[0])[0], enumerate(cases))
    for row in rows:
        if row.verdict == "wrong":
            print(line(row), flush=True)
    return rows


def lumpy(shape, optical_depth, cell_m, seed=5):
    """A third of the cells clear, the others from a tenth to three times the mean; optical depth is that of a mean cell from top to bottom."""
    random = np.random.default_rng(seed)
    values = random.choice([0, 0.1, 0.5, 1, 1, 3], size=shape) * optical_depth / cell_m[2]
    values[0, 0, 0] = optical_depth / cell_m[2]
    return values.astype(np.float32)


def shapes_part(options, runner):
    """One voxel, one column, one row, one sheet."""
    cases = []
    for shape in ((1, 1, 1), (8, 1, 1), (1, 8, 1), (1, 1, 8), (1, 8, 8), (8, 1, 8), (8, 8, 1)):
        for open_sides in (False, True):
            for mode in ("auto", "3d", "independent-columns", "independent-diffuse"):
                truth = 2e5 if mode in ("auto", "3d") else 0
                cell_m = (50.0, 50.0, 50.0)
                cases.append(Field(f"{shape[2]} x {shape[1]} x {shape[0]}{', open' if open_sides else ''}, {mode}", lumpy(shape, 1, cell_m), cell_m,
                                   open_sides=open_sides, photons=truth, solver=(("mode", mode),)))
    return solve_fields("shapes", cases[::9] if options.quick else cases, options, runner)


def aspect_part(options, runner):
    """Cells from a thousand times as wide as high to a thousand times as high as wide."""
    cases = []
    for power in range(-3, 4):
        for zenith_deg in (0.0, 60.0, 85.0):
            for open_sides in (False, True):
                cell_m = (50.0, 50.0, 50.0 * 10.0**power)
                cases.append(Field(f"dz/dx 1e{power}, sun {zenith_deg:g}{', open' if open_sides else ''}", lumpy((6, 6, 6), 1, cell_m), cell_m,
                                   zenith_deg=zenith_deg, open_sides=open_sides, photons=2e5 if power < 2 else 2e4 if power == 2 else 0))  # photons that cross thousands of cells
    return solve_fields("aspect", cases[::9] if options.quick else cases, options, runner)


def contrast_part(options, runner):
    """Neighbours that differ by 1e8, as a checkerboard in space, in columns and in layers; thin is 1e-6 to 1e-2 a cell."""
    cases = []
    z, y, x = np.indices((6, 6, 6))
    for pattern, odd in (("checkerboard", (x + y + z) % 2), ("columns", (x + y) % 2), ("layers", z % 2)):
        for thin in (1e-6, 1e-4, 1e-2):
            for ssa in (0.9, 1.0):
                cell_m = (50.0, 50.0, 50.0)
                values = (np.where(odd, 1e8 * thin, thin) / cell_m[2]).astype(np.float32)
                # Light that is not absorbed is scattered as often as the cells are thick.
                cases.append(Field(f"{pattern}, {thin:g} and {1e8 * thin:g}, ssa {ssa:g}", values, cell_m, ssa=ssa,
                                   photons=2e5 if ssa < 1 else 2e4 if thin == 1e-6 else 0))
    return solve_fields("contrast", cases[::9] if options.quick else cases, options, runner)


def densities_part(options, runner):
    """The whole range of floats, least and greatest together too. Slabs: from optical depth 1e5 on the truth is that of 1e5."""
    least, greatest = 1.5e-45, 3.4e38
    cases = []
    for value in (least, 1e-40, 1.2e-38, 1e-30, 1e-20, 1e-10, 1.0, 1e3, 1e5, 1e10, 1e20, 9e29, greatest):
        for ssa in (0.0, 0.9, 1.0):
            for mode in ("auto", "3d", "independent-columns"):
                cases.append((value, Field(f"{value:g} 1/m, ssa {ssa:g}, {mode}", np.full((4, 4, 4), value, np.float32), (100.0, 100.0, 100.0), ssa=ssa,
                                           surface=0.0, solver=(("mode", mode),))))
    chosen = cases[::17] if options.quick else cases
    mu0 = math.cos(math.radians(chosen[0][1].zenith_deg))
    truths = solve_slabs(options, [(case.g, min(1e5, 400 * value), case.ssa, case.surface, mu0) for value, case in chosen])
    rows = []
    for number, (value, case) in enumerate(chosen):
        name = f"densities_{number}"
        code, text, cloud = runner.cloud(name, case.cell_m, case.values)
        outcome = runner.run(name, case.tables(cloud)) if code == 0 else (code, text, None)
        row = judge("densities", case.name, outcome, truths[number], FIELD_LIMIT, case.ssa == 1, 0.0)
        if row.verdict == "inaccurate":
            ask_estimate(row, lambda tables=case.tables(cloud): runner.run(name, tables, True))
        rows.append(row)
    for greatest_here in (1e10, 1e30, greatest):
        values = np.full((4, 4, 4), least, np.float32)
        values[::2, ::2, ::2] = greatest_here
        rows.append(solve_field("densities", Field(f"{least:g} and {greatest_here:g} 1/m", values, (100.0, 100.0, 100.0)), options, runner)[0])
    for row in rows:
        if row.verdict == "wrong":
            print(line(row), flush=True)
    return rows


def offset_part(options, runner):
    """A cloud, and layers, a thousand kilometres and more from the origin: the same as at it."""
    rows = []
    cell_m = (50.0, 50.0, 50.0)
    here, at_origin = solve_field("offset", Field("cloud at the origin", lumpy((6, 6, 6), 1, cell_m), cell_m, photons=4e5), options, runner)
    rows.append(here)
    for cells in ((20000, 0, 0), (0, 20000, 0), (20000, 20000, 0)):
        row, result = solve_field("offset", Field(f"cloud {cells[0] * 0.05:g} km along x, {cells[1] * 0.05:g} km along y", lumpy((6, 6, 6), 1, cell_m), cell_m,
                                                  first=cells), options, runner)
        rows.append(compared(row, result, at_origin))
    column = Column(10.0, 0.999999, 0.85, 0.5, 1.0)
    code, _, at_origin = runner.run("offset", column.tables())
    assert code == 0
    for offset_m in (1e4, 1e6, -1e6, 1e8):
        tables = column.tables()
        tables[1][1].update(bottom_m=offset_m, top_m=offset_m + HEIGHT_M)
        outcome = runner.run("offset", tables)
        rows.append(compared(judge("offset", f"layer {offset_m / 1000:g} km up", outcome, None, 0, False, 1.0), outcome[2], at_origin))
    for row in rows:
        if row.verdict == "wrong":
            print(line(row), flush=True)
    return rows


def compared(row, result, other):
    """Fluxes level by level against those of the same scene elsewhere; heights far away have fewer digits."""
    if row.verdict != "solved":
        return row
    pairs = [(result.fields[name], other.fields[name]) for name in ("upwelling_flux", "downwelling_diffuse_flux", "direct_flux")]
    if any(one.shape != two.shape for one, two in pairs):
        row.verdict, row.why = "wrong", "other levels than at the origin"
        return row
    row.error = 100 * max(float(np.max(np.abs(one - two))) for one, two in pairs)
    if row.error > 0.01:
        row.verdict, row.why = "wrong", f"differs from the one at the origin by {row.error:.2g} % of the incident flux"
    return row


def fields_part(options, runner):
    """All fields of a result: thin, thick, black and white clouds, high and low suns, both storages: every number is one."""
    views = [("[radiance]", {"name": "up", "zenith_deg": 0.0}), ("[radiance]", {"name": "slant", "zenith_deg": 88.0, "azimuth_deg": 10.0}),
             ("[radiance]", {"name": "sky", "zenith_deg": 150.0})]
    rows, cases = [], []
    cell_m = (50.0, 50.0, 50.0)
    for tau, ssa, zenith_deg in itertools.product((1e-8, 1e-2, 1.0, 100.0, 1e4), (0.0, 0.5, 1.0), (0.0, 60.0, 89.9)):
        for storage in ("float32", "float16"):
            cases.append(Field(f"tau {tau:g} a cell, ssa {ssa:g}, sun {zenith_deg:g}, {storage}", lumpy((4, 4, 4), tau, cell_m), cell_m, zenith_deg=zenith_deg, ssa=ssa,
                               surface=1.0, solver=(("mode", "3d"), ("radiance_storage", storage)),
                               output=(("fields", ["fluxes", "absorption", "actinic", "radiance_field"]),)))
    for number, case in enumerate(cases[::19] if options.quick else cases):
        row, _ = solve_field("fields", case, options, runner, number, views)
        rows.append(row)
        if row.verdict == "wrong":
            print(line(row), flush=True)
    return rows


PARTS = {"columns": columns_part, "ordinates": columns_by_ordinates_part, "accuracy fine": levels_part, "voxels": voxels_part, "shapes": shapes_part, "aspect": aspect_part,
         "contrast": contrast_part, "densities": densities_part, "offset": offset_part, "fields": fields_part}


def line(row):
    error = "" if math.isnan(row.error) else f"  error {row.error:.4f} %"
    return f"{row.verdict:14s}{row.part}: {row.name}{error}{'  ' + row.why if row.why else ''}"


def verdict_table(rows):
    """By part; the errors are of all that has a truth."""
    table = []
    for part in [*dict.fromkeys(row.part for row in rows), None]:
        here = [row for row in rows if part in (None, row.part)]
        errors = sorted((row.error, row.name) for row in here if not math.isnan(row.error))
        table.append([part or "**all**", len(here), *(sum(row.verdict == verdict for row in here) for verdict in VERDICTS), len(errors),
                      f"{support.median([e for e, _ in errors]):.4f}" if errors else "", f"{errors[-1][0]:.3f}" if errors else "", errors[-1][1] if errors else ""])
    return support.markdown_table(["part", "tried", *VERDICTS, "with a truth", "median error %", "worst %", "worst case"], table)


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["part", "name", "verdict", "error", "relative", "why", "values"])
        for row in rows:
            values = {key: value for key, value in row.values.items() if key != "column"}
            writer.writerow([row.part, row.name, row.verdict, row.error, row.relative, row.why, json.dumps(values, default=float)])


def read_csv(path):
    rows = []
    with open(path, newline="") as file:
        for part, name, verdict, error, relative, why, values in list(csv.reader(file))[1:]:
            row = Row(part, name, verdict, why, float(error), float(relative), json.loads(values))
            if name.startswith("tau ") and "mu0" in name:
                tau, ssa, g, mu0, surface = (float(word.split()[-1]) for word in name.split(", "))
                row.values["column"] = Column(tau, ssa, g, mu0, surface)
            rows.append(row)
    return rows


def worst_errors(rows, mu0, what):
    """Of one sun, [asymmetry][optical depth]: the worst over single-scattering and surface albedo; and whether all converged."""
    worst, whole = np.full((len(ASYMMETRIES), len(OPTICAL_DEPTHS)), np.nan), np.ones((len(ASYMMETRIES), len(OPTICAL_DEPTHS)), bool)
    for row in rows:
        column = row.values["column"]
        if column.mu0 != mu0:
            continue
        if what == "relative" and min(row.values.get("true_reflectance", 0), row.values.get("true_transmittance", 0)) < 1e-10:
            continue
        at = ASYMMETRIES.index(column.g), OPTICAL_DEPTHS.index(column.tau)
        worst[at] = np.fmax(worst[at], getattr(row, what))
        whole[at] &= row.verdict != "not converged"
    return worst, whole


def plot(path, rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.colors import LogNorm
    figure, axes = plt.subplots(2, 3, figsize=(15, 7.6), sharex=True, sharey=True, constrained_layout=True)
    panels = [(f"mu0 {mu0:g}", *worst_errors(rows, mu0, "error")) for mu0 in SUNS]
    high = [worst_errors(rows, mu0, "relative") for mu0 in SUNS if mu0 >= 0.5]
    panels.append(("the smaller of R and T, in % of itself, from 1e-10, mu0 .5 and 1", np.fmax(*(worst for worst, _ in high)), np.logical_and(*(whole for _, whole in high))))
    for axis, (title, worst, whole) in zip(axes.flat, panels):
        image = axis.imshow(np.maximum(worst, 1e-4), origin="lower", aspect="auto", cmap="viridis", norm=LogNorm(1e-4, 10))
        axis.set_title(title, fontsize=10)
        for (g, tau), error in np.ndenumerate(worst):
            if not math.isnan(error):
                text = "0" if error < 5e-5 else f"{error:.0e}".replace("e-0", "e-") if error < 0.00095 else f"{error:.2g}".replace("0.", ".", 1)
                axis.text(tau, g, text + ("" if whole[g, tau] else "*"), ha="center", va="center", fontsize=7, color="black" if error > 0.1 else "white")
        axis.set_xticks(range(len(OPTICAL_DEPTHS)))
        axis.set_xticklabels([f"{tau:g}" for tau in OPTICAL_DEPTHS], rotation=45, fontsize=8)
        axis.set_yticks(range(len(ASYMMETRIES)))
        axis.set_yticklabels([f"{g:g}" for g in ASYMMETRIES], fontsize=8)
    for axis in axes[-1]:
        axis.set_xlabel("optical depth")
    for axis in axes[:, 0]:
        axis.set_ylabel("asymmetry parameter")
    figure.colorbar(image, ax=axes, label="error of reflectance and transmittance, % of the incident flux (*: some not converged)", shrink=0.8)
    figure.savefig(path, dpi=90)


def write_document(path, rows):
    support.write_between_markers(path, "extremes-verdicts", verdict_table(rows))
    columns = [row for row in rows if row.part == "columns"]
    if columns:
        plot(path.parent / "images/extremes.png", columns)


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--part", nargs="+", choices=PARTS, help="default: all")
    parser.add_argument("--quick", action="store_true", help="some hundred runs instead of five thousand")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="passed on to `cloudbow run`")
    parser.add_argument("--csv", type=Path, help="write every run with its verdict")
    parser.add_argument("--read", type=Path, nargs="+", default=[], metavar="FILE", help="take these runs as they were; with --part, others besides")
    monte_carlo.add_programs(parser)
    parser.add_argument("--document", type=Path, help="write tables and picture into this page")
    parser.add_argument("--make-truth", action="store_true")
    options = parser.parse_args()
    if options.make_truth:
        make_truth(options)
        return 0

    start = support.now()
    rows = [row for path in options.read for row in read_csv(path)]
    with support.Workspace(options.keep) as folder:
        runner = Runner(options, folder)
        for row in rows:
            if row.part == "columns" and row.verdict == "inaccurate" and "estimate" not in row.values:
                ask_estimate(row, lambda: runner.run("again", row.values["column"].tables(), True))
        for part in [None, *(options.part or ([] if options.read else PARTS))]:
            rows += PARTS[part](options, runner) if part else []
            if options.csv:
                write_csv(options.csv, rows)
            print(f"{part or 'before'}: {support.now() - start:.0f} s", flush=True)
    print("\n".join(line(row) for row in rows if row.verdict in ("refused", "not converged")))
    print(verdict_table(rows))
    if options.document:
        write_document(options.document, rows)
    return 1 if any(row.verdict == "wrong" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
