#!/usr/bin/env python3
"""Files that a run must not destroy, wait for or call damaged, and standard streams that are not there.

Parts: outputs that would land on inputs or on each other; named pipes in place of inputs; permissions and links of results; locked files; readers of stderr that have gone;
closed standard streams; limits of memory.

Truth: the bytes of the inputs before, the result of an undisturbed run, and what exit codes mean (`cloudbow --help`).

usage: files.py --cloudbow PROGRAM
"""
import argparse
import fcntl
import os
import resource
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

import sound_scene

SPECTRUM = sound_scene.SCENE + "[spectrum]\nwavelengths_um = [0.55, 0.67]\n"
SECONDS = 60  # a run takes less than one; what waits for a pipe takes all of them


class Bench:
    def __init__(self, program, folder):
        self.program = str(Path(program).resolve())
        self.folder = folder
        self.faults = []
        self.environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
        (folder / "scene.toml").write_text(sound_scene.SCENE)
        (folder / "spectrum.toml").write_text(SPECTRUM)
        self.make_cloud()

    def make_cloud(self):
        done = self.run("cloud", "make", "cumulus", "--cells", 16, 16, 8, "--voxel-size-m", 50, 50, 50, "--seed", 3, "-o", "cloud.vdb")
        assert done.returncode == 0, done.stderr

    def run(self, *words, **more):
        return subprocess.run([self.program, *map(str, words)], cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=SECONDS, **more)

    def check(self, good, name, found):
        print(f"{'ok' if good else 'FAIL':5s}{name}: {found}", flush=True)
        if not good:
            self.faults.append(name)

    def bytes_of_files(self):
        return {path.name: path.read_bytes() for path in self.folder.iterdir() if path.is_file()}

    def expect_refusal(self, name, command, words):
        """Exit code 2, one message with these words, and every file as it was."""
        before = self.bytes_of_files()
        try:
            done = self.run(*command)
        except subprocess.TimeoutExpired:
            self.check(False, name, f"waits for more than {SECONDS} s")
            return
        message = done.stderr.strip()
        good = done.returncode == 2 and len(message.splitlines()) == 1 and all(word in message for word in words)
        self.check(good and self.bytes_of_files() == before, name, f"exit code {done.returncode}, {message}")


def outputs(bench):
    scene = "scene.toml"
    os.link(bench.folder / "cloud.vdb", bench.folder / "hard.h5")
    os.symlink("cloud.vdb", bench.folder / "soft.h5")
    os.symlink("coming.h5", bench.folder / "to_coming.h5")
    for name in ("hard.h5", "soft.h5", "./cloud.vdb", f"../{bench.folder.name}/cloud.vdb"):
        bench.expect_refusal(f"result over the cloud as {name}", ["run", scene, "--quiet", "-o", name], ["overwrite an input", "cloud.vdb"])
        bench.expect_refusal(f"sweep over the cloud as {name}", ["sweep", scene, "--quiet", "--set", "sun.zenith_deg=0,30", "-o", name], ["overwrite an input", "cloud.vdb"])
        bench.expect_refusal(f"checkpoint over the cloud as {name}", ["run", scene, "--quiet", "-o", "r.h5", "--checkpoint", name], ["overwrite an input", "cloud.vdb"])
    overwrites = [("one file for result and checkpoint", ["run", scene, "-o", "coming.h5", "--checkpoint", "to_coming.h5"], ["checkpoint would overwrite the result"]),
                  ("names that differ by case", ["run", scene, "-o", "coming.h5", "--checkpoint", "COMING.h5"], ["checkpoint would overwrite the result"]),
                  ("a dry run", ["run", scene, "--dry-run", "-o", "cloud.vdb"], ["overwrite an input"])]
    # A part of a spectrum's checkpoint has a name that the user has not typed.
    os.rename(bench.folder / "cloud.vdb", bench.folder / "state.1")
    for name in (scene, "spectrum.toml"):
        text = (bench.folder / name).read_text()
        (bench.folder / name).write_text(text.replace("cloud.vdb", "state.1"))
    bench.expect_refusal("part of a checkpoint over the cloud", ["run", "spectrum.toml", "--quiet", "-o", "r.h5", "--checkpoint", "state"], ["state.1", "overwrite an input"])
    os.rename(bench.folder / "state.1", bench.folder / "cloud.vdb")
    for name in (scene, "spectrum.toml"):
        text = (bench.folder / name).read_text()
        (bench.folder / name).write_text(text.replace("state.1", "cloud.vdb"))
    (bench.folder / "moments.txt").write_text("0 1\n1 0.5\n2 0.1\n")
    overwrites += [("result over a checkpoint's part", ["run", "spectrum.toml", "-o", "state.2", "--checkpoint", "state"], ["checkpoint would overwrite the result"]),
                   ("checkpoint of one wavelength over that of another", ["run", "spectrum.toml", "-o", "r.h5", "--checkpoint", "a", "--resume", "b"], ["a.1", "overwrite an input"]),
                   ("result over the checkpoint to go on from", ["run", scene, "-o", "moments.txt", "--resume", "moments.txt"], ["overwrite an input"]),
                   ("plot over the cloud", ["cloud", "info", "cloud.vdb", "--plot", "soft.h5"], ["plot would overwrite an input"]),
                   ("table and plot of one name", ["tradeoff", scene, "--csv", "a.csv", "--plot", "./a.csv"], ["plot would overwrite the table"]),
                   ("plot over a reference", ["tradeoff", scene, "--reference", "moments.txt", "--plot", "moments.txt"], ["overwrite an input"]),
                   ("phase plot over its moments", ["phase", "legendre", "--file", "moments.txt", "--plot", "moments.txt"], ["overwrite an input"]),
                   ("phase plot and figures of one name", ["phase", "isotropic", "--plot", "a.png", "-o", "A.png"], ["overwrite the plot"]),
                   ("optics over the profile", ["gas", "optics", "moments.txt", "--model", "a.phase.csv", "-o", "moments.txt"], ["optics would overwrite an input"]),
                   ("import over its input", ["cloud", "import", "moments.txt", "-o", "moments.txt"], ["cloud would overwrite an input"]),
                   ("import over its profile", ["cloud", "import", "a.phase.csv", "--profile", "air.vdb", "-o", "air.vdb"], ["cloud would overwrite an input"]),
                   ("import over a further file", ["cloud", "import", "a.phase.csv", "--with", "air.vdb", "-o", "air.vdb"], ["cloud would overwrite an input"]),
                   ("phase functions over the import's input", ["cloud", "import", "a.phase.csv", "-o", "a.vdb"], ["phase functions would overwrite an input"])]
    os.symlink("b.2", bench.folder / "a.1")  # what the second wavelength is to go on from
    (bench.folder / "b.2").write_text("state")
    (bench.folder / "a.phase.csv").write_text("0 0 0 1\n")
    for name, command, words in overwrites:
        bench.expect_refusal(name, command, words)
    done = bench.run("run", scene, "--quiet", "-o", "result.h5")
    bench.check(done.returncode == 0, "a result", done.stderr)
    for ending in ("png", "svg", "pdf"):
        for name in ("a", "b"):
            done = bench.run("render", "result.h5", "-o", f"{name}.{ending}")
            bench.check(done.returncode == 0, f"a figure {name}.{ending}", done.stderr)
        bench.check((bench.folder / f"a.{ending}").read_bytes() == (bench.folder / f"b.{ending}").read_bytes(), f"the same {ending} twice", "")
    bench.expect_refusal("render over the result", ["render", "result.h5", "-o", "./result.h5"], ["picture would overwrite an input"])
    bench.expect_refusal("export over the result", ["export", "result.h5", "--vdb", "result.h5", "--actinic"], ["grids would overwrite an input"])
    table = next((bench.folder / "cache" / "cloudbow").glob("scattering-*.table"))
    bench.expect_refusal("result over a table of the cache", ["run", scene, "-o", table], ["table in the cache's folder"])


def pipes(bench):
    os.mkfifo(bench.folder / "pipe")
    scene = (bench.folder / "scene.toml").read_text()
    for name, text in (("cloud", scene.replace('"cloud.vdb"', '"pipe"')), ("albedo map", scene.replace("albedo = 0.05", 'albedo_map = "pipe"')),
                       ("phase function", scene.replace('"henyey-greenstein"\nasymmetry_parameter = 0.85', '"legendre"\nfile = "pipe"'))):
        (bench.folder / "piped.toml").write_text(text)
        bench.expect_refusal(f"a pipe as {name}", ["run", "piped.toml", "-o", "r.h5"], ["pipe", "a named pipe"])
    for name, command in (("scene", ["run", "pipe", "-o", "r.h5"]), ("checkpoint", ["run", "scene.toml", "-o", "r.h5", "--resume", "pipe"]),
                          ("reference", ["tradeoff", "scene.toml", "--levels", "draft", "--reference", "pipe"]), ("cloud to describe", ["cloud", "info", "pipe"]),
                          ("cloud to import", ["cloud", "import", "pipe", "-o", "r.vdb"]), ("gas model", ["gas", "info", "pipe"]), ("moments", ["phase", "legendre", "--file", "pipe"]),
                          ("result to draw", ["render", "pipe", "-o", "r.png"]), ("result to export", ["export", "pipe", "--vdb", "r.vdb", "--actinic"])):
        bench.expect_refusal(f"a pipe as {name}", command, ["pipe", "a named pipe"])
    for table in (bench.folder / "cache" / "cloudbow").glob("scattering-*.table"):
        table.unlink()
        os.mkfifo(table)
    done = bench.run("run", "scene.toml", "--quiet", "-o", "result.h5")
    bench.check(done.returncode == 0, "pipes as tables of the cache", f"exit code {done.returncode}, {done.stderr}")
    for table in (bench.folder / "cache" / "cloudbow").glob("scattering-*.table"):
        table.unlink()
        table.mkdir()
    done = bench.run("run", "scene.toml", "--quiet", "-o", "result.h5")
    bench.check(done.returncode == 0, "folders as tables of the cache", f"exit code {done.returncode}, {done.stderr}")


def results(bench):
    result = bench.folder / "result.h5"
    bench.run("run", "scene.toml", "--quiet", "-o", "result.h5")
    result.chmod(0o600)
    bench.run("run", "scene.toml", "--quiet", "-o", "result.h5")
    mode = stat.S_IMODE(result.stat().st_mode)
    bench.check(mode == 0o600, "permissions of a result", oct(mode))
    (bench.folder / "elsewhere").mkdir()
    os.symlink("elsewhere/new.h5", bench.folder / "link.h5")
    bench.run("run", "scene.toml", "--quiet", "-o", "link.h5")
    bench.check((bench.folder / "link.h5").is_symlink() and h5py.is_hdf5(bench.folder / "elsewhere" / "new.h5"), "a result through a link", sorted(os.listdir(bench.folder / "elsewhere")))


def locks(bench):
    done = bench.run("run", "scene.toml", "--quiet", "-o", "result.h5", "--checkpoint", "state.h5")
    assert done.returncode == 0, done.stderr
    for name, command in (("result.h5", ["render", "result.h5", "-o", "r.png"]), ("result.h5", ["tradeoff", "scene.toml", "--levels", "draft", "--reference", "result.h5"]),
                          ("state.h5", ["run", "scene.toml", "--quiet", "-o", "r.h5", "--resume", "state.h5"]), ("result.h5", ["cloud", "import", "result.h5", "-o", "r.vdb"])):
        with open(bench.folder / name) as file:
            fcntl.flock(file, fcntl.LOCK_EX)
            bench.expect_refusal(f"{command[0]} of a locked file", command, [name, "is locked"])


def not_finite(bench):
    bench.run("run", "scene.toml", "--quiet", "-o", "result.h5", "--checkpoint", "state.h5")
    with h5py.File(bench.folder / "state.h5", "r+") as file:
        radiance = file["radiance"]
        spoiled = radiance[()]
        del file["radiance"]
        spoiled[0, 0] = np.nan
        file["radiance"] = spoiled
    (bench.folder / "result.h5").unlink()
    bench.expect_refusal("a checkpoint that holds NaN", ["run", "scene.toml", "--quiet", "-o", "result.h5", "--resume", "state.h5"], ["state.h5", "radiance", "not finite"])


def streams(bench):
    """A reader of stderr that has gone ends no run; nor do streams that were closed at the start."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run([bench.program, "run", "spectrum.toml", "-o", "piped.h5"], cwd=bench.folder, env=bench.environment, stdout=subprocess.DEVNULL, stderr=writer,
                          timeout=SECONDS)
    os.close(writer)
    bench.check(done.returncode == 0 and (bench.folder / "piped.h5").exists(), "stderr into a pipe without a reader", f"exit code {done.returncode}")
    for closed in ("<&- >&-", "<&- >&- 2>&-", ">&-", "<&-"):
        (bench.folder / "closed.h5").unlink(missing_ok=True)
        done = subprocess.run(["sh", "-c", f'"$0" run scene.toml -o closed.h5 {closed}', bench.program], cwd=bench.folder, env=bench.environment, timeout=SECONDS,
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        bench.check(done.returncode == 0 and h5py.is_hdf5(bench.folder / "closed.h5"), f"a run with {closed}", f"exit code {done.returncode}")
    done = subprocess.run(["sh", "-c", '"$0" render scene.toml -o r.png <&- >&-', bench.program], cwd=bench.folder, env=bench.environment, timeout=SECONDS,
                          capture_output=True, text=True)
    bench.check(done.returncode == 2 and "scene.toml: can't be read" in done.stderr, "a message of the child process with <&- >&-", done.stderr.strip())


def memory(bench):
    """Under a limit of memory: the result, or one message that does not call the file damaged for it."""
    bench.run("run", "scene.toml", "--quiet", "-o", "result.h5", "--checkpoint", "state.h5")
    for megabytes in range(100, 1001, 50):
        for command in (["cloud", "info", "cloud.vdb"], ["render", "result.h5", "-o", "r.png"], ["run", "scene.toml", "--dry-run", "--threads", 1]):
            done = bench.run(*command, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (megabytes * 1000000,) * 2))
            name = f"{command[0]} with {megabytes} MB"
            message = done.stderr.strip()
            if done.returncode == 127 and "loading shared libraries" in message:
                continue  # the program did not begin
            bench.check(done.returncode in (0, 1, 2) and len(message.splitlines()) == (0 if done.returncode == 0 else 1) and ("damaged" not in message or "ulimit" in message),
                        name, f"exit code {done.returncode} {message}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True)
    options = parser.parse_args()
    faults = []
    for part in (outputs, pipes, results, locks, not_finite, streams, memory):
        with tempfile.TemporaryDirectory(prefix="cloudbow-files-") as name:
            bench = Bench(options.cloudbow, Path(name).resolve())
            part(bench)
            faults += bench.faults
    print("\n" + "\n".join(faults or ["nothing is destroyed, waited for or called damaged"]))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
