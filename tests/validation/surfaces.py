#!/usr/bin/env python3
"""Surfaces under a thin Rayleigh atmosphere, against figures stored with SHDOM (made by Evans' original program; README of the reference data):
fluxes at the surface and radiance at the top in 19 directions in the sun's plane.

SHDOM has 16 polar angles over the whole range and 32 azimuths; what such a set makes of the surface's directional albedo at this sun stands
beside it, by a quadrature of the formula that shares no code with the program: most of the difference in the upward flux. Glints of sky light near
the horizon are narrower than 32 azimuths resolve, so waves are compared for mu >= .4. SHDOM's light is polarised there, here it is not.

usage: CLOUDBOW_REFERENCE_DIR=... surfaces.py [--accuracy fine]
"""
import math
import sys

import numpy as np

import support

MU0 = 0.707
COLUMNS = (0, 25, 49)  # of 50, along which each file's parameter varies
OPTICAL_DEPTH = -MU0 * math.log(0.97693)  # from the stored direct flux
DEPOLARISATION = 0.0275  # of air at .85 um (Bates 1984): these runs of SHDOM have it
# Limits in per cent: RMS of the radiances over their mean, upward flux at the surface.
# Radiances: the atmosphere itself is a per cent brighter here (their 11 levels of an exponential atmosphere). Fluxes: their quadrature.
LIMITS = {"L": (1.5, 0.5), "R": (0.5, 0.8), "W": (1.0, 6.0)}
LEAST_MU = {"L": 0.1, "R": 0.1, "W": 0.4}


def surface(kind, share):
    if kind == "L":
        return f"lambertian, albedo {0.3 * share:.3f}", {"type": "lambertian", "albedo": 0.3 * share}
    if kind == "R":
        k = 0.5 + 0.5 * share
        return f"RPV, rho0 .1, theta -.24, k {k:.2f}", {"type": "rpv", "rho0": 0.1, "k": k, "theta": -0.24}
    wind = 4 + 8 * share
    return f"waves, wind {wind:.1f} m/s", {"type": "cox-munk", "wind_speed_m_s": wind, "refractive_index": 1.33}


def read_fluxes(path):
    return np.array([[float(v) for v in line.split()[2:5]] for line in path.read_text().splitlines() if not line.startswith("!")])


def read_radiances(path):
    """[(mu, phi, radiance by column)], mu and phi of the direction of travel; the sun's light travels towards phi = 0."""
    found = []
    for line in path.read_text().splitlines():
        if "<- (mu,phi)" in line:
            mu, phi = (float(v) for v in line.lstrip("!").split()[:2])
            found.append((mu, phi, []))
        elif not line.startswith("!"):
            found[-1][2].append(float(line.split()[2]))
    return found


def reflectance(kind, keys, mu, azimuth):
    """f(mu0, mu, azimuth) of the formulas themselves, written anew: azimuth 0 is travel in the sun's own azimuth."""
    if kind == "L":
        return np.full(np.broadcast(mu, azimuth).shape, keys["albedo"] / np.pi)
    tan_i, tan_o = math.sqrt(1 - MU0**2) / MU0, np.sqrt(1 - mu**2) / mu
    cos_back = -np.cos(azimuth)  # sun and observer on the same side
    phase = MU0 * mu * (1 + tan_i * tan_o * cos_back)
    if kind == "R":
        rho0, k, theta = keys["rho0"], keys["k"], keys["theta"]
        distance = np.sqrt(np.maximum(0, tan_i**2 + tan_o**2 - 2 * tan_i * tan_o * cos_back))
        return (rho0 / np.pi * (MU0 * mu * (MU0 + mu))**(k - 1) * (1 - theta**2) / (1 + 2 * theta * phase + theta**2)**1.5
                * (1 + (1 - rho0) / (1 + distance)))
    n, variance = keys["refractive_index"], 0.003 + 0.00512 * keys["wind_speed_m_s"]
    half = np.sqrt((1 + phase) / 2)
    inside = np.sqrt(1 - (1 - half**2) / n**2)
    fresnel = 0.5 * (((half - n * inside) / (half + n * inside))**2 + ((n * half - inside) / (n * half + inside))**2)
    tilt2 = ((MU0 + mu) / (2 * half))**2

    def hidden(tangent):
        v = 1 / (tangent * math.sqrt(variance))
        complement = np.vectorize(math.erfc)(v)
        return 0.5 * (np.exp(-v * v) / (v * math.sqrt(np.pi)) - complement)

    slopes = np.exp(-(1 / tilt2 - 1) / variance) / (np.pi * variance)
    return fresnel * slopes / (4 * MU0 * mu * tilt2**2) / (1 + hidden(tan_o) + hidden(np.array(tan_i)))


def directional_albedo(kind, keys, nodes, weights, azimuths):
    azimuth = (np.arange(azimuths) * 2 * np.pi / azimuths)[None, :]
    f = reflectance(kind, keys, nodes[:, None], azimuth)
    return float((weights * nodes * f.mean(1) * 2 * np.pi).sum())


def albedos(kind, keys):
    """Directional albedo by fine quadrature, and as 16 polar angles over the whole range and 32 azimuths give it."""
    x, w = np.polynomial.legendre.leggauss(400)
    root = (1 + x) / 2
    fine = directional_albedo(kind, keys, root * root, w * root, 1440)
    x, w = np.polynomial.legendre.leggauss(16)
    return fine, directional_albedo(kind, keys, x[x > 0], w[x > 0], 32)


def solve(kind, column, folder, cloudbow, accuracy, radiances):
    name, keys = surface(kind, column / 50)
    tables = [("", {"title": name}),
              ("[layer]", {"name": "molecules", "bottom_m": 0.0, "top_m": 30000.0, "optical_depth": OPTICAL_DEPTH,
                           "single_scattering_albedo": 1.0, "phase_function": "air"}),
              ("phase_function.air", {"type": "legendre", "moments": [1.0, 0.0, 0.1 * (1 - DEPOLARISATION) / (1 + DEPOLARISATION / 2)]}),
              ("sun", {"zenith_deg": support.zenith_deg(MU0), "azimuth_deg": 180.0, "irradiance_w_m2": 1 / MU0}),
              ("surface", keys), ("solver", {"accuracy": accuracy})]
    tables += [("[radiance]", {"name": f"v{i}", "zenith_deg": support.zenith_deg(mu), "azimuth_deg": phi})
               for i, (mu, phi, _) in enumerate(radiances)]
    scene = folder / f"{kind}{column}.toml"
    scene.write_text(support.scene_text(tables))
    return name, keys, cloudbow.run(scene, folder / f"{kind}{column}.h5")


def arguments():
    parser = support.argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--accuracy", default="fine")
    return parser


def figures(options):
    """A row for every surface, errors in per cent."""
    references = support.reference_folder()
    if references is None:
        support.skip("CLOUDBOW_REFERENCE_DIR is not set; it names the folder with shdom/original_shdom_outputs")
    stored = references / "shdom" / "original_shdom_outputs"
    cloudbow = support.Cloudbow(options.cloudbow, options.threads)
    rows = []
    with support.Workspace(options.keep) as folder:
        for kind, (radiance_limit, flux_limit) in LIMITS.items():
            fluxes = read_fluxes(stored / f"brdf_{kind}1f.out")
            radiances = read_radiances(stored / f"brdf_{kind}1r.out")
            for column in COLUMNS:
                name, keys, result = solve(kind, column, folder, cloudbow, options.accuracy, radiances)
                ours = np.array([result[f"radiance_v{i}"].item() for i in range(len(radiances))])
                theirs = np.array([values[column] for _, _, values in radiances])
                steep = np.array([mu >= LEAST_MU[kind] for mu, _, _ in radiances])
                error = 100 * math.sqrt(np.mean((ours - theirs)[steep]**2)) / theirs[steep].mean()
                worst = int(np.argmax(steep * abs(ours / theirs - 1)))
                up = result["upwelling_flux"][0].item()
                up_error = 100 * (up - fluxes[column, 0]) / max(fluxes[column, 0], 0.01)
                down_error = 100 * (result["downwelling_diffuse_flux"][0].item() - fluxes[column, 1])
                fine, coarse = albedos(kind, keys)
                ratio = up / (result["downwelling_diffuse_flux"][0].item() + result["direct_flux"][0].item())
                rows.append({"surface": name, "radiance": error, "radiance_limit": radiance_limit, "worst": 100 * (ours[worst] / theirs[worst] - 1),
                             "worst_at": f"mu {radiances[worst][0]:.1f}, phi {radiances[worst][1]:.0f}", "up": up_error, "up_limit": flux_limit,
                             "down": down_error, "albedo": fine, "albedo_16x32": 100 * (coarse / fine - 1) if fine else 0.0, "ratio": ratio,
                             "ledger": result.summary["energy_residual"]})
                print(name, file=sys.stderr, flush=True)
    return rows


def table(rows):
    return support.markdown_table(["surface", "radiance at the top, RMS %", "allowed", "worst %", "upward flux at the surface %", "allowed", "diffuse down, % of incident",
                                   "directional albedo by the formula", "the same with 16 x 32 directions, %", "upward over downward flux", "energy residual"],
                                  [[row["surface"], f"{row['radiance']:.2f}", f"{row['radiance_limit']:g}", f"{row['worst']:+.1f} ({row['worst_at']})", f"{row['up']:+.2f}",
                                    f"{row['up_limit']:g}", f"{row['down']:+.4f}", f"{row['albedo']:.5f}", f"{row['albedo_16x32']:+.2f}", f"{row['ratio']:.5f}",
                                    f"{row['ledger']:.0e}"] for row in rows])


def main():
    rows = figures(arguments().parse_args())
    print(table(rows))
    return 0 if all(row["radiance"] <= row["radiance_limit"] and abs(row["up"]) <= row["up_limit"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
