#!/usr/bin/env python3
"""Small inputs that were handed to the project, each with one property of files by others: every one is read right, or refused with a way out.

They lie in the folder `cases` beside that of reference data (CLOUDBOW_REFERENCE_DIR; skipped without them); its README says what is right. The
truths here are from there, or follow from the files. Prints a table: file, wanted, found. No run may end by a signal or outlast its time, and none
has more than 3.5 GB of addresses.

usage: handed_cases.py --cloudbow PROGRAM [--only TEXT]
"""
import math
import re
import resource
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import support
from support import Failure, Result, scene_text

ADDRESSES = 3500000 * 1024  # bytes
SECONDS = 60  # of any run; the longest takes less than 2

# The cumulus of all models: mean liquid water path of the cloudy columns [g/m2] and largest content [g/m3]; six digits are printed.
CUMULUS = {"LWP": (107.487, 0.01), "largest": (1.019, 0.001), "voxels": (144, 0)}
US_1976 = {"LWP": (112.183, 0.01), "largest": (1.064, 0.001), "voxels": (144, 0)}  # the cumulus in 4 % denser air
CONTROL = {"LWP": (30, 1e-3), "largest": (1, 1e-6), "voxels": (3, 0)}  # 4 cells of 1 g/m3 and 20 m, one of them missing
CELLS = ["--voxel-size-m", "50", "50", "20"]
COLUMNS = ["--voxel-size-m", "100", "100", "40"]
AIR = ["--air-density", "us-1976"]
NO_DENSITY = ("needs the air's density", "--air-density", "us-1976")
MISSING = ("NaN or missing", "--fill clear")
BACKGROUND = ("the background is 0.001", "set [domain] min_m and max_m", "[-10, -10, -10]", "[310, 310, 310]")
DOMAIN = ["--set", "domain.min_m=[-50,-50,-50]", "--set", "domain.max_m=[350,350,350]"]
NEGATIVE = ("negative", "degrees", "2l+1")
SCALED = ("the table's integral is off by +0.20 %",)
ELSEWHERE = {"direct": (0.534167, 1e-6)}  # the one cloud of vdb/, whichever way its axes point: the file without any peculiarity gives this
# A layer of optical depth 1 that scatters all, by Henyey-Greenstein's function of .85; tables of one degree have .2 % too much in the peak.
LAYER = {"reflectance": (0.16456, 3e-4)}
NO_SCATTERING = [("cloud", {"single_scattering_albedo": 0.0, "phase_function": "isotropic"}),
                 ("sun", {"zenith_deg": 0.0, "azimuth_deg": 0.0}),
                 ("solver", {"accuracy": "draft"}), ("output", {"error_estimate": False})]
LAYER_SCENE = [("[layer]", {"bottom_m": 0.0, "top_m": 100.0, "optical_depth": 1.0, "single_scattering_albedo": 1.0, "phase_function": "p"}),
               ("sun", {"zenith_deg": 60.0, "azimuth_deg": 0.0}),
               ("solver", {"accuracy": "draft"}), ("output", {"error_estimate": False})]


class Case(NamedTuple):
    """A run on a file. With figures it is read (name: value, tolerance), without it is refused (exit code 2); the words are said."""
    file: str
    arguments: list
    figures: dict = {}
    words: tuple = ()
    note: str = ""
    scene: list = []  # made from these tables


def imported(file, figures, *options, words=(), note=""):
    return Case(f"import/{file}", ["cloud", "import", "{file}", "-o", "{out}", *options], figures, words, note)


def refused(file, words, *options, note=""):
    return imported(file, {}, *options, words=words, note=note)


def absorbing(file, figures, *options, words=()):
    return Case(f"vdb/{file}", ["run", "{scene}", "-o", "{out}", "--set", "cloud.file={file}", *options], figures, words, scene=NO_SCATTERING)


def albedo(file, south, north=None):
    """Under next to no cloud, with the sun overhead: the ground's albedo in the southern and the northern half."""
    figures = {"albedo in the south": (south, 1e-4), "albedo in the north": (south if north is None else north, 1e-4)}
    options = {"surface.albedo_map": "{file}", "cloud.file": "{cases}/robust/cloud.vdb", "cloud.scale": 1e-6, "sun.zenith_deg": 0,
               "output.error_estimate": "false"}
    settings = [word for key, value in options.items() for word in ("--set", f"{key}={value}")]
    return Case(f"albedo/{file}", ["run", "{cases}/albedo/alb.toml", "-o", "{out}", *settings], figures, note="cloud of robust/, its own is not there")


def scene_of(file, figures, *options, words=(), note=""):
    return Case(file, ["run", "{file}", "-o", "{out}", "--quiet", *options], figures, words, note)


def function(file, kind, figures, words=(), **keys):
    scene = [*LAYER_SCENE, ("phase_function.p", {"type": kind, "file": "{file}", **keys})]
    return Case(f"optics/{file}", ["run", "{scene}", "-o", "{out}"], figures, words, scene=scene)


CASES = [
    # The file's T is theta - 292 K and not theta - 300 K, as WRF's is: air that is 8 K warmer, and 2.6 % lighter.
    imported("wrfout.nc", {"LWP": (104.712, 0.01), "largest": (0.993, 0.001), "voxels": (144, 0)}, words=("300 K",),
             note="its T is theta - 292 K: by WRF's rule 2.6 % less than the cumulus"),
    imported("f1_wrf.nc", {"largest": (1.0213, 1e-3)}, *CELLS, words=("300 K",)),
    refused("f1_celsius.nc", ("15 K", "150 to 350 K", "degC"), *CELLS),
    imported("celsius.nc", CUMULUS),
    imported("icon.nc", CUMULUS, words=("in degrees at the mean latitude", "model: ICON")),
    imported("icon.nc", CUMULUS, *COLUMNS, words=("the file's last the lowest", "in place of 'z_mc'")),
    imported("cm1.nc", CUMULUS, words=("'th' is the potential temperature",)),
    imported("mesonh.nc", CUMULUS, words=("RHODREF",)),
    refused("badz.nc", ("coordinates count cells", "--voxel-size-m")),
    imported("badz.nc", {"LWP": (108.638, 0.01), "largest": (1.0302, 1e-3), "thickness": (40, 0)}, *COLUMNS,
             words=("in place of 'z'",), note="holds g/m3, in air of 1.1 kg/m3"),
    imported("zunit00.nc", CUMULUS),
    imported("zunit05.nc", CUMULUS),
    *[refused(f"{name}.nc", NO_DENSITY) for name in ("microhh_ql", "dales_fielddump", "oceananigans")],
    *[imported(f"{name}.nc", US_1976, *AIR, words=("U.S. Standard Atmosphere 1976",)) for name in ("microhh_ql", "dales_fielddump", "oceananigans")],
    imported("dales_old_fielddump.nc", {"LWP": (107.528, 0.01), "largest": (1.023, 0.001), "voxels": (144, 0)},
             words=("rhobf",), note="by the file's own density of the base state"),
    refused("palm_3d.nc", MISSING),
    refused("palm_3d.nc", (*NO_DENSITY, "--profile FILE"), "--fill", "clear", note="its p is a perturbation"),
    imported("palm_3d.nc", US_1976, "--fill", "clear", *AIR, words=("4 cells are missing", "U.S. Standard Atmosphere 1976")),
    refused("packed.nc", ("-7.728352e-06", "packed integers"), note="four values wrapped round in 16 bits (33000 stored as -32536)"),
    imported("species.nc", CUMULUS, words=("NOT imported: 'qi', cloud ice", "NOT imported: 'qr', rain")),
    imported("species.nc", CUMULUS, "--species", "liquid,ice,rain", words=('grid "ice_water_content"', 'grid "rain_water_content"')),
    imported("species.nc", {"largest": (0.3058, 1e-3)}, "--variable", "qi", words=("'qi' is cloud ice",), note="ice: .3 of the water"),
    refused("qlqc.nc", ("'qc' and 'ql'", "--variable")),
    imported("qlqc.nc", CUMULUS, "--variable", "qc"),
    imported("f2_sam.nc", {"largest": (0.1, 1e-6)}, *CELLS, words=("'QN' less 'QI'", "NOT imported: 'QI', cloud ice")),
    *[refused(f"f3_{name}.nc", MISSING, *CELLS) for name in ("float", "double", "text", "range", "max")],
    *[imported(f"f3_{name}.nc", CONTROL, *CELLS, "--fill", "clear", words=("1 cells are missing",))
      for name in ("float", "double", "text", "range", "max")],
    imported("ext.nc", {"optical depth": (4.9381, 1e-3), "largest": (0.046825, 1e-5), "voxels": (144, 0)},
             words=("extinction", "reff", "ssa")),
    refused("ext.npy", ("NumPy", "--voxel-size-m")),
    imported("ext.npy", {"largest": (9.36508e-4, 1e-8), "voxels": (144, 0)}, *COLUMNS, words=("GUESSED quantity: extinction in 1/m",)),
    # Cells of .5 and .3 g/m3, 40 and 100 m thick, with radii of 10 and 8 um.
    imported("at3d.csv", {"LWP": (16, 1e-4), "largest": (0.5, 1e-6), "thickness": (40, 0), "largest radius": (10, 1e-5)}),
    imported("mystic_wc3d.dat", {"LWP": (40, 1e-4), "largest": (0.5, 1e-6), "thickness": (100, 0), "largest radius": (10, 1e-5)}),
    *[imported(f"{name}", CUMULUS) for name in ("sam.nc", "uclales.nc", "cfname.nc", "plain.h5")],
    refused("monc.nc", ("'x'", "--voxel-size-m")),
    imported("monc.nc", CUMULUS, "--voxel-size-m", "100"),

    absorbing("f4_background.vdb", {"direct": (0.66633, 1e-5)}, "--set", "cloud.quantity=extinction"),  # (15 e^-.4 + e^-.5) / 16
    absorbing("background.vdb", {}, words=BACKGROUND),
    # The one cloud, 144 columns of 240 m, in 256 columns of 320 m without background, in 400 columns of 400 m: .001 per m in what is around.
    absorbing("background.vdb", {"direct": (((0.534167 * 144 + 112) * math.exp(-0.08) + 144 * math.exp(-0.4)) / 400, 1e-6)}, *DOMAIN),
    absorbing("rot90.vdb", ELSEWHERE),
    absorbing("tiny_negative.vdb", ELSEWHERE, words=("2 negative values down to -1e-07 count as 0",)),
    absorbing("levelset.vdb", {}, "--set", "cloud.grid=ls_sphere", words=("level set", "fog volume", "ls2fog")),
    absorbing("reff_coarse.vdb", {}, "--set", "cloud.phase_function=p", "--set", "phase_function.p.type=mie", "--set", "cloud.effective_radius_grid=reff",
              "--set", "phase_function.p.file={cases}/optics/mie_three.cdf", words=("its voxels are not those of the cloud", "resample")),
    absorbing("twins.vdb", {}, words=("several have this name", '"density[0]", "density[1]"')),
    absorbing("twins.vdb", ELSEWHERE, "--set", 'cloud.grid="density[0]"'),
    absorbing("stray.vdb", {}, words=("a few voxels far away", "(4000, 4000, 100)", "clip", "needs more memory")),

    *[albedo(f"{name}.png", 0.502) for name in ("alb8", "alb16", "alb8_gamma1")],
    albedo("alb_nc4.nc", 0.1, 0.8),
    albedo("alb_nc3.nc", 0.1, 0.8),
    albedo("alb_time.nc", 0.3),
    albedo("alb_packed.nc", 0.3),
    albedo("alb_packed01.nc", 0.004),

    scene_of("optics/f5_good_thin.toml", {"radiance": (0.00361, 1e-4)}, note="Rayleigh's function"),
    *[scene_of(f"optics/f5_{name}.toml", {}, words=NEGATIVE) for name in ("rayleigh", "bad_thin", "negative")],
    function("mom_2l1.txt", "legendre", {}, words=("moment 1 is 2.55", "without the factor 2l+1")),
    function("mom_onecol.txt", "legendre", LAYER),
    function("tab_coarse.txt", "table", {}, words=("1.18224", "to 1 %", "more angles")),
    *[function(f"tab_{name}.txt", "table", LAYER, words=SCALED) for name in ("csv", "bang", "D")],
    function("tab_4pi.txt", "table", LAYER, words=("integral 1 over the sphere", *SCALED)),
    function("tab_rad.txt", "table", LAYER, words=("in radians", *SCALED)),
    function("mie_single.cdf", "mie", LAYER, effective_radius_um=10.1),
    function("mie_three.cdf", "mie", LAYER, effective_radius_um=12.0),

    scene_of("robust/cloud.toml", {"direct": (0.046294, 1e-6)}, note="the scene of the next ones, with the sun at 60 degrees"),
    *[scene_of(f"robust/{name}.toml", {}, words=("nested too deeply",)) for name in ("deepkey", "deepkey2")],
    *[scene_of(f"robust/{name}.toml", {}, "--resume", f"{{cases}}/robust/{checkpoint}.h5", words=(f"{checkpoint}.h5", *words),
               note=f"--resume {checkpoint}.h5")
      for name, checkpoint, words in (("ck15", "checkpoint_self", ("virtual dataset",)), ("ck15", "checkpoint_attr", ("attribute source",)),
                                      ("ck_crash", "ck_crash", ("another version",)))],
    *[scene_of(f"robust/{name}.toml", {}, words=("a ray crosses too many cells", "independent-columns")) for name in ("low_sun", "thin_voxels")],
]
# Of how well and how fast the solver converges, which other drivers judge.
NOT_RUN = [("solver/cum21.toml", "whether the iteration with `actinic` converges"), ("solver/cum22.toml", "whether the iteration with `actinic` converges"),
           ("solver/cu7.toml", "sweeps that `reference` needs"), ("solver/cu7_air.toml", "what a layer of optical depth 1e-9 changes")]


def figures_of_cloud(text):
    """Numbers that `cloud info` prints of the grid "density", and the largest of a grid "reff"."""
    density = text.split('grid "density"')[1].split('\ngrid "')[0]
    patterns = {"LWP": r"cloudy columns +liquid water path .*?mean ([^ ,\n]+)", "largest": r"value .*max (\S+)",
                "voxels": r"active voxels +(\d+)", "thickness": r"cells .* x (\S+) m", "optical depth": r"cloudy columns +optical depth: .*?mean ([^ ,\n]+)"}
    found = {name: re.search(pattern, density) for name, pattern in patterns.items()}
    found["largest radius"] = re.search(r"value .*max (\S+)", text.split('grid "reff"')[-1])
    return {name: float(match[1]) for name, match in found.items() if match}


def figures_of_result(path):
    result = Result(path, 0, 0, 0)
    ground = result["upwelling_flux"][0] / (result["downwelling_diffuse_flux"][0] + result["direct_flux"][0])
    figures = {"reflectance": result.summary["reflectance"], "direct": result.summary["transmittance_direct"],
               "albedo in the south": ground[0].mean(), "albedo in the north": ground[-1].mean()}
    return {**figures, "radiance": float(result["radiance_v"].mean())} if "radiance_v" in result.fields else figures


def run(program, *arguments):
    def limits():
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    try:
        done = subprocess.run([program, *arguments], capture_output=True, text=True, errors="replace", timeout=SECONDS, preexec_fn=limits)
    except subprocess.TimeoutExpired:
        raise Failure(f"not done after {SECONDS} s") from None
    if done.returncode < 0:
        raise Failure(f"ended by signal {-done.returncode}")
    return done


def found_in(program, case, cases, folder):
    """The outcome of the run of a case, in words; Failure with the same if it is not as wanted."""
    out = folder / ("out.vdb" if case.arguments[0] == "cloud" else "out.h5")
    out.unlink(missing_ok=True)
    names = {"{file}": str(cases / case.file), "{out}": str(out), "{scene}": str(folder / "scene.toml"), "{cases}": str(cases)}

    def filled(text):
        for name, value in names.items():
            text = text.replace(name, value)
        return text

    if case.scene:
        (folder / "scene.toml").write_text(filled(scene_text(case.scene)))
    done = run(program, *map(filled, case.arguments))
    said = done.stdout + done.stderr
    errors = [line for line in done.stderr.splitlines() if line.startswith("cloudbow: ") and not line.startswith("cloudbow: note: ")]
    last = errors[-1].replace(f"{cases}/", "") if errors else ""
    if done.returncode != (0 if case.figures else 2):
        raise Failure(f"exit code {done.returncode}: {last}")
    missing = [words for words in case.words if words not in said]
    if missing:
        raise Failure(f"not said: {', '.join(missing)}; {last}")
    if not case.figures:
        if len(errors) != 1 or out.exists():
            raise Failure(f"{len(errors)} messages, {'a' if out.exists() else 'no'} result: {last}")
        return last.removeprefix("cloudbow: ")
    figures = figures_of_cloud(run(program, "cloud", "info", str(out)).stdout) if out.suffix == ".vdb" else figures_of_result(out)
    shown = ", ".join(f"{name} {figures.get(name, float('nan')):.6g}" for name in case.figures)
    if not all(abs(figures.get(name, float("nan")) - value) <= tolerance for name, (value, tolerance) in case.figures.items()):
        raise Failure(shown)
    return shown


def row(file, wanted, found):
    print(f"{file:29}  {wanted:45}  {found}", flush=True)


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--only", default="", metavar="TEXT", help="cases whose file has this in its name")
    options = parser.parse_args()
    reference = support.reference_folder()
    cases = reference.resolve().parent / "cases" if reference else None
    if not cases or not cases.is_dir():
        support.skip("no folder `cases` beside the one that CLOUDBOW_REFERENCE_DIR names")
    program, failed = str(Path(options.cloudbow).resolve()), 0
    row("file", "wanted", "found")
    chosen = [case for case in CASES if options.only in case.file]
    named = " ".join([word for case in CASES for word in (case.file, *case.arguments)])
    forgotten = [path for path in sorted(cases.glob("[!s]*/*")) if path.name not in named]  # of all folders but solver/
    with support.Workspace(options.keep) as folder:
        for case in chosen:
            wanted = ", ".join(f"{name} {value:.6g}" for name, (value, _) in case.figures.items()) or "refused"
            try:
                verdict, found = "ok", found_in(program, case, cases, folder)
            except Failure as failure:
                verdict, found = "FAIL", str(failure)
                failed += 1
            row(case.file, f"{wanted} ({case.note})" if case.note else wanted, f"{verdict:4}  {found}")
    for file, reason in NOT_RUN:
        row(file, reason, "not run here")
    for path in forgotten:
        row(str(path.relative_to(cases)), "a case of this driver", "FAIL  none")
    print(f"{len(chosen) - failed} of {len(chosen)} as wanted")
    return 1 if failed or forgotten else 0


if __name__ == "__main__":
    sys.exit(main())
