#!/usr/bin/env python3
"""Wrong input ends with exit code 2, one message that names the place, what was found and what is allowed, and no output file.

Each case spoils one thing in a scene that runs; the words are those that a user needs to put it right. That the unspoiled scene is accepted is
checked first.

usage: check_input_errors.py --cloudbow PROGRAM --faulty-vdb PROGRAM
"""
import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

SCENE = """\
title = "a scene that runs"
[cloud]
file = "cloud.vdb"
grid = "density"
quantity = "extinction"
scale = 1.0
single_scattering_albedo = 0.99
phase_function = "droplets"
[phase_function.droplets]
type = "henyey-greenstein"
asymmetry_parameter = 0.85
[sun]
zenith_deg = 60.0
azimuth_deg = 0.0
[surface]
type = "lambertian"
albedo = 0.05
[solver]
accuracy = "draft"
"""


def replaced(old, new):
    assert old in SCENE, old
    return SCENE.replace(old, new)


def scenes():
    """(name, scene, words of the message)"""
    yield "unknown key", replaced("scale = 1.0", "skale = 1.0"), ["scene.toml:6", "skale", "scale"]
    yield "unknown table", SCENE + "[clouds]\n", ["scene.toml", "clouds"]
    yield "wrong type", replaced("zenith_deg = 60.0", 'zenith_deg = "high"'), ["scene.toml:13", "sun.zenith_deg", "high"]
    yield "nan", replaced("zenith_deg = 60.0", "zenith_deg = nan"), ["scene.toml:13", "sun.zenith_deg", "nan"]
    yield "infinity", replaced("scale = 1.0", "scale = inf"), ["scene.toml:6", "cloud.scale", "inf"]
    yield "not TOML", SCENE + "albedo = = 3\n", ["scene.toml:20"]
    yield "value out of range", replaced("albedo = 0.05", "albedo = -0.1"), ["scene.toml:17", "surface.albedo", "-0.1", "0 to 1"]
    yield "albedo 1.2", replaced("albedo = 0.05", "albedo = 1.2"), ["scene.toml:17", "surface.albedo", "1.2", "0 to 1"]
    yield "g = 1", replaced("= 0.85", "= 1.0"), ["scene.toml:11", "asymmetry_parameter", "1"]
    yield "ssa 1.01", replaced("= 0.99", "= 1.01"), ["scene.toml:7", "single_scattering_albedo", "1.01", "0 to 1"]
    yield "sun below the horizon", replaced("zenith_deg = 60.0", "zenith_deg = 95.0"), ["scene.toml:13", "sun.zenith_deg", "95", "90"]
    yield "azimuth and bearing", replaced("azimuth_deg = 0.0", "azimuth_deg = 0.0\nbearing_deg = 90.0"), ["scene.toml", "azimuth_deg", "bearing_deg"]
    yield "neither azimuth nor bearing", replaced("azimuth_deg = 0.0\n", ""), ["scene.toml", "azimuth_deg", "bearing_deg"]
    yield "negative density scale", replaced("scale = 1.0", "scale = -1.0"), ["scene.toml:6", "cloud.scale", "-1", "> 0"]
    yield "missing cloud file", replaced("cloud.vdb", "none.vdb"), ["none.vdb"]
    yield "a directory as cloud", replaced("cloud.vdb", "folder"), ["folder", "directory"]
    yield "a text file as cloud", replaced("cloud.vdb", "scene.toml"), ["scene.toml"]
    yield "wrong grid name", replaced('grid = "density"', 'grid = "clouds"'), ["cloud.vdb", "clouds", "density"]
    yield "unknown phase function", replaced('phase_function = "droplets"', 'phase_function = "drops"'), ["scene.toml", "drops", "droplets"]
    yield "unknown accuracy", replaced('"draft"', '"best"'), ["scene.toml:19", "best", "draft, balanced, fine, reference"]
    yield "no light", SCENE.replace("[sun]\nzenith_deg = 60.0\nazimuth_deg = 0.0\n", ""), ["sun", "sky"]
    yield "domain off the voxel faces", SCENE + "[domain]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [310.0, 300.0, 400.0]\n", ["310", "300", "350"]
    yield "domain smaller than the cloud", SCENE + "[domain]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [200.0, 300.0, 400.0]\n", ["200", "300"]
    yield "more memory than the machine has", SCENE + ("[domain]\nmin_m = [0.0, 0.0, 0.0]\nmax_m = [1500000.0, 1500000.0, 400.0]\n[[layer]]\nname = 'air'\n"
           "bottom_m = 0.0\ntop_m = 400.0\noptical_depth = 0.1\nsingle_scattering_albedo = 1.0\nphase_function = 'rayleigh'\n"), ["memory"]
    for fault, words in (("nan", ["nan"]), ("infinite", ["inf"]), ("negative", ["-0.01"]), ("rotated", ["rotated"]), ("empty", ["empty"]),
                         ("double", ["double", "float"])):
        yield f"VDB file: {fault}", replaced("cloud.vdb", f"{fault}.vdb"), [f"{fault}.vdb", *words]
    for cut in (50, 90, 99):
        yield f"VDB file cut at {cut} %", replaced("cloud.vdb", f"cut_{cut}.vdb"), [f"cut_{cut}.vdb"]


class Checker:
    def __init__(self, program, folder):
        self.program = program
        self.folder = folder
        self.faults = []

    def expect_error(self, name, arguments, words, output):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, timeout=60)
        message = done.stderr.strip()
        problems = []
        if done.returncode != 2:
            problems.append(f"exit code {done.returncode} instead of 2")
        if len(message.splitlines()) != 1:
            problems.append(f"{len(message.splitlines())} lines instead of one message")
        problems += [f"no word of '{word}'" for word in words if word.lower() not in message.lower()]
        left = [path.name for path in self.folder.iterdir() if path.name.startswith(output.stem)] if output.parent == self.folder else []
        if left:
            problems.append(f"left {', '.join(left)} behind")
        print(f"{'FAIL' if problems else 'ok':5s}{name}: {message}", flush=True)
        self.faults += [f"{name}: {problem}" for problem in problems]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    parser.add_argument("--faulty-vdb", required=True)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="cloudbow-errors-") as name:
        folder = Path(name)
        (folder / "folder").mkdir()
        cloud = folder / "cloud.vdb"
        subprocess.run([options.cloudbow, "cloud", "make", "sphere", "--cells", "6", "6", "8", "--voxel-size-m", "50", "50", "50", "-o", str(cloud)], check=True,
                       stdout=subprocess.DEVNULL)
        whole = cloud.read_bytes()
        for cut in (50, 90, 99):
            (folder / f"cut_{cut}.vdb").write_bytes(whole[:len(whole) * cut // 100])
        for fault in ("nan", "infinite", "negative", "rotated", "empty", "double"):
            subprocess.run([options.faulty_vdb, fault, str(folder / f"{fault}.vdb")], check=True)

        scene, output = folder / "scene.toml", folder / "output.h5"
        scene.write_text(SCENE)
        run = ["run", scene, "--quiet", "-o", output]
        subprocess.run([options.cloudbow, *map(str, run)], check=True, stdout=subprocess.DEVNULL)
        output.unlink()

        checker = Checker(options.cloudbow, folder)
        for name, text, words in scenes():
            scene.write_text(text)
            checker.expect_error(name, run, words, output)
        scene.write_text(SCENE)
        checker.expect_error("missing scene", ["run", folder / "none.toml", "-o", output], ["none.toml"], output)
        checker.expect_error("a directory as scene", ["run", folder / "folder", "-o", output], ["folder", "directory"], output)
        checker.expect_error("missing output folder", ["run", scene, "--quiet", "-o", folder / "nowhere/output.h5"], ["nowhere"], output)
        checker.expect_error("a file as output folder", ["run", scene, "--quiet", "-o", cloud / "output.h5"], ["cloud.vdb"], output)
        checker.expect_error("output is a directory", ["run", scene, "--quiet", "-o", folder / "folder"], ["folder"], output)
        checker.expect_error("unknown key set", [*run, "--set", "sun.zenit_deg=3"], ["sun.zenit_deg"], output)
        checker.expect_error("value set out of range", [*run, "--set", "sun.zenith_deg=95"], ["sun.zenith_deg", "95"], output)
        checker.expect_error("layer that is not there", [*run, "--set", "layer.0.optical_depth=2"], ["layer"], output)
    print("\n" + "\n".join(checker.faults or ["every wrong input is told as such"]))
    return 1 if checker.faults else 0


if __name__ == "__main__":
    sys.exit(main())
