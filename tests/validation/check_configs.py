#!/usr/bin/env python3
"""Every scene in configs/ runs as it is (at accuracy draft, to be quick) and closes its ledger. Its result opens, and every image in it can be drawn.
Those of the gallery, minutes each, are read and foreseen."""
import sys
from pathlib import Path

import numpy as np
import xarray

import support
from support import ROOT, Failure


def main():
    parser = support.argument_parser(__doc__)
    parser.add_argument("scenes", nargs="*", type=Path, help="default: all of configs/")
    options = parser.parse_args()
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    scenes = options.scenes or sorted((ROOT / "configs").rglob("*.toml"))
    if not scenes:
        sys.exit("no scene in configs/")
    faults = []
    with support.Workspace(options.keep) as folder:
        for scene in scenes:
            output, picture = folder / f"{scene.stem}.h5", folder / f"{scene.stem}.png"
            try:
                if scene.parent.name == "gallery":  # minutes each: foreseen only
                    cloudbow.call("run", scene, "--dry-run")
                    continue
                result = cloudbow.run(scene, output, "--set", "solver.accuracy=draft", error_estimate=True)
                with xarray.open_dataset(output) as data:
                    images = [name for name in data if name.startswith(("radiance_", "camera_", "brightness_temperature_"))]
                    finite = all(bool(data[name].notnull().all()) for name in ("upwelling_flux", "downwelling_diffuse_flux", "direct_flux"))
                if not finite:
                    raise Failure(f"{scene}: fluxes that are not numbers")
                for field in ["upwelling_flux", *images]:
                    cloudbow.call("render", output, "--field", field, "-o", picture)
                    if not picture.read_bytes().startswith(b"\x89PNG"):
                        raise Failure(f"{scene}: render made no PNG of {field}")
                energy = ", ".join(f"{name} {np.mean(value):.4f}" for name, value in result.summary.items() if name in ("reflectance", "transmittance", "energy_residual"))
                print(f"{scene.stem}: {energy}, "
                      f"{result.cpu_seconds:.1f} CPU s, {result.peak_memory_bytes / 1e6:.0f} MB", flush=True)
            except Failure as failure:
                faults.append(str(failure))
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
