#!/usr/bin/env python3
"""Time and memory that `cloudbow run --dry-run` predicts, beside those of the run. The scenes are made from configs/. The constants of the prediction
were fitted to some of them; the others test it.

The machine is calibrated first (`cloudbow verify --calibrate`), in a folder for caches of this program alone. Seconds are CPU seconds of the whole
program on one thread. They are the least of three runs if one takes less than ten seconds. Scenes with a gas model need
CLOUDBOW_REFERENCE_DIR and are left out without.

usage: predictions.py [NAME ...] [--set fitted|held-out]
"""
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "validation"))
import performance  # noqa: E402
import support  # noqa: E402

REPEATS = 3
SHORT_SECONDS = 10
TIME_WITHIN = (1 / 1.5, 1.5)
MEMORY_WITHIN = (0.85, 1.2)


@dataclass
class Case:
    name: str
    config: str
    settings: tuple  # of --set
    fitted: bool


ENDS = "output.flux_levels=boundaries"
ALONE = "output.error_estimate=false"
# The cumulus of configs/cumulus.toml in a domain of a quarter of its area: 7332 voxels.
SMALL = ("cloud.file={small}",)
LOW_SUN = "sun.zenith_deg=80"
# Air with gases beside the cloud; the optics of the droplets hold at all g-points.
GASES = ("output.fields=[\"fluxes\", \"absorption\"]", "spectrum.gas_model={gas}/ecckd-1.4_sw_climate_rgb-32b_ckd-definition.nc",
         "atmosphere.file={atmospheres}/afglms.txt", "atmosphere.ch4=1.8e-6", "atmosphere.n2o=3.2e-7")
LONGWAVE = ("spectrum.gas_model={gas}/ecckd-1.0_lw_climate_fsck-32b_ckd-definition.nc",
            "atmosphere={file = \"{atmospheres}/afglms.txt\", ch4 = 1.8e-6, n2o = 3.2e-7, cfc11 = 0, cfc12 = 0}")
IMAGE = ("radiance=[{name = \"satellite\", zenith_deg = 30, width = 200, height = 200}]",)
CAMERA = ("camera=[{name = \"ground\", position_m = [3200, 3200, 2], look_at_m = [3600, 3200, 900], width = 160, height = 120}]",)

FITTED = [
    ("draft", "cumulus", "solver.accuracy=draft"),
    ("ends", "cumulus", ENDS, ALONE),
    ("actinic", "cumulus", "solver.accuracy=draft", "output.fields=[\"fluxes\", \"actinic\"]", ALONE),
    ("thick", "cumulus", "cloud.scale=6", ENDS, *SMALL),
    ("small, reference", "cumulus", "solver.accuracy=reference", ENDS, ALONE, *SMALL),
    ("columns", "cumulus", "solver.mode=independent-columns"),
    ("camera", "cumulus", "solver.accuracy=draft", ENDS, ALONE, *CAMERA),
    ("sphere", "single_cloud_open"),
    ("sphere, fine", "single_cloud_open", "solver.accuracy=fine", ALONE),
    ("step", "step_cloud"),
    ("step, reference", "step_cloud", "solver.accuracy=reference"),
    ("deck", "stratocumulus"),
    ("deck, double", "stratocumulus", "solver.accuracy=draft", "cloud.scale=15", "solver.max_column_optical_depth=0"),
    ("slab, reference", "slab", "solver.mode=3d", "solver.accuracy=reference"),
    ("sea", "ocean"),
    ("thermal", "thermal_cumulus", "solver.accuracy=draft"),
    ("colours", "gallery/satellite", "radiance=[{name = \"satellite\", zenith_deg = 20, width = 256, height = 256}]"),
    ("sunlight", "cumulus", "solver.accuracy=draft", ALONE, *SMALL, *GASES),
    ("Mie", "mie_cumulus"),
    ("low sun", "cumulus", LOW_SUN, "solver.accuracy=draft", ALONE),
    ("small, fine", "cumulus", "solver.accuracy=fine", *SMALL),
    ("small, reference, low sun", "cumulus", "solver.accuracy=reference", LOW_SUN, *SMALL),
    ("small, open", "cumulus", "domain.boundary=open", *SMALL),
    ("deck, columns with slanted beam", "stratocumulus", "solver.mode=independent-diffuse"),
    ("small, columns by ordinates", "cumulus", "solver.mode=independent-columns", "output.fields=[\"fluxes\", \"radiance_field\"]", *SMALL),
    ("longwave", "thermal_cumulus", "solver.accuracy=draft", "thermal={}", "radiance=[]", "layer=[]", ALONE, *SMALL, *LONGWAVE),
    ("sunlight, columns", "cumulus", "solver.accuracy=draft", "spectrum.method=columns", *SMALL, *GASES),
]
HELD_OUT = [
    ("thick, draft", "cumulus", "solver.accuracy=draft", "cloud.scale=30", ALONE),
    ("thick, fine", "mixed_phase", "solver.accuracy=fine", "cloud.0.scale=5", ENDS, ALONE),
    ("float16", "stratocumulus", "solver.accuracy=draft", "solver.radiance_storage=float16"),
    ("deck, image", "stratocumulus", "solver.accuracy=draft", ENDS, ALONE, *IMAGE),
    ("ice", "mixed_phase"),
    ("ice, circumsolar", "mixed_phase", "solver.accuracy=draft", "output.circumsolar_deg=5"),
    ("ice, all directions", "mixed_phase", "solver.accuracy=draft", "output.fields=[\"fluxes\", \"radiance_field\"]", ALONE),
    ("sphere, reference", "single_cloud_open", "solver.accuracy=reference", ENDS, ALONE),
    ("step, fine", "step_cloud", "solver.accuracy=fine", LOW_SUN),
    ("layers, fine", "layers", "solver.mode=3d", "solver.accuracy=fine"),
    ("sea, draft", "ocean", "solver.accuracy=draft"),
    ("thermal deck", "thermal_stratocumulus", "solver.accuracy=draft"),
    ("aircraft", "gallery/aircraft", "camera.0.width=180", "camera.0.height=120"),
    ("Mie, open", "mie_cumulus", "solver.accuracy=draft", "domain.boundary=open", "sun.zenith_deg=20"),
    ("step, draft", "step_cloud", "solver.accuracy=draft", "output.fields=[\"fluxes\", \"actinic\"]"),
    ("sunset", "gallery/sunset", "camera.0.width=90", "camera.0.height=60", "camera.1.width=60", "camera.1.height=60"),
    ("ice, thick, open", "mixed_phase", "cloud.1.scale=8", "domain.boundary=open", ENDS),
    ("thermal, fine", "thermal_cumulus", "cloud.file={small}", "solver.accuracy=fine"),
    ("sphere, draft, low sun", "single_cloud_open", "solver.accuracy=draft", "sun.zenith_deg=85"),
]
CASES = [Case(name, config, tuple(settings), fitted) for fitted, cases in ((True, FITTED), (False, HELD_OUT)) for name, config, *settings in cases]


@dataclass
class Figures:
    seconds: float
    bytes: float


class Bench:
    def __init__(self, program, folder):
        self.program = performance.small_parent(Path(program).resolve(), folder)
        self.folder = folder
        self.small = folder / "small.vdb"
        subprocess.run([str(self.program), "cloud", "make", "cumulus", "--cells", "64", "64", "64", "--voxel-size-m", "50", "50", "25", "--cover", "0.2",
                        "--seed", "1", "-o", str(self.small)], check=True, capture_output=True)

    def command(self, case):
        """None if the case needs references that are not there."""
        references = support.reference_folder()
        command = [str(self.program), "run", str(support.ROOT / f"configs/{case.config}.toml"), "--threads", "1"]
        for setting in case.settings:
            setting = setting.replace("{small}", str(self.small))
            if "{gas}" in setting or "{atmospheres}" in setting:
                if references is None:
                    return None
                setting = setting.replace("{gas}", str(references / "gas")).replace("{atmospheres}", str(references / "atmospheres"))
            command += ["--set", setting]
        return command

    def predicted(self, command):
        done = subprocess.run([*command, "--dry-run"], capture_output=True, text=True, cwd=self.folder)
        if done.returncode != 0:
            raise support.Failure(f"{command}: exit code {done.returncode}\n{done.stderr}")
        gigabytes = float(re.search(r"memory\s+([\d.]+) GB predicted", done.stdout).group(1))
        return Figures(float(re.search(r"time\s+([\d.]+) s predicted", done.stdout).group(1)), 1e9 * gigabytes)

    def measured_once(self, command):
        with tempfile.TemporaryFile() as messages:
            child = subprocess.Popen([*command, "--quiet", "-o", "result.h5"], stdout=subprocess.DEVNULL, stderr=messages, cwd=self.folder)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = os.waitstatus_to_exitcode(status)
            messages.seek(0)
            text = messages.read().decode(errors="replace")
        if child.returncode not in (0, 3):  # 3: not converged
            raise support.Failure(f"{command}: exit code {child.returncode}\n{text}")
        return Figures(usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)

    def measured(self, command):
        """Tables of phase functions are made in the first of the runs."""
        runs = []
        while len(runs) < REPEATS and (not runs or runs[0].seconds < SHORT_SECONDS):
            runs.append(self.measured_once(command))
        return Figures(min(run.seconds for run in runs), min(run.bytes for run in runs))


def few_digits(value):
    return f"{value:.2g}" if value < 10 else f"{value:.0f}"


def within(ratio, limits):
    return limits[0] <= ratio <= limits[1]


def summary(rows):
    """How many ratios are within the limits, and the most different ones."""
    text = []
    for fitted, name in ((True, "fitted"), (False, "held out")):
        of = [row for row in rows if row[0].fitted == fitted]
        if not of:
            continue
        for what, limits, column in (("seconds", TIME_WITHIN, 1), ("memory", MEMORY_WITHIN, 2)):
            ratios = sorted(row[column] for row in of)
            inside = sum(within(ratio, limits) for ratio in ratios)
            text.append(f"{name}, {what}: {inside} of {len(ratios)} within {limits[0]:.2f} to {limits[1]:.2f}, least {ratios[0]:.2f}, largest {ratios[-1]:.2f}")
    return "\n".join(text)


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="scenes by name (default: all)")
    parser.add_argument("--set", choices=("fitted", "held-out"), help="those scenes alone")
    options = parser.parse_args()
    if unknown := set(options.names) - {case.name for case in CASES}:
        parser.error(f"no scene has the name {sorted(unknown)[0]!r} (allowed: {', '.join(case.name for case in CASES)})")
    if options.threads:
        parser.error("--threads: the scenes are solved on one thread")
    rows, lines = [], []
    with support.Workspace(options.keep) as folder:
        folder = folder.resolve()
        os.environ.setdefault("XDG_CACHE_HOME", str(folder))
        bench = Bench(options.cloudbow, folder)
        print(subprocess.run([str(bench.program), "verify", "--calibrate"], capture_output=True, text=True, check=True).stdout.strip(), flush=True)
        for case in CASES:
            if (options.names and case.name not in options.names) or (options.set and case.fitted != (options.set == "fitted")):
                continue
            command = bench.command(case)
            if command is None:
                continue
            predicted, measured = bench.predicted(command), bench.measured(command)
            rows.append((case, predicted.seconds / measured.seconds, predicted.bytes / measured.bytes))
            lines.append([case.name, f"`{case.config}`", "fitted" if case.fitted else "held out", few_digits(predicted.seconds), few_digits(measured.seconds),
                          f"{rows[-1][1]:.2f}", f"{predicted.bytes / 1e6:.0f}", f"{measured.bytes / 1e6:.0f}", f"{rows[-1][2]:.2f}"])
            print(" | ".join(lines[-1]), flush=True)
    table = support.markdown_table(["scene", "of `configs/`", "set", "s predicted", "s measured", "ratio", "MB predicted", "MB measured", "ratio"], lines)
    print(f"\n{table}\n{summary(rows)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
