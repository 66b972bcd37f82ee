#!/usr/bin/env python3
"""The fits of phase functions to control points, compared: writes docs/phase-function-fits.md's table and plot.

Runs `cloudbow phase` on Henyey-Greenstein functions, Rayleigh's and that of a cloud of droplets, with 42, 162 and 642 control points, reads the
figures from the file it writes, and checks what the constrained fits promise: norm and asymmetry to 1e-10 if a positive solution holds them.

usage: fit_table.py [--cloudbow PROGRAM] [--points 42,162,642] [--write]
"""
import sys

import h5py

from support import ROOT, Cloudbow, Workspace, argument_parser, markdown_table, plain, write_between_markers

PAGE = ROOT / "docs/phase-function-fits.md"
PLOT = ROOT / "docs/images/phase_function_fits.png"
DROPLETS = ROOT / "tests/data/c1_legendre.txt"

FUNCTIONS = [(f"HG {g}", ["henyey-greenstein", "--asymmetry-parameter", g]) for g in ("0.5", "0.75", "0.85", "0.95")]
FUNCTIONS += [("Rayleigh", ["rayleigh"]), ("droplets", ["legendre", "--file", DROPLETS])]
DELTA_M_ORDER = {42: 6, 162: 12, 642: 16}
FITS = ["collocation", "least-squares", "minimax-absolute", "minimax-relative", "minimax-square-root", "linear-programming",
        "linear-programming-interpolant", "linear-programming-bounded"]
SHORT = ["collocation", "least squares", "minimax absolute", "minimax relative", "minimax square root", "LP", "LP interpolant", "LP bounded"]
FORMS = {"raw": "raw", "delta_m": "delta-M"}
LARGE_PEAK = ["henyey-greenstein", "--asymmetry-parameter", "0.95", "--control-points", "642", "--delta-m-order", "16"]
LARGE_PEAK_FITS = ["minimax-absolute", "minimax-relative", "minimax-square-root", "linear-programming"]
EXACT = 1e-10
WRITTEN = ("summary", "large-peak", "delta_m-errors")  # the others are printed
BOUND = 1.2


def read(path):
    """{(raw or delta_m, fit): its figures}, with the function's own range and asymmetry."""
    figures = {}
    with h5py.File(path) as file:
        for form in FORMS:
            if form not in file:
                continue
            group = file[form]
            for fit in FITS:
                name = "fit_" + fit.replace("-", "_")
                if name in group:
                    figures[form, fit] = {key: plain(value) for key, value in group[name].attrs.items()}
                    figures[form, fit]["g"] = plain(group.attrs["asymmetry_parameter"])
                    figures[form, fit]["largest"] = float(abs(group["phase_function"][...]).max())
    return figures


def percent(value):
    return "0" if abs(value) < EXACT else f"{100 * value:.2g}"


def moments_of(fit, figures):
    """Errors of norm and g: under the quadrature, or of the interpolant if the fit holds those."""
    kind = "interpolant" if fit.endswith("interpolant") else "ordinate"
    return figures[f"{kind}_norm"] - 1, figures[f"{kind}_asymmetry_parameter"] - figures["g"]


def errors_cell(fit, f):
    return f"{100 * f['max_error'] / f['largest']:.3g} / {100 * f['rms_error'] / f['largest']:.2g}"


def moments_cell(fit, f):
    mark = "" if f["exact_degree"] in (-1, 3) else f" (l <= {f['exact_degree']})"
    return " / ".join(percent(error) for error in moments_of(fit, f)) + mark


def least_cell(fit, f):
    return f"{f['least_value']:.2g} / {f['worst_angle_deg']:.0f}"


CELLS = {"errors": errors_cell, "moments": moments_cell, "least": least_cell}


def check(name, figures, faults, notes):
    for (form, fit), f in figures.items():
        if not fit.startswith("linear-programming"):
            continue
        where = f"{name}, {FORMS[form]}, {fit}"
        norm, asymmetry = map(abs, moments_of(fit, f))
        if f["exact_degree"] < 3:
            notes["infeasible"].append(f"{where}: l <= {f['exact_degree']}")
        if norm > EXACT or (f["exact_degree"] >= 1 and asymmetry > EXACT):
            faults.append(f"{where}: norm off by {norm:.1e}, g by {asymmetry:.1e}")
        best = figures[form, "minimax-absolute"]["max_error"]
        ratio = f["max_error"] / best if best > 1e-6 else 1
        notes["ratios"].setdefault(fit, []).append((ratio, where))
        if fit == "linear-programming-bounded" and ratio > BOUND * (1 + 1e-6):
            notes["unbounded"].append(f"{where}: {ratio:.3g} times")


def main():
    parser = argument_parser(__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write some of the tables and the plot into docs/")
    parser.add_argument("--points", type=lambda text: [int(word) for word in text.split(",")], default=list(DELTA_M_ORDER),
                        help="numbers of control points (default: 42,162,642)")
    options = parser.parse_args()
    program = Cloudbow(options.cloudbow)
    faults, notes = [], {"infeasible": [], "unbounded": [], "ratios": {}}
    rows = {(form, kind): [] for form in FORMS for kind in CELLS}
    with Workspace(options.keep) as folder:
        for name, arguments in FUNCTIONS:
            for points in options.points:
                path = folder / f"{name.replace(' ', '_')}_{points}.h5"
                program.call("phase", *arguments, "--control-points", points, "--delta-m-order", DELTA_M_ORDER[points], "-o", path)
                figures = read(path)
                check(f"{name}, {points} points", figures, faults, notes)
                for (form, kind), table in rows.items():
                    if (form, FITS[0]) in figures:
                        table.append([name, points, *(CELLS[kind](fit, figures[form, fit]) if (form, fit) in figures else "-" for fit in FITS)])
        path = folder / "large_peak.h5"
        plot = ["--plot", PLOT] if options.write else []
        program.call("phase", *LARGE_PEAK, *(word for fit in LARGE_PEAK_FITS for word in ("--fit", fit)), "-o", path, *plot)
        large = read(path)

    for fit, ratios in notes["ratios"].items():
        ratio, where = max(ratios)
        within = sum(r <= BOUND * (1 + 1e-6) for r, _ in ratios)
        print(f"{fit}: within {BOUND} times the least max error in {within} of {len(ratios)}; worst {ratio:.3g} ({where})")
    print("Cases where no positive solution holds all moments l <= 3 (what was held instead):", *(notes["infeasible"] or ["none"]), sep="\n- ")
    print(f"Cases where `linear-programming-bounded` is not within {BOUND} times the least possible maximum error:", *(notes["unbounded"] or ["none"]), sep="\n- ")
    summary = ["Maximum error over the least possible one (that of `minimax-absolute`):", ""]
    summary += [markdown_table(["fit", "median", "largest", "where"],
                               [[fit, f"{sorted(ratios)[len(ratios) // 2][0]:.3g}", f"{max(ratios)[0]:.3g}", max(ratios)[1]]
                                for fit, ratios in notes["ratios"].items()])]
    texts = {f"{form}-{kind}": markdown_table(["function", "points", *SHORT], table) for (form, kind), table in rows.items()}
    texts["summary"] = "\n".join(summary)
    texts["large-peak"] = markdown_table(["form", "fit", "largest / RMS error %", "norm / g error %", "least value / at degree"],
                                         [[FORMS[form], fit, *(cell(fit, large[form, fit]) for cell in CELLS.values())]
                                          for form in FORMS for fit in LARGE_PEAK_FITS])
    for name, text in texts.items():
        if options.write and name in WRITTEN:
            write_between_markers(PAGE, name, text)
        else:
            print(f"\n{name}\n{text}")
    print("\n".join(faults) if faults else f"norm and g are exact to {EXACT:g} wherever they were held")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
