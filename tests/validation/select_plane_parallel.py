#!/usr/bin/env python3
"""Makes tests/data/plane_parallel_subset.json: a representative third of the plane-parallel reference cases, fluxes only.

Every group, every optical depth, albedo, asymmetry and sun of the whole set is in it; thermal cases are not.

usage: select_plane_parallel.py plane_parallel.json > tests/data/plane_parallel_subset.json
"""
import json
import sys

FLUXES = ("tau", "flux_up", "flux_down_diffuse", "flux_down_direct")
ALWAYS = ("b_ray_tau0.2_w1_mu0.1", "b_ray_tau1_w1_mu0.5", "b_ray_tau5_w1_mu1", "b_ray_tau0.2_w1_mu0.5_A0.2",
          "c_hg0.75_tau1_w1_mu1", "c_hg0.75_tau8_w1_mu0.5", "d_hg0.85_tau1_w1_mu0.5_A0.8", "d_hg0.85_tau10_w0.9_mu0.5_A0.8",
          "d_hg0.85_tau100_w1_mu0.1_A0")


def chosen(case, number, group):
    """Whole small groups; of the large ones every n-th, by a step that shares no factor with the length of the runs of parameters."""
    if case["id"] in ALWAYS or group in "fgi":
        return True
    if group == "a":
        tau, ssa, mu0 = number // 9, number // 3 % 3, number % 3
        return (tau + ssa + mu0) % 3 == 0
    if group == "d":
        return number % 5 == 0
    if group == "e":
        return (number // 8 + number) % 2 == 1
    return False


def main():
    whole = json.load(open(sys.argv[1]))
    count, cases = {}, []
    for case in whole["cases"]:
        group = case["id"][0]
        number = count[group] = count.get(group, -1) + 1
        if case["thermal"] is None and chosen(case, number, group):
            kept = {key: case[key] for key in ("id", "layers", "mu0", "phi0", "F0", "isotropic_top", "surface_albedo", "thermal", "nstr")}
            kept["results"] = {"levels": [{key: level[key] for key in FLUXES} for level in case["results"]["levels"]]}
            kept["est"] = {"flux_abs": case["est"]["flux_abs"]}
            cases.append(kept)
    conventions = {key: whole["conventions"][key] for key in ("program", "geometry", "beam", "flux", "phase", "surface", "solver", "error_estimate")}
    head = json.dumps({"title": whole["title"], "made": whole["made"], "selection": __doc__.split("\n")[0], "conventions": conventions}, indent=1)
    print(head[:-2] + ',\n "cases": [\n  ' + ",\n  ".join(json.dumps(case) for case in cases) + "\n ]\n}")


if __name__ == "__main__":
    main()
