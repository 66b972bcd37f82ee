#!/usr/bin/env python3
"""Writes docs/validation.md and its pictures: runs the drivers of this folder and sets what they find beside the truths.

The prose stands in validation.md.in; between it come sections of figures, none of which is typed by hand. Each section is made by a function here
and can be remade by itself; those that are not asked for, or whose reference data are not here, stay as the page has them, and the command says so.

usage: report.py [--section NAME ...] [--list]      (by scripts/validate, which builds what is needed first)
"""
import contextlib
import io
import json
import math
import re
import resource
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

import convergence
import droplet_classes
import intercomparison
import made_fields
import monte_carlo_references
import plane_parallel
import plane_parallel_radiance
import plane_parallel_truths
import step_radiance
import support
import surfaces
import symmetry
from support import ROOT, markdown_table

PAGE = ROOT / "docs/validation.md"
TEMPLATE = Path(__file__).with_suffix("").parent / "validation.md.in"
IMAGES = ROOT / "docs/images"
# Of the build's folder of tests, by the option that drivers have for them.
PROGRAMS = {"monte_carlo": "reference/monte_carlo", "cloud_cells": "reference/cloud_cells", "plane_parallel": "reference/plane_parallel",
            "turn_cloud": "validation/turn_cloud"}
LEVELS = ("draft", "balanced", "fine", "reference")
# Single-layer cases that are solved as voxels in 3D: without the columns of optical depth 1000 and more, which take minutes.
VOXEL_CASES = "a_*,b_*,c_*,d_*,e_ext_tau1e-06*,e_ext_tau0.001*,g_*,i_*"


class Skipped(Exception):
    """The data of a section are not here."""


class Section:
    """Runs drivers on the program under test and prints their commands."""

    def __init__(self, options):
        self.options = options

    def figures(self, driver, *words):
        self.tell(f"tests/validation/{driver.__name__}.py", *words)
        options = driver.arguments().parse_args([str(word) for word in words])
        programs = {name: self.options.tests / path for name, path in PROGRAMS.items()}
        for name, value in {"cloudbow": self.options.cloudbow, "threads": self.options.threads, "jobs": 1, **programs}.items():
            if hasattr(options, name):
                setattr(options, name, value)
        try:
            return driver.figures(options)
        except SystemExit as end:
            if end.code == support.SKIPPED:
                raise Skipped(f"{driver.__name__}.py was skipped") from None
            raise

    def references(self):
        folder = support.reference_folder()
        if folder is None:
            raise Skipped("CLOUDBOW_REFERENCE_DIR is not set")
        return folder

    def tell(self, *words):
        command = " ".join(shlex.quote(str(word).replace(f"{ROOT}/", "")) for word in words)
        print(f"    {command}", file=sys.stderr, flush=True)


def number(value, digits=2):
    """Significant digits without an exponent if that is readable."""
    if value == 0:
        return "0"
    if abs(value) < 1e-4 or abs(value) >= 1e5:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{max(0, digits - 1 - math.floor(math.log10(abs(value))))}f}"


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def histogram(path, panels):
    """Panels of (title, {label: values in per cent}): how many lie in which half decade, and the truth's own error in grey."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import numpy as np
    figure, axes = plt.subplots(1, len(panels), figsize=(5.5 * len(panels), 3.8), constrained_layout=True, squeeze=False)
    edges = 10.0 ** np.arange(-7, 2.01, 0.25)
    for axis, (title, found) in zip(axes.flat, panels.items()):
        for label, values in found.items():
            clipped = np.clip(values, edges[0], edges[-1] * 0.999)
            weights = np.full(len(clipped), 100 / len(clipped))
            if label == "truth":
                axis.hist(clipped, edges, weights=weights, color="0.85", label="the truth's own error")
            else:
                axis.hist(clipped, edges, weights=weights, histtype="step", lw=1.5, label=label)
        axis.set_xscale("log")
        axis.set_xlabel("error, %")
        axis.set_ylabel("share of the cases, %")
        axis.set_title(title)
        axis.set_ylim(top=1.35 * axis.get_ylim()[1])  # room for the legend
        axis.legend(fontsize=8, loc="upper left", ncol=2)
    figure.savefig(path, dpi=110)


def plane_parallel_source():
    """The file of its cases: the reference folder's file, else the subset of tests/data."""
    return "all that have no thermal light" if support.reference_folder() else "the subset in `tests/data`"


# ---- sections -------------------------------------------------------------------------------------------------------


def truths(section):
    """The truth, and its own error if there is a figure."""
    rows = section.figures(plane_parallel_truths)
    radiances = [value for row in rows for value in row["radiances"]]
    lines = [["discrete ordinates (cdisort), plane-parallel fluxes, % of incident", len(rows), number(support.median([r["ordinates"] for r in rows])),
              number(max(r["ordinates"] for r in rows)), "half the streams"],
             ["adding and doubling, the same cases", len(rows), number(support.median([r["adding"] for r in rows])), number(max(r["adding"] for r in rows)),
              "two thirds of the angles"],
             ["**these two against each other**", len(rows), number(support.median([r["flux"] for r in rows])), number(max(r["flux"] for r in rows)),
              "two methods, no common code"]]
    if radiances:
        lines.append(["**radiances, the two against each other**, relative, %", len(radiances), number(support.median(radiances)), number(max(radiances)), "the same"])
    text = markdown_table(["truth", "cases", "median", "worst", "own error known from"], lines)
    bad = [row["case"] for row in rows if not plane_parallel_truths.is_good(row, 1e-4)]
    text += f"\nFluxes further apart than the two say of themselves: {', '.join(bad) or 'none'}.\n"
    if support.reference_folder() is None:
        return text + "\nWithout the reference data here: the Monte Carlo programs were not set against each other.\n"
    found = section.figures(monte_carlo_references)
    fluxes, images = ([r for r in found if ("I_mu" in r["what"]) == image] for image in (False, True))
    text += "\n" + markdown_table(
        ["Monte Carlo of tests/reference against others", "quantities", "means apart, standard errors: RMS", "largest", "columns apart, standard errors: RMS", "largest"],
        [[name, len(those), f"{math.sqrt(sum(r['strayed']**2 for r in those) / len(those)):.2f}", f"{max(abs(r['strayed']) for r in those):.2f}",
          f"{math.sqrt(sum(r['columns']**2 for r in those) / len(those)):.2f}", f"{max(r['columns'] for r in those):.2f}"]
         for name, those in (("fluxes: step cloud, RICO", fluxes), ("radiances of the step cloud", images))])
    return text


def plane_parallel_errors(section, picture, *settings, by_group=True):
    """A table of all cases at every level, by group if asked for, and a picture of that name."""
    found = {level: [row for row in section.figures(plane_parallel, "--accuracy", level, *settings)] for level in LEVELS}
    failed = [f"`{row['case']}` at {level}" for level, rows in found.items() for row in rows if "failure" in row or not row["converged"]]
    found = {level: [row for row in rows if "failure" not in row] for level, rows in found.items()}
    edge = lambda row: max(row["up"], row["diffuse"], row["direct"])
    inside = lambda row: row["profile"]
    text = f"{len(found[LEVELS[0]])} cases, {plane_parallel_source()}. In % of the incident flux, median / worst.\n\n"
    groups = [(plane_parallel.group_name(group), group, edge) for group in sorted({row["case"][0] for row in found[LEVELS[0]]})]
    lines = []
    for title, group, error in [*(groups if by_group else []), ("**all**", None, edge), ("**all, every level and flux of the profile**", None, inside)]:
        of = {level: [row for row in rows if group in (None, row["case"][0])] for level, rows in found.items()}
        lines.append([title, len(of[LEVELS[0]]), number(max(row["truth"] for row in of[LEVELS[0]]), 1),
                      *(f"{number(support.median([error(r) for r in rows]))} / {number(max(error(r) for r in rows))}" for rows in of.values())])
    text += markdown_table(["top and bottom: upward, diffuse and direct", "cases", "truth's own, worst", *LEVELS], lines)
    worst = {level: max(rows, key=inside) for level, rows in found.items()}
    text += "\nWorst of all: " + "; ".join(f"{level} `{row['case']}` {number(row['profile'])} %" for level, row in worst.items()) + ".\n"
    text += f"Worst energy residual: {max(row['ledger'] for rows in found.values() for row in rows):.0e} of incident. Not converged: {', '.join(failed) or 'none'}.\n"
    histogram(IMAGES / picture,
              {"fluxes at top and bottom": {"truth": [row["truth"] for row in found[LEVELS[0]]], **{level: [edge(row) for row in rows] for level, rows in found.items()}},
               "whole profile": {"truth": [row["truth"] for row in found[LEVELS[0]]], **{level: [inside(row) for row in rows] for level, rows in found.items()}}})
    return text + f"\n![Errors of plane-parallel fluxes](images/{picture})\n"


def plane_parallel_section(section):
    return plane_parallel_errors(section, "validation_plane_parallel.png")


def ordinates(section):
    return plane_parallel_errors(section, "validation_ordinates.png", "--set", "solver.mode=3d", by_group=False)


def voxels(section):
    levels = LEVELS[:2]
    found = {level: section.figures(plane_parallel, "--voxels", "--reference", ROOT / "tests/data/plane_parallel_subset.json", "--cases", VOXEL_CASES, "--accuracy", level) for level in levels}
    lines = []
    for group in [*sorted({row["case"][0] for row in found[levels[0]]}), None]:
        of = [[row for row in found[level] if group in (None, row["case"][0])] for level in levels]
        cells = [plane_parallel.group_name(group) if group else "**all**", len(of[0])]
        for error in (lambda row: max(row["up"], row["diffuse"], row["direct"]), lambda row: row["profile"]):
            cells += [f"{number(support.median([error(r) for r in rows]))} / {number(max(error(r) for r in rows))}" for rows in of]
        lines.append(cells)
    return markdown_table(["group", "cases", *(f"top and bottom, {level}" for level in levels), *(f"whole profile, {level}" for level in levels)], lines)


def radiances(section):
    section.references()
    levels = LEVELS[:3]
    found = {level: section.figures(plane_parallel_radiance, "--accuracy", level) for level in levels}
    groups = [(plane_parallel.group_name(letter), lambda row, letter=letter: row["case"][0] == letter) for letter in sorted({row["case"][0] for row in found[levels[0]]})]
    groups.append(("**a to d, optical depth from .1**", lambda row: row["judged"]))
    lines = []
    for title, belongs in groups:
        cells = [title]
        for n, level in enumerate(levels):
            rows = [row for row in found[level] if belongs(row)]
            errors = [abs(error) for row in rows for error, _ in row["errors"]]
            if n == 0:
                own = [row["truth"] for row in rows if row["truth"] is not None]
                cells += [len(rows), f"{number(support.median(own), 1)} / {number(max(own), 1)}" if own else ""]
            cells.append(f"{number(support.median(errors))} / {number(percentile(errors, 0.95))} / {number(max(errors))}")
        lines.append(cells)
    text = markdown_table(["group", "cases", "truth's own: median / worst", *levels], lines)
    worst = max(((abs(error), row["case"], view) for row in found["fine"] for error, view in row["errors"]))
    text += f"\nRelative, in %: median / 95th percentile / worst. Worst of all at `fine`: `{worst[1]}`, {worst[2]}.\n"
    panels = {}
    for title, belongs in (("radiances, HG .85 and gentler, optical depth from .1", lambda row: row["judged"]), ("radiances, all", lambda row: True)):
        panels[title] = {"truth": [row["truth"] for row in found["fine"] if belongs(row) and row["truth"] is not None],
                         **{level: [abs(error) for row in rows if belongs(row) for error, _ in row["errors"]] for level, rows in found.items()}}
    histogram(IMAGES / "validation_radiances.png", panels)
    return text + "\n![Errors of plane-parallel radiances](images/validation_radiances.png)\n"


def cloud_lines(rows):
    return [[row["case"], row["accuracy"], f"{row['domain_noise']:.3f}; {row['up_noise']:.2f}, {row['down_noise']:.2f}", f"{row['dR']:+.3f}", f"{row['dT']:+.3f}",
             f"{row['up']:.2f}", f"{row['down']:.2f}", f"{row['ledger']:.0e}", row["sweeps"], number(row["cpu_seconds"]), f"{row['memory_mb']:.0f}"] for row in rows]


CLOUD_HEADER = ["case", "accuracy", "truth's noise: domain; columns up, down", "dR", "dT", "columns up", "columns down", "energy residual", "sweeps", "CPU s", "MB"]


def over(rows):
    faults = [fault for row in rows for fault in row["faults"]]
    return f"\nOver the project's limits for its level: {'; '.join(faults) or 'none'}.\n"


def clouds(section):
    section.references()
    rows = []
    for level in LEVELS:
        rows += [{"accuracy": level, **row} for row in section.figures(intercomparison, "step", "rico", "--accuracy", level)]
    rows.sort(key=lambda row: row["case"])
    for row in rows:
        row["faults"] = [f"{row['accuracy']}, {fault}" for fault in row["faults"]]
    return markdown_table(CLOUD_HEADER, cloud_lines(rows)) + over(rows)


def landsat(section):
    section.references()
    rows = [{"accuracy": level, **row} for level in LEVELS[:2] for row in section.figures(intercomparison, "landsat", "--accuracy", level)]
    rows.sort(key=lambda row: row["case"])
    return markdown_table(CLOUD_HEADER, cloud_lines(rows))


def made(section):
    rows = section.figures(made_fields)
    return markdown_table(CLOUD_HEADER, cloud_lines(rows)) + over(rows)


def step_radiances(section):
    section.references()
    levels = LEVELS[:3]
    found = {level: section.figures(step_radiance, "--accuracy", level, "--made") for level in levels}
    lines = [[first["case"], first["sensor"], f"{first['mean_noise']:.2f}; {first['noise']:.2f}", *(f"{row['mean']:+.2f}; {row['rms']:.2f}" for row in (first, *others))]
             for first, *others in zip(*found.values())]
    lines.append(straight_up("straight up, mean of the four", found))
    other = {level: section.figures(step_radiance, "--accuracy", level) for level in levels}
    lines.append(straight_up("the same against the I3RC community model", other))
    return markdown_table(["truth: tests/reference/monte_carlo, 3e6 photons", "sensor", "its noise: mean; columns", *(f"{level}: mean; columns" for level in levels)], lines)


def straight_up(title, found):
    """Row of the mean errors of images from the zenith, with the noise of their truth."""
    overhead = {level: [row for row in rows if row["sensor"].startswith("zenith 0")] for level, rows in found.items()}
    noise = [row["mean_noise"] for row in overhead["fine"]]
    return [f"**{title}**", "", number(math.sqrt(sum(one**2 for one in noise)) / len(noise)), *(f"{sum(row['mean'] for row in rows) / len(rows):+.2f}" for rows in overhead.values())]


def order(section):
    picture = IMAGES / "validation_convergence.png"
    studies = section.figures(convergence)
    convergence.plot(picture, studies)
    text = markdown_table(["study", "refined", "error of", "truth", "errors, coarsest to finest", "slope of the three finest", "order of the method", "least allowed"],
                          [[s.name, s.refined, s.quantity, s.truth, ", ".join(f"{e:.1e}" for e in s.error), f"{s.slope:.2f}" if math.isfinite(s.least) else "", s.order,
                            f"{s.least:g}" if math.isfinite(s.least) else f"error {s.most:.0e}"] for s in studies])
    return text + "\n![Errors against the size of cells and the number of directions](images/validation_convergence.png)\n"


def symmetries(section):
    rows = section.figures(symmetry)
    turned = {kind: max((row for row in rows if row["what"].startswith("sun at") and row["what"].endswith(kind)), key=lambda row: row["found"]) for kind in ("domain", "columns")}
    shown = [{**row, "what": f"clouds turned and mirrored with their sun, the worst of eight: {kind}"} for kind, row in turned.items()]
    shown += [row for row in rows if not row["what"].startswith("sun at")]
    return markdown_table(["what must not change", "found", "allowed", "unit"], [[r["what"], number(r["found"]), number(r["limit"]), r["unit"]] for r in shown])


def ground(section):
    section.references()
    return surfaces.table(section.figures(surfaces))


def droplets(section):
    found = section.figures(droplet_classes)
    return (f"Largest change of reflectance, transmittance or absorptance {number(found['error'])} % of the incident (estimated by the program: {number(found['estimate'])} %; "
            f"allowed: {number(found['allowed'])} %), {found['classes']} classes in the place of {found['all_classes']}.\n")


# Tests whose comparisons are worth a line each; the truth that each names, in short.
UNIT_TESTS = {
    "unit/optics/test_droplets": {
        "MieSphere.SmallSpheresScatterAsRayleigh": "closed form: Rayleigh's limit with its next term (van de Hulst 1957), relative",
        "MieSphere.AbsorptionOfSmallSpheresIsExactHoweverWeak": "closed form (Bohren & Huffman Eq. 5.11), relative",
        "MieSphere.ObeysTheOpticalTheorem": "optical theorem (Bohren & Huffman Eq. 4.62), relative",
        "MieSphere.IntensityIntegratesToScatteringAndAsymmetry": "sum rules, relative",
        "MieSphere.SoftSpheresDiffractAnomalously": "closed form: anomalous diffraction (van de Hulst 1957), relative",
        "MieSphere.LargeSpheresExtinguishTwiceTheirSection": "limit with edge term (Nussenzveig & Wiscombe 1980)",
        "MieSphere.AgreesWithWiscombesTestCases": "published: Wiscombe (1979), 19 spheres, efficiencies and g",
        "MieSphere.AgreesWithBohrenAndHuffmansExample": "published: Bohren & Huffman (1983), S11 at 21 angles",
        "MieSphere.AgreesWithWiscombesIntensities": "published: Wiscombe (1979), intensities and polarisation",
        "MieSphere.AgreesWithWiscombesAmplitudes": "published: MIEV0, complex amplitudes",
        "MieSphere.AgreesWithScattnlayToTenDigits": "published: scattnlay, relative",
        "DropletDistribution.HasItsEffectiveRadiusAndVariance": "definition (Hansen & Travis 1974)",
        "MieTable.TinyDropletsAreRayleigh": "closed form: Rayleigh's moments, absorption by mass",
        "MieTable.DeirmendjianC1IsAsPublished": "published: 300 moments of the C.1 cloud (I3RC)",
        "MieTable.AgreesWithShdomsTable": "SHDOM's make_mie_table, moments",
        "MieTable.WaterCloudAgreesWithRrtmg": "RRTMG's water cloud (a band, not one wavelength)",
        "RefractiveIndex.WaterAgreesWithHaleAndQuerry": "published: Hale & Querry (1973)",
    },
    "unit/optics/test_optics": {
        "Rayleigh.AgreesWithBodhaine": "published: Bodhaine et al. (1999), Rayleigh's optical depth",
        "SurfaceBrdf.RpvWithoutItsParametersIsLambert": "closed form: RPV with k 1, theta 0 is Lambertian",
        "SurfaceBrdf.RpvScattersBackWhereThetaIsNegative": "closed form of the RPV's phase term",
        "SurfaceBrdf.RossLiKernelsAreNoughtForSunAndSensorOverhead": "normalisation (Lucht, Schaaf & Strahler 2000)",
        "SurfaceBrdf.RossThickAtTheHotSpotIsClosed": "closed form at the hot spot",
        "SurfaceBrdf.GlintOverheadIsFresnelTimesSlopes": "closed form: Fresnel's reflectance times Cox & Munk's slopes",
        "SurfaceBrdf.NearlyFlatWaterReturnsFresnelsReflectance": "Fresnel's reflectance, without wind",
        "SurfaceBrdf.SunAndSensorMayChangePlaces": "reciprocity, all models",
        "ReflectionTable.ReturnsTheModelsAlbedoUnderTheQuadrature": "the model's directional albedo, all models, level and sloping",
    },
    "unit/reference/test_plane_parallel": {
        "PlaneParallel.AbsorbingSlabObeysBeer": "Beer's law",
        "PlaneParallel.ConservativeSlabLosesNothing": "energy",
        "PlaneParallel.DeepIsotropicSlabHasTheAlbedoOfChandrasekhar": "closed form: Chandrasekhar's H functions (1950)",
        "PlaneParallel.FurnaceHasTheSkysRadiance": "uniform sky over white ground: radiance is the sky's",
    },
}


def unit_tests(section):
    lines, missing = [], []
    for name, tests in UNIT_TESTS.items():
        program = self_built(section.options, name)
        section.tell(f"build/release/tests/{name}", "--gtest_output=json:FILE")
        with tempfile.TemporaryDirectory() as folder:
            output = Path(folder) / "tests.json"
            subprocess.run([program, f"--gtest_filter={':'.join(tests)}", f"--gtest_output=json:{output}"], check=False, stdout=subprocess.DEVNULL)
            suites = json.loads(output.read_text())["testsuites"]
        found = {f"{suite['name']}.{test['name']}": test for suite in suites for test in suite["testsuite"]}
        for test, truth in tests.items():
            if test not in found or "deviation" not in found[test]:
                missing.append(test)
                continue
            passed = "failures" not in found[test]
            lines.append([f"`{test}`", truth, number(float(found[test]["deviation"])), number(float(found[test]["tolerance"])), "yes" if passed else "**no**"])
    if missing:
        raise SystemExit(f"unit tests without figures: {', '.join(missing)} (include told_nearness.hpp)")
    return markdown_table(["test", "truth", "deviation", "allowed", "passed"], lines)


def self_built(options, name):
    program = options.tests / name
    if not program.exists():
        raise Skipped(f"{program} is not built")
    return program


SECTIONS = {"truths": truths, "plane-parallel": plane_parallel_section, "ordinates": ordinates, "voxels": voxels, "radiances": radiances, "clouds": clouds, "landsat": landsat, "made-fields": made,
            "step-radiances": step_radiances, "convergence": order, "symmetry": symmetries, "surfaces": ground, "unit-tests": unit_tests, "droplets": droplets}


# ---- the page -------------------------------------------------------------------------------------------------------


def blocks_of(page):
    """Text of the page between its markers, by section."""
    return {name: text for name, text in re.findall(r"<!-- begin ([\w-]+) -->\n(.*?)\n<!-- end \1 -->", page, re.DOTALL)}


def cpu_seconds():
    """Of this process and of those it started."""
    return sum(usage.ru_utime + usage.ru_stime for usage in map(resource.getrusage, (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)))


def seconds_of(block):
    match = re.search(r"\((\d+) CPU s\)", block)
    return int(match.group(1)) if match else 0


def make(name, options):
    """The block of a section, with the time it took; None if it cannot be made. The commands of its drivers are printed."""
    section = Section(options)
    print(f"{name} ...", file=sys.stderr, flush=True)
    start = cpu_seconds()
    try:
        with contextlib.redirect_stdout(io.StringIO() if not options.verbose else sys.stderr):
            text = SECTIONS[name](section)
    except Skipped as reason:
        print(f"{name}: left as it is: {reason}", file=sys.stderr)
        return None
    seconds = cpu_seconds() - start
    print(f"{name}: {seconds:.0f} CPU s", file=sys.stderr, flush=True)
    return f"{text.strip()}\n\nBy `scripts/validate --section {name}` ({seconds:.0f} CPU s)."


def write(blocks):
    """The template with its sections filled in; {{total}} is what all of them took."""
    template = TEMPLATE.read_text()
    named = set(re.findall(r"\{\{([\w-]+)\}\}", template)) - {"total"}
    assert named == set(SECTIONS), f"{TEMPLATE} has sections {named ^ set(SECTIONS)} too many or too few"
    for name in SECTIONS:
        block = blocks.get(name, "Not made yet.")
        template = template.replace(f"{{{{{name}}}}}", f"<!-- begin {name} -->\n{block}\n<!-- end {name} -->")
    total = sum(seconds_of(block) for block in blocks.values())
    PAGE.write_text(template.replace("{{total}}", f"{total / 60:.0f} minutes"))


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--section", nargs="+", default=None, metavar="NAME", help=f"{', '.join(SECTIONS)} (default: all)")
    parser.add_argument("--list", action="store_true", help="names the sections and ends")
    parser.add_argument("--prose", action="store_true", help="no section: the template around the sections that are there")
    parser.add_argument("--verbose", action="store_true", help="what the drivers print goes to stderr")
    parser.add_argument("--tests", type=Path, default=ROOT / "build/release/tests", metavar="FOLDER", help="where the build has the test programs")
    parser.set_defaults(threads=1)
    return parser


def main():
    options = arguments().parse_args()
    if options.list:
        print("\n".join(SECTIONS))
        return 0
    wanted = [] if options.prose else options.section or list(SECTIONS)
    unknown = set(wanted) - set(SECTIONS)
    if unknown:
        sys.exit(f"unknown section {', '.join(sorted(unknown))} (there are {', '.join(SECTIONS)})")
    blocks = blocks_of(PAGE.read_text()) if PAGE.exists() else {}
    for name in wanted:
        block = make(name, options)
        if block is not None:
            blocks[name] = block
        write(blocks)
    if options.prose:
        write(blocks)
    return 0


if __name__ == "__main__":
    sys.exit(main())
