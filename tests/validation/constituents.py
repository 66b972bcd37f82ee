#!/usr/bin/env python3
"""Liquid and ice in the same voxels.

Truths: a plane-parallel mixture by hand, moment by moment. It is solved by the program itself and by adding and doubling. A step cloud with ice is
solved by the Monte Carlo of tests/reference, with both media: column fluxes agree within its noise.

usage: constituents.py --cloudbow PROGRAM [slab] [step] [--photons 1e6]
"""
import json
import math
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np

import monte_carlo
import support

LIQUID = {"single_scattering_albedo": 0.999, "asymmetry_parameter": 0.85}
ICE = {"single_scattering_albedo": 0.93, "asymmetry_parameter": 0.75}
ALBEDO, ZENITH_DEG = 0.2, 60.0
SLAB_M, SLAB_VOXELS, LIQUID_DEPTH, ICE_DEPTH = 500.0, 20, 8.0, 3.0
DEGREES = 400  # of the mixture's moments: .85^400 is 6e-29
# Of incident flux. Adding and doubling against columns solved without azimuths at balanced; their own error is .03 % (docs/validation.md).
MIXTURE_LIMIT, DOUBLING_LIMIT = 0.01, 0.05
# Means of the domain, in per cent of the incident flux: .05 of noise. Columns in standard errors of the Monte Carlo, and as RMS over their mean without
# its noise. With 1e7 photons these are .5 % for the fluxes and .3 % for absorption; of the liquid alone .4 to .7 and .3 %.
DOMAIN_LIMIT, NOISE_LIMIT, COLUMNS_LIMIT = 0.15, 1.5, 0.8


def write_cloud(cloudbow, path, extinction, size_m):
    """A VDB file with these extinctions [z, y, x]; clear cells of the box are written too, so that it begins and ends as the field does."""
    text = path.with_suffix(".txt")
    text.write_text("".join(f"{i} {j} {k} {value:.9g}\n" for (k, j, i), value in np.ndenumerate(extinction) if value > 0))
    cloudbow.call("cloud", "import", text, "--format", "columns", "--quantity", "extinction", "--voxel-size-m", *size_m, "-o", path, "--quiet")


def constituent(name, file, optics):
    return [("[cloud]", {"name": name, "file": str(file), "single_scattering_albedo": optics["single_scattering_albedo"], "phase_function": f"of_{name}"}),
            (f"phase_function.of_{name}", {"type": "henyey-greenstein", "asymmetry_parameter": optics["asymmetry_parameter"]})]


def rest(**solver):
    return [("sun", {"zenith_deg": ZENITH_DEG, "azimuth_deg": 180.0, "irradiance_w_m2": 1 / math.cos(math.radians(ZENITH_DEG))}),
            ("surface", {"albedo": ALBEDO}), ("solver", solver), ("output", {"fields": ["fluxes", "absorption", "optical_depth"], "flux_levels": "boundaries"})]


def solve(cloudbow, folder, name, tables):
    scene = folder / f"{name}.toml"
    scene.write_text(support.scene_text(tables))
    return cloudbow.run(scene, folder / f"{name}.h5")


def ends(result):
    """Up at the top, down at the bottom and absorbed, of an incident flux of 1."""
    return np.array([result.upward_at_top().mean(), result.downward_at_bottom().mean(), result.summary["absorptance"]])


def slab(cloudbow, folder, options):
    size_m = (100.0, 100.0, SLAB_M / SLAB_VOXELS)
    for name, depth in (("liquid", LIQUID_DEPTH), ("ice", ICE_DEPTH), ("mixture", LIQUID_DEPTH + ICE_DEPTH)):
        write_cloud(cloudbow, folder / f"{name}.vdb", np.full((SLAB_VOXELS, 1, 1), depth / SLAB_M), size_m)
    scattering = [depth * optics["single_scattering_albedo"] for depth, optics in ((LIQUID_DEPTH, LIQUID), (ICE_DEPTH, ICE))]
    degrees = np.arange(DEGREES + 1)
    moments = sum(s * optics["asymmetry_parameter"]**degrees for s, optics in zip(scattering, (LIQUID, ICE))) / sum(scattering)
    albedo = sum(scattering) / (LIQUID_DEPTH + ICE_DEPTH)
    (folder / "moments.txt").write_text("".join(f"{l} {chi!r}\n" for l, chi in zip(degrees, map(float, moments))))
    mixture = [("cloud", {"file": str(folder / "mixture.vdb"), "single_scattering_albedo": albedo, "phase_function": "mixture"}),
               ("phase_function.mixture", {"type": "legendre", "file": str(folder / "moments.txt")})]
    both = constituent("liquid", folder / "liquid.vdb", LIQUID) + constituent("ice", folder / "ice.vdb", ICE)
    done = subprocess.run([options.plane_parallel, "sun", str(math.cos(math.radians(ZENITH_DEG))), "irradiance", str(1 / math.cos(math.radians(ZENITH_DEG))),
                           "surface_albedo", str(ALBEDO), "layer", str(LIQUID_DEPTH + ICE_DEPTH), repr(float(albedo)), "legendre", str(folder / "moments.txt")],
                          capture_output=True, text=True, check=True)
    top, *_, bottom = json.loads(done.stdout)["cases"][0]["results"]["levels"]
    truth = np.array([top["flux_up"], bottom["flux_down_diffuse"] + bottom["flux_down_direct"]])
    faults = []
    for name, solver in (("columns", {"mode": "independent-columns"}), ("ordinates", {}), ("ordinates, fine", {"accuracy": "fine"})):
        of_both = ends(solve(cloudbow, folder, "both", both + rest(**solver)))
        of_mixture = ends(solve(cloudbow, folder, "one", mixture + rest(**solver)))
        difference = 100 * np.abs(of_both - of_mixture).max()
        from_truth = 100 * np.abs(of_both[:2] - truth).max()
        print(f"slab, {name}: {difference:.5f} % from the mixture, {from_truth:.3f} % from adding and doubling")
        if difference > MIXTURE_LIMIT:
            faults.append(f"slab, {name}: {difference:.4f} % from the mixture, allowed {MIXTURE_LIMIT}")
        if name == "columns" and from_truth > DOUBLING_LIMIT:
            faults.append(f"slab, {name}: {from_truth:.4f} % from adding and doubling, allowed {DOUBLING_LIMIT}")
    with h5py.File(folder / "both.h5") as file:
        found = {name: support.plain(value) for name, value in file["cloud"].attrs.items()}
        depth = float(file["optical_depth"][...].item())
    if found["constituents"] != "liquid, ice" or not np.allclose([found["optical_depth_liquid"], found["optical_depth_ice"], depth],
                                                                [LIQUID_DEPTH, ICE_DEPTH, LIQUID_DEPTH + ICE_DEPTH], rtol=1e-6):
        faults.append(f"slab: the result has {found} and an optical depth of {depth}")
    emission = [("atmosphere", {"height_m": [0.0, 1000.0], "temperature_k": [290.0, 280.0], "standard": "us-1976"}), ("thermal", {"wavelength_um": 10.8}),
                ("surface", {"albedo": ALBEDO, "temperature_k": 295.0}), ("output", {"fields": ["fluxes"], "flux_levels": "boundaries"})]
    of_both, of_mixture = (solve(cloudbow, folder, "emission", tables + emission) for tables in (both, mixture))
    difference = 100 * max(abs(of_both.upward_at_top() / of_mixture.upward_at_top() - 1).max(), abs(of_both.downward_at_bottom() / of_mixture.downward_at_bottom() - 1).max())
    print(f"slab that emits: {difference:.5f} % from the mixture")
    if difference > MIXTURE_LIMIT:
        faults.append(f"slab that emits: {difference:.4f} % from the mixture, allowed {MIXTURE_LIMIT}")
    return faults


def step(cloudbow, folder, options):
    """The step cloud with ice in its upper half, in waves along x of twice its period: nothing is proportional to the liquid."""
    liquid_file = support.ROOT / "clouds" / "step.vdb"
    liquid, size, bottom = monte_carlo.cloud_cells(options.cloud_cells, liquid_file)
    nz, ny, nx = liquid.shape
    ice = np.zeros_like(liquid)
    ice[nz // 2:] = 0.02 * np.maximum(0, np.sin(4 * np.pi * (np.arange(nx) + 0.5) / nx))
    write_cloud(cloudbow, folder / "veil.vdb", ice, size)
    tables = constituent("liquid", liquid_file, LIQUID) + constituent("ice", folder / "veil.vdb", ICE)
    result = solve(cloudbow, folder, "step", tables + rest(accuracy="fine"))
    media = [(optics["single_scattering_albedo"], monte_carlo.henyey_greenstein(optics["asymmetry_parameter"]), cells) for optics, cells in ((LIQUID, liquid), (ICE, ice))]
    job = monte_carlo.Job(bottom + size[2] * np.arange(nz + 1), (nx, ny), size[:2], media, (ZENITH_DEG, 180.0), ALBEDO, levels=[0, nz], absorption=True)
    truth = monte_carlo.MonteCarlo(options.monte_carlo, threads=2).run(job, options.photons, seed=11)
    faults = []
    absorbed = truth.absorbed
    of_columns = sum(plane.value for plane in absorbed)
    error = np.sqrt(sum(plane.error**2 for plane in absorbed))
    own = (result["absorbed_power"] * np.diff(result.z_edge)[:, None, None]).sum(axis=0)
    rows = [("up at the top", result.upward_at_top(), truth.up[1].value, truth.up[1].error), ("down at the bottom", result.downward_at_bottom(), truth.down[0].value, truth.down[0].error),
            ("absorbed", own, of_columns, error)]
    for name, value, reference, noise in rows:
        domain, strayed = 100 * abs(value.mean() - reference.mean()), monte_carlo.chi(value - reference, noise)
        columns = support.rms_percent(value, reference, noise)
        print(f"step, {name}: domain {domain:.3f} % of incident, columns {strayed:.2f} standard errors of {100 * np.sqrt(np.mean(noise**2)) / reference.mean():.2f} %, "
              f"{columns:.2f} % without them")
        for what, found, allowed in (("domain [%]", domain, DOMAIN_LIMIT), ("columns [standard errors]", strayed, NOISE_LIMIT), ("columns [%]", columns, COLUMNS_LIMIT)):
            if found > allowed:
                faults.append(f"step, {name}: {what} {found:.3f}, allowed {allowed}")
    return faults


def main():
    parser = support.argument_parser(__doc__)
    monte_carlo.add_programs(parser)
    parser.add_argument("parts", nargs="*", choices=[[], "slab", "step"])
    parser.add_argument("--plane-parallel", type=Path, default=support.ROOT / "build/release/tests/reference/plane_parallel", metavar="PROGRAM")
    parser.add_argument("--photons", type=float, default=1e6)
    options = parser.parse_args()
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    faults = []
    with support.Workspace(options.keep) as folder:
        for name, part in (("slab", slab), ("step", step)):
            if not options.parts or name in options.parts:
                faults += part(cloudbow, folder, options)
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
