#!/usr/bin/env python3
"""The tree has one version: that of CMakeLists.txt, of CITATION.cff and of the first heading of CHANGELOG.md below "Unreleased".

usage: check_release.py ROOT [--tag vVERSION]     (--tag: can the tree be tagged so? The heading has a date, and nothing is unreleased.)
"""
import re
import sys
from pathlib import Path

HEADING = re.compile(r"^## (\d+\.\d+\.\d+)(?: - (\d{4}-\d{2}-\d{2}))?$", re.MULTILINE)


def faults(cmake, citation, changelog, tag=None):
    version = re.search(r"^project\(\w+ VERSION (\S+)", cmake, re.MULTILINE)[1]
    found = []
    if (cited := re.search(r"^version: (\S+)$", citation, re.MULTILINE)[1]) != version:
        found.append(f"CITATION.cff: version {cited}, in CMakeLists.txt {version}")
    unreleased = re.search(r"^## Unreleased$", changelog, re.MULTILINE)
    latest = HEADING.search(changelog)
    if not unreleased or not latest or unreleased.start() > latest.start():
        return [*found, 'CHANGELOG.md: no "## Unreleased" above the first "## VERSION"']
    if latest[1] != version:
        found.append(f"CHANGELOG.md: the latest version is {latest[1]}, in CMakeLists.txt {version}")
    if tag is not None:
        if tag != f"v{version}":
            found.append(f"tag {tag}: the version is {version}")
        if latest[2] is None:
            found.append(f'CHANGELOG.md: "## {latest[1]}" has no date')
        if changelog[unreleased.end():latest.start()].strip():
            found.append("CHANGELOG.md: lines below Unreleased")
    return found


def check_itself():
    cmake, citation = "project(a VERSION 1.2.3 X)\n", "version: 1.2.3\n"
    assert not faults(cmake, citation, "## Unreleased\n\n- a\n\n## 1.2.3\n")
    assert not faults(cmake, citation, "## Unreleased\n\n## 1.2.3 - 2026-01-31\n\n- a\n", "v1.2.3")
    assert len(faults(cmake, "version: 1.2.4\n", "## Unreleased\n\n## 1.2.2\n")) == 2
    assert len(faults(cmake, citation, "## 1.2.3\n")) == 1
    assert len(faults(cmake, citation, "## Unreleased\n\n- a\n\n## 1.2.3\n", "v1.2.4")) == 3


def main():
    check_itself()
    root = Path(sys.argv[1])
    tag = sys.argv[sys.argv.index("--tag") + 1] if "--tag" in sys.argv else None
    found = faults(*((root / name).read_text() for name in ("CMakeLists.txt", "CITATION.cff", "CHANGELOG.md")), tag)
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
