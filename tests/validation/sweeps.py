#!/usr/bin/env python3
"""The sweeps that an iteration takes: prints what docs/speed.md summarises.

usage: CLOUDBOW_REFERENCE_DIR=... sweeps.py
"""
import sys

import intercomparison
import support

SLAB_OPTICAL_DEPTHS = (1, 10, 100, 1000)
SLAB_ALBEDOS = (1.0, 0.99)
SWEEP_TOLERANCE = 1e-4


def slab_sweeps(optical_depth, albedo, cloudbow, folder):
    """Sweeps for a slab of 4 x 4 x 40 voxels, in 3D: thin voxels and thick ones, as a cloud has them."""
    name = f"slab_{optical_depth}_{albedo}"
    cloud = folder / f"slab_{optical_depth}.vdb"
    cloudbow.call("cloud", "make", "slab", "--cells", 4, 4, 40, "--voxel-size-m", 25, 25, 25, "--optical-depth", optical_depth, "-o", cloud)
    scene = folder / f"{name}.toml"
    scene.write_text(support.scene_text([
        ("", {"title": name}),
        ("cloud", {"file": str(cloud), "quantity": "extinction", "single_scattering_albedo": albedo, "phase_function": "droplets"}),
        ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.85}),
        ("sun", {"zenith_deg": 60.0, "azimuth_deg": 180.0}),
        ("solver", {"mode": "3d", "tolerance": SWEEP_TOLERANCE}),
    ]))
    return cloudbow.run(scene, folder / f"{name}.h5", accept=(0, 3))


def sweeps(references, cloudbow, folder):
    def cells(name, albedo, result):
        done = "" if result.exit_code == 0 else " (not converged)"
        return [name, albedo, f"{result.solver['sweeps']}{done}", f"{result.solver['estimated_error']:.1e}", f"{result.summary['energy_residual']:.0e}"]

    rows = [cells(f"slab, tau {depth}, mu0 .5", albedo, slab_sweeps(depth, albedo, cloudbow, folder))
            for depth in SLAB_OPTICAL_DEPTHS for albedo in SLAB_ALBEDOS]
    for case in (case for cases in intercomparison.CASES.values() for case in cases):
        scene = folder / "field.toml"
        scene.write_text(intercomparison.scene(case, references / "fields", "balanced"))
        result = cloudbow.run(scene, folder / "field.h5", "--set", f"solver.tolerance={SWEEP_TOLERANCE}", accept=(0, 3))
        rows.append(cells(case.name.rsplit(",", 1)[0], case.single_scattering_albedo, result))
    return support.markdown_table(["scene", "single-scattering albedo", "sweeps", "estimated error", "energy residual"], rows)


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    options = parser.parse_args()
    references = support.reference_folder()
    if references is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with fields/, i3rc/ and montecarlo/")
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    with support.Workspace(options.keep) as folder:
        print(sweeps(references, cloudbow, folder))
    return 0


if __name__ == "__main__":
    sys.exit(main())
