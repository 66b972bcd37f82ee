#!/usr/bin/env python3
"""The cost of Monte Carlo that is as accurate as cloudbow: both on the same cells, in the same run, on one thread each.

Errors of cloudbow are against long Monte Carlo runs of known noise, which is taken out of the RMS over columns: the stored ones of
CLOUDBOW_REFERENCE_DIR for fluxes; for nadir images a run of --reference-photons here, by another seed than the timed one. Monte Carlo's own error
is its standard error, which falls with the root of the photons: from a run of --photons follows the CPU time it takes to the error that cloudbow
has. Both make what is compared and no more: fluxes at top and bottom, for the image also the image. CPU seconds are the least of REPEATS runs, by turns.

usage: CLOUDBOW_REFERENCE_DIR=... monte_carlo_cost.py [fluxes] [images] [--document docs/speed.md]
"""
import math
import os
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "validation"))
import intercomparison  # noqa: E402
import monte_carlo  # noqa: E402
import support  # noqa: E402
from monte_carlo_references import job  # noqa: E402

REPEATS = 3
ACCURACIES = ("draft", "balanced", "fine")
CASES = {"RICO, mu0 .5": intercomparison.CASES["rico"][0], "step cloud, mu0 1": intercomparison.CASES["step"][1]}
NADIR = (0.0, 0.0)


def scene(case, references, accuracy, image):
    text = intercomparison.scene(case, references / "fields", accuracy)
    text += support.scene_text([("output", {"flux_levels": "boundaries", "fields": ["fluxes"]})])
    return text + support.scene_text([("[radiance]", {"name": "nadir", "zenith_deg": NADIR[0], "azimuth_deg": NADIR[1]})]) if image else text


class Race:
    """Repeated runs of both programs on one case, by turns."""

    def __init__(self, case, references, cloudbow, options, folder, image):
        program = monte_carlo.MonteCarlo(options.monte_carlo)
        task = job(case, references / "fields", options, [NADIR] if image else [])
        self.results = {accuracy: [] for accuracy in ACCURACIES}
        solutions = []
        for _ in range(REPEATS):
            solutions.append(program.run(task, options.photons, seed=101))
            for accuracy in ACCURACIES:
                path = folder / "scene.toml"
                path.write_text(scene(case, references, accuracy, image))
                self.results[accuracy].append(cloudbow.run(path, folder / "result.h5", accept=(0, 3)))
        self.solution = solutions[0]
        self.monte_carlo_seconds = min(s.cpu_seconds for s in solutions)

    def seconds(self, accuracy):
        return min(result.cpu_seconds for result in self.results[accuracy])

    def row(self, name, accuracy, error, monte_carlo_error):
        """Both errors in the same unit, %."""
        factor = (monte_carlo_error / error) ** 2 if error > 0 else math.inf
        seconds = factor * self.monte_carlo_seconds
        return [name, accuracy, f"{error:.3f}" if "mean" in name else f"{error:.2f}", f"{self.seconds(accuracy):.2f}",
                f"{factor * self.solution.photons:.1e}", f"{seconds:.2g}" if seconds < 10 else f"{seconds:.0f}",
                f"{float(f'{seconds / self.seconds(accuracy):.2g}'):g}"]


def noise_percent(plane):
    return 100 * math.sqrt(np.mean(plane.error**2)) / plane.mean


def fluxes(references, cloudbow, options, folder):
    rows = []
    for name, case in CASES.items():
        race = Race(case, references, cloudbow, options, folder, image=False)
        reference = intercomparison.read_reference(references / case.reference)
        up, down = race.solution.up[1], race.solution.down[0]
        report(name, race, up, reference.up, reference.up_error)
        found = {accuracy: intercomparison.compare(case, race.results[accuracy][0], reference) for accuracy in ACCURACIES}
        for accuracy in ACCURACIES:
            error = max(found[accuracy]["domain"], found[accuracy]["domain_noise"])
            rows.append(race.row(f"{name}: domain means", accuracy, error, 100 * max(up.mean_error, down.mean_error)))
        for key, plane in (("up", up), ("down", down)):
            rows += [race.row(f"{name}: columns {key}", accuracy, found[accuracy][key], noise_percent(plane)) for accuracy in ACCURACIES]
    return rows


def images(references, cloudbow, options, folder):
    rows = []
    for name, case in CASES.items():
        race = Race(case, references, cloudbow, options, folder, image=True)
        truth = monte_carlo.MonteCarlo(options.monte_carlo).run(job(case, references / "fields", options, [NADIR]), options.reference_photons, seed=202).radiance[0]
        image = race.solution.radiance[0]
        report(name, race, image, truth.value, truth.error)
        print(f"{name}: noise of the reference image {noise_percent(truth):.2f} %", file=sys.stderr)
        for accuracy in ACCURACIES:
            error = support.rms_percent(race.results[accuracy][0]["radiance_nadir"], truth.value, truth.error)
            rows.append(race.row(f"{name}: nadir image", accuracy, error, noise_percent(image)))
    return rows


def report(name, race, plane, reference, reference_error):
    found = monte_carlo.chi(plane.value - reference, np.hypot(plane.error, reference_error))
    print(f"{name}: Monte Carlo of {race.solution.photons:.1e} photons, {race.monte_carlo_seconds:.1f} CPU s; noise of a column {noise_percent(plane):.2f} %, "
          f"RMS difference to the reference {found:.2f} standard errors", file=sys.stderr, flush=True)


TABLES = {"fluxes": fluxes, "images": images}


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("tables", nargs="*", metavar="TABLE", help="fluxes, images (default: both)")
    parser.add_argument("--photons", type=float, default=1e6)
    parser.add_argument("--reference-photons", type=float, default=1.5e7)
    parser.add_argument("--document", type=Path, help="write the tables between the markers monte-carlo-fluxes and monte-carlo-images")
    monte_carlo.add_programs(parser)
    options = parser.parse_args()
    references = support.reference_folder()
    if references is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with fields/ and montecarlo/")
    if options.threads:
        parser.error("--threads: both programs are timed on one thread")
    with support.Workspace(options.keep) as folder:
        os.environ["XDG_CACHE_HOME"] = str(folder.resolve())  # tables are made in the first run of each kind
        cloudbow = support.Cloudbow(options.cloudbow, threads=1)
        for name in options.tables or TABLES:
            rows = TABLES[name](references, cloudbow, options, folder)
            text = support.markdown_table(["scene and quantity", "cloudbow", "error %", "CPU s", "Monte Carlo: photons to the same error", "CPU s",
                                           "times the cost"], rows)
            print(text, flush=True)
            if options.document:
                support.write_between_markers(options.document, f"monte-carlo-{name}", text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
