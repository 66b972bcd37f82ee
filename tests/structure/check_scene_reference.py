#!/usr/bin/env python3
"""docs/scene-reference.md has the keys that the program accepts, table by table, and no others.

Truth: the program. An unknown key is put into each table; the message lists those that are allowed there.

usage: check_scene_reference.py CLOUDBOW DOCS/SCENE-REFERENCE.MD
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "robustness"))
from made_gas_files import write_gas_model

UNKNOWN = "nobody_knows_this_key"


def documented(text):
    """{(table, type or None): keys} by the headings "## `[table]`" and "### `type = "..."`"; a type has the table's keys too."""
    found, table, kind = {}, "", None
    for line in text.splitlines():
        heading = re.match(r"(##+) (.*)", line)
        if heading and heading.group(1) == "##":
            name = re.match(r"`(\[+[a-z_A-Z.]+\]+)`", heading.group(2))
            table, kind = (name.group(1) if name else ""), None
            found[table, None] = []
        elif heading:
            kind = re.match(r'`type = "([a-z-]+)"`', heading.group(2)).group(1)
            found[table, kind] = list(found[table, None])
        elif row := re.match(r"\| ((?:`[a-z0-9_]+` )+)\|", line):
            found[table, kind] += re.findall(r"`(\w+)`", row.group(1))
    typed = {table for table, kind in found if kind}
    return {place: keys for place, keys in found.items() if place[1] or place[0] not in typed}


class Program:
    def __init__(self, path, folder):
        self.path, self.scene = path, Path(folder) / "scene.toml"
        write_gas_model(Path(folder) / "model.nc", "solar")

    def message(self, text):
        self.scene.write_text(text)
        done = subprocess.run([self.path, "run", self.scene, "--dry-run"], capture_output=True, text=True)
        if done.returncode != 2:
            sys.exit(f"exit code {done.returncode} (2 wanted) of\n{text}")
        return done.stderr

    def allowed(self, table, kind):
        """The keys, by the message on an unknown one."""
        lines = [table.replace("NAME", "x"), *([f'type = "{kind}"'] if kind else []), f"{UNKNOWN} = 1"]
        if kind == "bulk":
            lines += ["[spectrum]", 'gas_model = "model.nc"']
        words = re.search(rf"{UNKNOWN}: unknown key \(found {UNKNOWN}, allowed ([^;)]*)", self.message("\n".join(lines) + "\n"))
        return words.group(1).split(", ") if words else []

    def types(self, table):
        words = re.search(r"allowed ([^)]*)\)", self.message(f'{table.replace("NAME", "x")}\ntype = "{UNKNOWN}"\n'))
        return words.group(1).split(", ")


def main():
    pages = documented(Path(sys.argv[2]).read_text())
    faults = []
    with tempfile.TemporaryDirectory() as folder:
        program = Program(sys.argv[1], folder)
        for (table, kind), keys in pages.items():
            allowed = program.allowed(table, kind)
            if sorted(keys) != sorted(allowed):
                faults.append(f"{table} {kind or ''}: only the page has {sorted(set(keys) - set(allowed))}, only the program {sorted(set(allowed) - set(keys))}")
        for table in {table for table, kind in pages if kind}:
            types = [kind for name, kind in pages if name == table]
            if sorted(types) != sorted(program.types(table)):
                faults.append(f"{table}: types of the page {types}, of the program {program.types(table)}")
    tables = {table.strip("[]").split(".")[0] for table, _ in pages if table}
    scalars = {"title"}
    if tables != set(pages["", None]) - scalars:
        faults.append(f"sections {sorted(tables)}, tables of the root {sorted(set(pages['', None]) - scalars)}")
    print("\n".join(faults) or f"{sum(map(len, pages.values()))} keys of {len(pages)} tables")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
