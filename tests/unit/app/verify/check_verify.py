#!/usr/bin/env python3
"""`cloudbow verify` as a user calls it: all checks hold, in seconds, and docs/verify.md has each of them and no other.

usage: check_verify.py CLOUDBOW DOCS/VERIFY.MD
"""
import json
import os
import re
import subprocess
import sys
from pathlib import Path

program, page = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
# Scenes and tables are made in memory: neither a home nor a cache is needed.
environment = {**os.environ, "HOME": "/nonexistent", "XDG_CACHE_HOME": "/nonexistent"}


def call(*options):
    return subprocess.run([program, "verify", *options], capture_output=True, text=True, env=environment, cwd="/", timeout=300)


done = call("--json")
assert done.returncode == 0, f"exit code {done.returncode}\n{done.stdout}{done.stderr}"
document = json.loads(done.stdout)
assert document["passed"] is True and document["failed_checks"] == 0, document
assert all(check["passed"] and 0 <= check["found"] <= check["tolerance"] and check["unit"] and check["error"] is None for check in document["checks"])

names = [check["name"] for check in document["checks"]]
explained = re.findall(r"^\| `([a-z0-9-]+)` \|", page.read_text(), re.MULTILINE)
assert len(names) > 30 and names == explained, f"found {names}\ndocs/verify.md explains {explained}"

some = call("--only", "beer-law", "azimuth")
assert some.returncode == 0 and [line.split()[0] for line in some.stdout.splitlines()] == ["beer-law", "azimuth", "2"], some.stdout
assert call("--list").stdout.splitlines()[-1].startswith("threads ")
wrong = call("--only", "beers-law")
assert wrong.returncode == 2 and "allowed interpolation-sum" in wrong.stderr and not wrong.stdout, wrong.stderr
