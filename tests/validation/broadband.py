#!/usr/bin/env python3
"""A few g-points of a gas model against all of them, both solved in three dimensions.

Truth: the sum over all g-points (spectrum.method = "all") at the same accuracy. Two fields: RICO cumulus, and a stratocumulus of
`cloudbow cloud make` that no choice of parameters has seen. Both lie in the AFGL mid-latitude summer atmosphere up to 60 km. Sunlight at two zenith
angles, and longwave light.

Differences: columns up at the top, columns down at the ground and absorption of columns, RMS over the mean (longwave: fluxes in W m-2); the mean heating
profile below 15 km, RMS over its largest. The residual of the choice foretells the worse of up and down, as a fraction; "too small" says that it is
smaller. The spectral part of the error estimate must not be (--estimates).

The models are files of others. CLOUDBOW_REFERENCE_DIR names a folder with gas/, atmospheres/afglms.txt and fields/rico32.vdb; skipped without.

usage: CLOUDBOW_REFERENCE_DIR=... broadband.py --cloudbow PROGRAM [--accuracy LEVEL] [--cases PATTERN,...] [--estimates] [--limits]
"""
import fnmatch
import sys

import h5py
import numpy as np

import support

SOLAR_MODEL, LONGWAVE_MODEL = "ecckd-1.4_sw_climate_rgb-32b_ckd-definition.nc", "ecckd-1.0_lw_climate_fsck-32b_ckd-definition.nc"
GASES = {"co2_ppm": 415.0, "ch4": 1.9e-6, "n2o": 3.3e-7}
LONGWAVE_GASES = GASES | {"cfc11": 2.3e-10, "cfc12": 5.2e-10}
TOP_M = 60000.0
HEATING_BELOW_M = 15000
STRATOCUMULUS = ("stratocumulus", "--cells", 32, 32, 25, "--voxel-size-m", 50, 50, 40, "--base-m", 600, "--cover", 0.8, "--seed", 2027)
EXTENT_M = {"rico": (640.0, 740.0), "stratocumulus": (1600.0, 1600.0)}
KINDS = {"solar 35": 35.0, "solar 70": 70.0, "longwave": None}

# Of each case: up and down (solar %, longwave W m-2), absorption (%), heating (%). Measured at draft and a tenth more.
LIMITS = {
    "rico solar 35": {"up": 0.062, "down": 0.020, "absorption": 0.084, "heating": 0.121},
    # The low beam crosses columns: independent columns foresee its light on the ground less well.
    "rico solar 70": {"up": 0.006, "down": 0.102, "absorption": 0.046, "heating": 0.040},
    "rico longwave": {"up": 0.068, "down": 0.014, "absorption": 0.053, "heating": 0.070},
    "stratocumulus solar 35": {"up": 0.029, "down": 0.032, "absorption": 0.026, "heating": 0.028},
    "stratocumulus solar 70": {"up": 0.026, "down": 0.121, "absorption": 0.024, "heating": 0.033},
    "stratocumulus longwave": {"up": 0.036, "down": 0.074, "absorption": 0.098, "heating": 0.030},
}


def scene(folder, cloud, kind, cloud_file, accuracy):
    zenith = KINDS[kind]
    solar = zenith is not None
    tables = [
        ("cloud", {"file": str(cloud_file), "quantity": "extinction", "effective_radius_um": 10.0, "phase_function": "water"}),
        ("phase_function.water", {"type": "bulk", "file": str(folder / "gas" / "mie_droplet_scattering.nc")}),
        ("atmosphere", {"file": str(folder / "atmospheres" / "afglms.txt")} | (GASES if solar else LONGWAVE_GASES)),
        ("spectrum", {"gas_model": str(folder / "gas" / (SOLAR_MODEL if solar else LONGWAVE_MODEL))}),
        ("surface", {"albedo": 0.06} if solar else {"albedo": 0.02, "temperature_k": 294.2}),
        ("domain", {"max_m": [*EXTENT_M[cloud], TOP_M]}),
        ("solver", {"accuracy": accuracy}),
        ("output", {"fields": ["fluxes", "absorption", "heating_rate"]}),
        ("sun", {"zenith_deg": zenith, "azimuth_deg": 0.0, "irradiance_w_m2": 1361.0}) if solar else ("thermal", {}),
    ]
    return support.scene_text(tables)


class Broadband(support.Result):
    """A result with what is said about its spectrum."""

    def __init__(self, path, *rest):
        super().__init__(path, *rest)
        with h5py.File(path) as file:
            self.spectral = dict(file["spectral"].attrs)

    def absorbed_columns(self):
        power = self["net_absorbed_power"] if "net_absorbed_power" in self.fields else self["absorbed_power"]
        return np.tensordot(np.diff(self.z_edge), power, 1)

    def heating_profile(self):
        middle = (self.z_edge[1:] + self.z_edge[:-1]) / 2
        return self["heating_rate"].mean(axis=(1, 2))[middle < HEATING_BELOW_M]


def rms(difference):
    return float(np.sqrt(np.mean(difference**2)))


def percent(few, all_points, unit=None):
    return 100 * rms(few - all_points) / (abs(float(np.mean(all_points))) if unit is None else unit)


def compare(few, all_points, solar):
    """Differences of a case: numbers for the table and the limits, then the relative error that the residual should cover."""
    pairs = [(few.upward_at_top(), all_points.upward_at_top()), (few.downward_at_bottom(), all_points.downward_at_bottom())]
    relative = max(percent(*pair) for pair in pairs)
    columns = [percent(*pair) if solar else rms(pair[0] - pair[1]) for pair in pairs]
    heating = all_points.heating_profile()
    figures = {"up": columns[0], "down": columns[1], "absorption": percent(few.absorbed_columns(), all_points.absorbed_columns()),
               "heating": percent(few.heating_profile(), heating, float(np.max(np.abs(heating))))}
    return figures, relative / 100


def main():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--accuracy", default="draft")
    parser.add_argument("--cases", default="*", help="patterns, such as 'rico solar*' (default: all)")
    parser.add_argument("--estimates", action="store_true", help="estimate errors too: their spectral part must cover the error of the columns")
    parser.add_argument("--limits", action="store_true", help="fail if a difference is above the limits of this driver")
    options = parser.parse_args()
    folder = support.reference_folder()
    if folder is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with gas/, atmospheres/ and fields/")
    needed = [folder / "gas" / SOLAR_MODEL, folder / "gas" / LONGWAVE_MODEL, folder / "gas" / "mie_droplet_scattering.nc",
              folder / "atmospheres" / "afglms.txt", folder / "fields" / "rico32.vdb"]
    if missing := [str(file) for file in needed if not file.exists()]:
        support.skip(f"not there: {', '.join(missing)}")
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    rows, bad = [], []
    with support.Workspace(options.keep) as work:
        clouds = {"rico": folder / "fields" / "rico32.vdb", "stratocumulus": work / "stratocumulus.vdb"}
        cloudbow.call("cloud", "make", *STRATOCUMULUS, "-o", clouds["stratocumulus"])
        for cloud, file in clouds.items():
            for kind, zenith in KINDS.items():
                case = f"{cloud} {kind}"
                if not any(fnmatch.fnmatchcase(case, pattern) for pattern in options.cases.split(",")):
                    continue
                stem = case.replace(" ", "_")
                path = work / f"{stem}.toml"
                path.write_text(scene(folder, cloud, kind, file, options.accuracy))
                runs = {}
                for method in ("few", "all"):
                    output = work / f"{stem}_{method}.h5"
                    result = cloudbow.run(path, output, "--set", f"spectrum.method={method}", error_estimate=options.estimates and method == "few")
                    runs[method] = Broadband(output, result.exit_code, result.cpu_seconds, result.peak_memory_bytes)
                figures, relative = compare(runs["few"], runs["all"], zenith is not None)
                spectral, estimate = runs["few"].spectral, runs["few"].error_estimate
                foretold = {"residual": float(spectral["residual"])}
                if options.estimates:
                    foretold["estimate"] = min(estimate["columns_up_spectral"], estimate["columns_down_spectral"])
                rows.append([case, len(spectral["solved"]), *(f"{value:.3f}" for value in figures.values()), f"{100 * relative:.3f}",
                             *(f"{100 * value:.3f}{'' if value >= relative else ' (too small)'}" for value in foretold.values()),
                             f"{runs['few'].wall_seconds:.1f}", f"{runs['all'].wall_seconds:.1f}"])
                print(" | ".join(map(str, rows[-1])), flush=True)
                if options.estimates and not foretold["estimate"] >= relative:
                    bad.append(f"{case}: columns differ by {100 * relative:.3f} %, more than the estimate of {100 * foretold['estimate']:.3f} %")
                for name, limit in LIMITS.get(case, {}).items() if options.limits else ():
                    if not figures[name] <= limit:
                        bad.append(f"{case}: {name} differs by {figures[name]:.3f}, limit {limit}")
    header = ["case", "g-points", "up [% or W m-2]", "down [% or W m-2]", "absorption [%]", "heating [%]", "worst of up, down [%]",
              "residual [%]", *(["estimate, spectral [%]"] if options.estimates else []), "few [s]", "all [s]"]
    print(support.markdown_table(header, rows))
    print("\n".join(bad))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
