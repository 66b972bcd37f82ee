#!/usr/bin/env python3
"""Radiance that leaves the program: the field of a result queried in Python, exported as OpenVDB grids, and seen by a sensor.

Truth: the export is the query of docs/examples/query_radiance.py (to the digits that `cloud info` prints), and in the uppermost (for a sensor below:
lowest) voxels, which are thin, both are near the image that the same scene has of a sensor there. A direction that is mirrored, turned by 180
degrees or taken for its opposite is wrong by tens of per cent.

usage: radiance_export.py [--cloudbow PROGRAM]
"""
import math
import re
import sys

import h5py
import numpy as np

import support

sys.path.insert(0, str(support.ROOT / "docs/examples"))
import query_radiance

SENSORS = [(0.0, 0.0), (50.0, 40.0), (50.0, 130.0), (30.0, 220.0), (140.0, 40.0), (115.0, 300.0)]  # zenith, azimuth; none within 20 degrees of the sun, because interpolation blunts the peak
IMAGE_LIMIT = 2.0  # %; measured 0.8: the mean of a voxel of optical depth .05 is not its face, and 162 points are interpolated between
SCENE = [
    ("", {"title": "A slab for sensors all around"}),
    ("cloud", {"file": "slab.vdb", "quantity": "extinction", "single_scattering_albedo": 0.99, "phase_function": "droplets"}),
    ("phase_function.droplets", {"type": "henyey-greenstein", "asymmetry_parameter": 0.6}),
    ("sun", {"zenith_deg": 50.0, "azimuth_deg": 40.0, "irradiance_w_m2": 1000.0}),
    ("surface", {"type": "lambertian", "albedo": 0.1}),
    ("solver", {"accuracy": "balanced", "mode": "3d"}),
    *[("[radiance]", {"name": f"s{n}", "zenith_deg": zenith, "azimuth_deg": azimuth}) for n, (zenith, azimuth) in enumerate(SENSORS)],
    ("output", {"fields": ["fluxes", "absorption", "actinic", "radiance_field"]}),
]


def towards(zenith_deg, azimuth_deg):
    zenith, azimuth = math.radians(zenith_deg), math.radians(azimuth_deg)
    return [math.sin(zenith) * math.cos(azimuth), math.sin(zenith) * math.sin(azimuth), math.cos(zenith)]


def spread(text, grid):
    """min, mean, max and the number of values of a grid that `cloud info` describes."""
    part = text.split(f'grid "{grid}"')[1]
    count = int(re.search(r"active voxels +(\d+)", part).group(1))
    return count, [float(number) for number in re.search(r"value +min (\S+), mean (\S+), max (\S+)", part).groups()]


def main():
    options = support.argument_parser(__doc__.splitlines()[0]).parse_args()
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    faults = []

    def check(good, message):
        print(("ok    " if good else "FAIL  ") + message, flush=True)
        if not good:
            faults.append(message)

    with support.Workspace(options.keep) as folder:
        cloudbow.call("cloud", "make", "slab", "--cells", 3, 2, 40, "--voxel-size-m", 50, 50, 10, "--optical-depth", 2, "-o", folder / "slab.vdb")
        scene, result = folder / "slab.toml", folder / "slab.h5"
        scene.write_text(support.scene_text(SCENE))
        cloudbow.run(scene, result)

        def exported(*arguments):
            cloudbow.call("export", result, "--vdb", folder / "out.vdb", *arguments)
            return cloudbow.call("cloud", "info", folder / "out.vdb").stdout

        with h5py.File(result) as file:
            field = file["radiance_field"]
            level = field["voxel"][:, 2]
            for n, (zenith, azimuth) in enumerate(SENSORS):
                name = f"sensor at zenith {zenith:g}, azimuth {azimuth:g}"
                travel = towards(zenith, azimuth)
                radiance = query_radiance.query(field, travel)
                expected = [radiance.min(), radiance.mean(), radiance.max()]
                for place in (("--zenith-deg", zenith, "--azimuth-deg", azimuth), ("--direction", *(f"{2 * d:.15f}" for d in travel))):
                    count, values = spread(exported(*place), "radiance")
                    check(count == radiance.size and np.allclose(values, expected, rtol=1e-5), f"{name}: {place[0]} exports what Python finds")
                near = radiance[level == (level.max() if zenith < 90 else level.min())].mean()
                image = file[f"radiance_s{n}"][...].mean()
                error = 100 * (near / image - 1)
                check(abs(error) < IMAGE_LIMIT, f"{name}: field {near:.4g}, image {image:.4g} W m-2 sr-1, {error:+.2f} %")
            text = exported("--all-directions", "--actinic")
            points = field["direction"].shape[0]
            for point in (0, points // 2, points - 1):
                column = field["radiance"][:, point].astype(float)
                check(np.allclose(spread(text, f"radiance_{point:03d}")[1], [column.min(), column.mean(), column.max()], rtol=1e-5), f"control point {point} is as in the file")
            actinic = file["actinic_flux"][...].astype(float)
            check(np.allclose(spread(text, "actinic_flux")[1], [actinic.min(), actinic.mean(), actinic.max()], rtol=1e-5), "actinic flux is as in the file")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
