#!/usr/bin/env python3
"""Every source file has a test of its name: of src/LAYER/ROOM/x.cpp it is tests/unit/LAYER/ROOM/test_x.cpp, or test_x.py for a driver.

Truth: the tree. Sources without logic of their own are named below, each group with its reason. A name that is not needed any more is a fault too.
The checker checks itself on a tree with known faults first.

usage: check_test_names.py ROOT
"""
import sys
import tempfile
from pathlib import Path

# Reason: sources.
WITHOUT_TEST = {
    "no logic": ("main.cpp", "core/error.cpp"),
    "settings of the program's process, which tests/robustness reads from outside": ("large_arrays.cpp", "openmp_settings.cpp"),
    "published tables, compared with other publications by test_refractive_index.cpp": ("optics/refractive_index_tables.cpp",),
    "the order of calls, seen in the images of test_view.cpp and test_camera_view.cpp": ("transport/observers/images.cpp",),
    "the source towards views and cameras, compared with single scattering by the same two": ("transport/observers/viewing_source.cpp",),
    "calls of the library that draws, whose pictures test_drawing.cpp measures": ("plots/drawing_module.cpp",),
    "the functions of netCDF, which test_netcdf_library.cpp calls": ("medium/netcdf_module.cpp",),
    "calls of MPI, which tests/robustness/ranks.py runs": ("core/mpi_module.cpp",),
    "results as they were written, which test_sweep_file.cpp reads": ("io/stored_result.cpp",),
    "scenes of the checks below": ("app/verify/scenes.cpp",),
    "tests themselves: check_verify.py runs each, test_verify_command.cpp has some that fail": tuple(
        f"app/verify/{part}_checks.cpp" for part in ("column", "direction", "energy", "field", "optics", "sphere", "thermal")),
}


def faults_of(root, without_test):
    sources = {path.relative_to(root / "src").as_posix() for path in (root / "src").rglob("*.cpp")}
    allowed = {source for group in without_test.values() for source in group}
    faults = []
    for source in sorted(sources | allowed):
        place, stem = Path("tests/unit") / Path(source).parent, Path(source).stem
        has_test = any((root / place / f"test_{stem}.{ending}").exists() for ending in ("cpp", "py"))
        if source not in sources:
            faults.append(f"src/{source}: is named as a source without a test, and does not exist")
        elif source in allowed and has_test:
            faults.append(f"src/{source}: is named as a source without a test, and has one")
        elif source not in allowed and not has_test:
            faults.append(f"src/{source}: no test of its name (allowed: {place}/test_{stem}.cpp)")
    return len(sources), faults


def check_the_checker():
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name in ("src/a/tested.cpp", "src/a/driven.cpp", "src/a/bare.cpp", "src/b/moved.cpp", "src/main.cpp", "src/a/useless.cpp",
                     "tests/unit/a/test_tested.cpp", "tests/unit/a/test_driven.py", "tests/unit/a/test_moved.cpp", "tests/unit/a/test_useless.cpp"):
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).touch()
        count, faults = faults_of(root, {"glue": ("main.cpp", "gone.cpp", "a/useless.cpp")})
        assert count == 6 and [fault.split(":")[0] for fault in faults] == ["src/a/bare.cpp", "src/a/useless.cpp", "src/b/moved.cpp", "src/gone.cpp"], faults


def main():
    check_the_checker()
    count, faults = faults_of(Path(sys.argv[1]), WITHOUT_TEST)
    print("\n".join(faults) or f"{count} sources, {sum(map(len, WITHOUT_TEST.values()))} of them without a test of their name, as said")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
