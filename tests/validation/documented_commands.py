#!/usr/bin/env python3
"""The content of README, tutorial and how-tos runs: commands, scenes and Python of the pages. Each page has a folder of its own, and its order is kept.

Truth: the pages. Blocks `sh` are run line by line, and so is a command in running text that names its files; `toml` is saved under the name that the
page gives it, or completed by what PAGES has for it, and must be accepted; `python` is run. A block `text` below commands shows what they print: words
and numbers are those printed, numbers with an exponent (rounding, estimates) within a factor of ten. A command with placeholders in it, and one that
names no file, is held against --help. C++ and CMake of docs/cpp-api.md are built by tests/consumer.

usage: documented_commands.py --cloudbow PROGRAM [--slow] [--part I/N] [PAGE...]      (default: all pages, without what is slow)
"""
import argparse
import importlib.util
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import support

ROOT = Path(__file__).resolve().parents[2]

# Not run, by how they begin; the reason.
ELSEWHERE = {
    "scripts/run": "installs and builds",
    "scripts/test": "installs, builds and runs this",
    "scripts/validate": "builds, and takes minutes",
    "build/release/tests/reference/plane_parallel": "built by scripts/validate; tests/validation/plane_parallel_truths.py runs it",
    "python3 tests/validation/plane_parallel.py": "needs the one before",
    "cmake --preset": "builds",
    "cmake --install": "installs; tests/consumer does it",
    "apt-get install": "installs",
    "export PYTHONPATH": "for the shell of the reader",
    "CLOUDBOW_REFERENCE_DIR=": "needs the reference data of others",
    "build/release/src/cloudbow run configs/cumulus.toml": "the first command of the page once more",
}
# Run with --slow alone: processor time of a balanced solve of a field and more.
SLOW = {
    "cloudbow run configs/gallery/": "minutes: cameras, three wavelengths",
    "cloudbow render sunset.h5": "needs the one before",
    "cloudbow render satellite.h5": "needs the one before",
    "cloudbow render aircraft.h5": "needs the one before",
}
# Modules of Python that may be missing, each by the part that must be there.
OPTIONAL = {"pyopenvdb": "pyopenvdb", "cloudbow": "cloudbow._core"}

SUN = "[sun]\nzenith_deg = 60.0\nazimuth_deg = 0.0\n"
CUMULUS = '[cloud]\nfile = "../clouds/fair_weather_cumulus.vdb"\nquantity = "extinction"\nsingle_scattering_albedo = 1.0\nphase_function = "droplets"\n'
CELLS = "# nx,ny,nz=2,2,3 dx=0.05 km dy=0.05 km\n# z levels km: 0.1 0.2 0.3\nix,iy,iz,extinction_per_km,ssa,iphase\n0,0,0,10,0.99,1\n1,1,2,20,1,2\n"
MOMENTS = "0 1 1\n1 0.5 0.4\n2 0.3 0.2\n"
THERMAL = "[cloud]" + (ROOT / "configs/thermal_cumulus.toml").read_text().partition("[cloud]")[2].partition("[output]")[0]
GAS = {"gas_solar.nc": "gas/ecckd-1.4_sw_climate_rgb-32b_ckd-definition.nc", "gas_longwave.nc": "gas/ecckd-1.0_lw_climate_fsck-32b_ckd-definition.nc",
       "droplets.nc": "gas/mie_droplet_scattering.nc"}
STEP_CLOUD = (ROOT / "configs/step_cloud.toml").read_text()


@dataclass
class Page:
    files: dict = field(default_factory=dict)        # that the page takes for given: name, text
    before: list = field(default_factory=list)       # commands that make such files
    completions: list = field(default_factory=list)  # of the blocks `toml` without a name, in their order: what the page leaves out
    shows: tuple = ()                                 # blocks `text` that no command printed, by a word in them
    references: dict = field(default_factory=dict)   # name, path below CLOUDBOW_REFERENCE_DIR

    # Commands name files of others: they are held against --help.
    others_files: bool = False


PAGES = {
    "README.md": Page(completions=[""]),
    "docs/install.md": Page(),
    "docs/tutorial.md": Page(),
    "docs/models.md": Page(others_files=True),
    "docs/formats.md": Page(),
    "docs/scene-reference.md": Page(),
    "docs/limits.md": Page(),
    "docs/design-notes.md": Page(),
    "docs/from-les-to-fluxes.md": Page(files={"cells.csv": CELLS, "moments.csv": MOMENTS}, completions=[SUN]),
    "docs/droplets.md": Page(before=["scripts/examples/make_les_file.py les.nc", "cloudbow cloud import les.nc --time 1 --minimum 0.003 -o les.vdb"], completions=[SUN]),
    "docs/radiance-fields.md": Page(shows=("sin(zenith)",)),
    "docs/figures.md": Page(),
    "docs/pictures.md": Page(completions=[SUN + CUMULUS + "effective_radius_um = 10.0\n", SUN + CUMULUS + '[phase_function.droplets]\ntype = "isotropic"\n']),
    "docs/howto-thermal.md": Page(completions=["", THERMAL]),
    "docs/howto-heating-rates.md": Page(references=GAS),
    "docs/howto-cloud-effect.md": Page(references=GAS),
    "docs/howto-3d-effects.md": Page(),
    "docs/howto-satellite.md": Page(),
    "docs/howto-solar-energy.md": Page(),
    "docs/howto-references.md": Page(),
    "docs/howto-sweeps.md": Page(),
    "docs/accuracy.md": Page(files={"scene.toml": STEP_CLOUD}, shows=("flux errors, about", "can't be promised")),
    "docs/checkpoints.md": Page(files={"scene.toml": STEP_CLOUD}),
    "docs/verify.md": Page(),
    "docs/phase-function-fits.md": Page(files={"measured.txt": "0 2\n90 0.5\n180 1\n"}),
    "docs/result-reference.md": Page(before=["cloudbow run configs/slab.toml"]),
    "docs/cpp-api.md": Page(),
}


def without_generated(text):
    """Tables between markers are made by scripts of their own."""
    return re.sub(r"<!-- begin ([\w-]+) -->.*?<!-- end \1 -->", "", text, flags=re.DOTALL)


def parts_of(text):
    """(kind, text, words before) of fenced blocks and of commands in running text, in the order of a page."""
    part = re.compile(r"^```([^\n]*)\n(.*?)^```$|(?<!`)`(cloudbow [^`\n]+)`", re.MULTILINE | re.DOTALL)
    for found in part.finditer(without_generated(text)):
        before = text[max(0, found.start() - 200):found.start()]
        yield ("inline", found.group(3), before) if found.group(3) else (found.group(1).strip(), found.group(2), before)


def lines_of(block):
    """Commands of a block `sh`."""
    for line in block.replace("\\\n", " ").splitlines():
        line = re.sub(r"(^|\s)# .*$", "", line).strip()
        if line:
            yield line


def has_placeholder(command):
    return re.search(r"\.\.\.|[\[|][-\w]|\b[A-Z]{3,}\b|\bN\b", re.sub(r"^[A-Z_]+=\S+ |'[^']*'", "", command)) is not None


def names_a_file(command):
    return re.search(r"\.(toml|h5|vdb|png|nc|txt|csv)\b", command) is not None


def agree(shown, printed):
    """Whether a line of a page is what a program printed."""
    shown, printed = shown.split(), printed.split()
    return len(shown) == len(printed) and all(word == other or near(word, other) for word, other in zip(shown, printed))


def near(word, other):
    number = r"-?\d+(\.\d+)?e[-+]\d+"
    if not (re.fullmatch(number, word) and re.fullmatch(number, other)):
        return False
    a, b = float(word), float(other)
    return a == b or (a * b > 0 and 0.1 <= a / b <= 10)


class Runner:
    def __init__(self, cloudbow, folder, slow):
        self.cloudbow, self.folder, self.slow = cloudbow, folder, slow
        self.faults, self.left_out = [], []
        # Of the same build.
        self.package = cloudbow.parents[1] / "python"
        sys.path.append(str(self.package))
        (folder / "bin").mkdir()
        (folder / "bin/cloudbow").symlink_to(cloudbow)
        (folder / "pages").mkdir()
        # The folder that scenes of the pages look for: ../clouds and ../../clouds.
        (folder / "clouds").symlink_to(ROOT / "clouds")
        (folder / "pages/clouds").symlink_to(ROOT / "clouds")
        self.environment = {**os.environ, "PATH": f"{folder / 'bin'}:/usr/bin:{os.environ['PATH']}", "XDG_CACHE_HOME": str(folder / "cache"), "MPLBACKEND": "Agg",
                            "PYTHONPATH": f"{ROOT / 'docs/examples'}:{self.package}", "PYTHONDONTWRITEBYTECODE": "1"}
        self.help = {}

    def fault(self, what):
        self.faults.append(f"{self.page}: {what}")
        print(f"FAIL  {what}", flush=True)

    def call(self, words, label):
        start = time.monotonic()
        done = subprocess.run(words, cwd=self.place, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.printed += done.stdout.splitlines()
        print(f"{time.monotonic() - start:6.1f} s  {label}", flush=True)
        if done.returncode != 0:
            self.fault(f"{label}: exit code {done.returncode}\n{done.stdout}")
        return done.returncode == 0

    def skip(self, command, reasons):
        for begin, reason in reasons.items():
            if command.startswith(begin):
                self.left_out.append(f"{self.page}: {command} ({reason})")
                return True
        return False

    def command(self, command, in_text):
        if self.skip(command, ELSEWHERE):
            return
        if self.others_files or has_placeholder(command) or (in_text and not names_a_file(command)):
            self.check_words(command)
        elif self.slow or not self.skip(command, SLOW):
            self.ran_any = True
            self.call(["bash", "-c", command], command)

    def help_of(self, words):
        if words not in self.help:
            done = subprocess.run([self.cloudbow, *words, "--help"], capture_output=True, text=True)
            self.help[words] = done.stdout if done.returncode == 0 else None
        return self.help[words]

    def check_words(self, command):
        """Its subcommands and options are there. Values may be anything."""
        words = re.sub(r"[\[\]|]", " ", re.sub(r"^[A-Z_]+=\S+ ", "", command)).split()
        if words[0] != "cloudbow":
            return
        path = tuple(words[1:3]) if words[1] in ("cloud", "gas") else tuple(words[1:2])
        text = self.help_of(path)
        if text is None:
            return self.fault(f"{command}: no such command")
        for option in re.findall(r"(?<![\w-])--?[a-z][\w-]*", " ".join(words)):
            if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", text):
                self.fault(f"{command}: no option {option}")

    def scene(self, block, before):
        name = re.search(r"Save this as `([^`]+)`:\s*$", before) or re.match(r"# (\S+\.toml)\n", block)
        file = name.group(1) if name else "scene.toml"
        if not name:
            if not self.completions:
                return self.fault(f"a scene without a name and completion: {block.splitlines()[0]}")
            block += self.completions.pop(0)
        (self.place / file).write_text(block)
        # One that the page names is run by the page, after the files it names were made.
        if not name:
            self.call(["cloudbow", "run", file, "--dry-run"], f"the scene of the page: {block.splitlines()[0]}")

    def python(self, block):
        missing = [module for module, part in OPTIONAL.items() if re.search(rf"^import {module}", block, re.MULTILINE) and importlib.util.find_spec(part) is None]
        if missing:
            self.left_out.append(f"{self.page}: Python: {', '.join(missing)} is not installed")
            return
        (self.place / "snippet.py").write_text(block)
        self.call([sys.executable, "snippet.py"], f"Python: {block.splitlines()[0]}")

    def output(self, block, shows):
        if not self.ran_any or any(word in block for word in shows):
            return
        for line in filter(str.strip, block.splitlines()):
            if not any(agree(line, printed) for printed in self.printed):
                self.fault(f"nothing printed this line: {line}")

    def run(self, page):
        self.page, plan = page, PAGES[page]
        self.others_files = plan.others_files
        print(f"\n{page}", flush=True)
        reference = support.reference_folder()
        missing = [path for path in plan.references.values() if reference is None or not (reference / path).exists()]
        if missing:
            self.left_out.append(f"{page}: all of it (no {', '.join(missing)} in the folder that CLOUDBOW_REFERENCE_DIR names)")
            print("left out: needs the reference data of others", flush=True)
            return
        self.place = self.folder / "pages" / page.replace("/", "_")
        (self.place / "build/release/src").mkdir(parents=True)
        (self.place / "build/release/src/cloudbow").symlink_to(self.cloudbow)
        for name in ("configs", "clouds", "docs", "scripts", "tests"):
            (self.place / name).symlink_to(ROOT / name)
        self.printed, self.ran_any, self.completions = [], False, list(plan.completions)
        for name, text in plan.files.items():
            (self.place / name).write_text(text)
        for name, path in plan.references.items():
            (self.place / name).symlink_to(reference / path)
        for command in plan.before:
            self.call(["bash", "-c", command], command)
        text = (ROOT / page).read_text()
        for kind, block, before in parts_of(text):
            if kind == "sh":
                self.ran_any = False
                for line in lines_of(block):
                    self.command(line, in_text=False)
            elif kind == "inline":
                self.command(block, in_text=True)
            elif kind == "toml":
                self.scene(block, before)
            elif kind == "python":
                self.python(block)
            elif kind == "text":
                self.output(block, plan.shows)
            elif kind not in ("cpp", "cmake"):
                self.fault(f"a block of kind '{kind}' (allowed: sh, toml, python, text, cpp, cmake): {block.splitlines()[0]}")
        if self.completions:
            self.fault(f"{len(self.completions)} scenes less than PAGES has completions")


def check_itself():
    text = "Save this as `a.toml`:\n\n```toml\nx = 1\n```\n\nSee `cloudbow run a.toml` and `b`.\n\n```sh\ncloudbow \\\n  verify   # why\n```\n<!-- begin t -->\n```\n1\n```\n<!-- end t -->\n"
    found = list(parts_of(text))
    assert [part[0] for part in found] == ["toml", "inline", "sh"], found
    assert list(lines_of(found[2][1])) == ["cloudbow    verify"], found[2]
    assert has_placeholder("cloudbow run SCENE.toml") and has_placeholder("cloudbow mie [--quiet]") and not has_placeholder("cloudbow run a.toml --set 'x=[\"A\"]'")
    assert agree("a 1.5e-04  b", "a  3.0e-04 b") and not agree("a 1.5e-04 b", "a 3.0e-02 b") and not agree("2 of 14", "3 of 14")


def main():
    check_itself()
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cloudbow", required=True, type=Path)
    parser.add_argument("--slow", action="store_true", help="what takes minutes, too")
    parser.add_argument("--part", default="1/1", metavar="I/N", help="every Nth page, from the Ith on")
    parser.add_argument("pages", nargs="*", metavar="PAGE", help=", ".join(PAGES))
    options = parser.parse_args()
    if unknown := sorted(set(options.pages) - set(PAGES)):
        parser.error(f"no such page (found {', '.join(unknown)}, allowed {', '.join(PAGES)})")
    if not (part := re.fullmatch(r"(\d+)/(\d+)", options.part)) or not 1 <= int(part[1]) <= int(part[2]):
        parser.error(f"--part: not I/N (found {options.part}, allowed 1/4, 2/4 ...)")
    first, step = int(part[1]) - 1, int(part[2])
    with tempfile.TemporaryDirectory(prefix="cloudbow-documented-") as folder:
        runner = Runner(options.cloudbow.resolve(), Path(folder), options.slow)
        for page in list(options.pages or PAGES)[first::step]:
            runner.run(page)
        print("\nnot run:", *runner.left_out, sep="\n  ")
        print("\n" + ("\n".join(runner.faults) or "what the pages show runs"))
    return 1 if runner.faults else 0


if __name__ == "__main__":
    sys.exit(main())
