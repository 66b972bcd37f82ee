#!/usr/bin/env python3
"""Links in the documentation lead somewhere: files are there, headings too, and every page of docs/ stands in the site's navigation. So do names of
files that begin at the root of the tree, as in `src/main.cpp`; a name in capitals (NAME, LAYER) stands for any.

Truth: the tree. Addresses of the web are left alone. The checker checks itself on a page with known faults first.

usage: check_links.py ROOT
"""
import re
import sys
import tempfile
from pathlib import Path

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")

# A file of the tree, by its name from the root.
NAMED = re.compile(r"(?<![\w/.-])(?:cmake|docs|include|scripts|src|tests)/[\w/.-]*\.(?:cpp|hpp|py|md|txt|in|csv|json)\b(?!/)")


def without_code(text):
    return re.sub(r"`[^`\n]*`", lambda span: "x" * len(span.group()), re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL))


def anchors(text):
    """Of headings, as GitHub and the site make them: lower case, without punctuation, blanks to hyphens."""
    found = set()
    for heading in re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```", "", text, flags=re.MULTILINE | re.DOTALL), re.MULTILINE):
        name = re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")
        found.add(name)
    return found


def faults_of(page):
    found = []
    for target in LINK.findall(without_code(page.read_text())):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = page.parent / name if name else page
        if not file.exists():
            found.append(f"{page}: {target}: no such file")
        elif anchor and file.suffix == ".md" and anchor not in anchors(file.read_text()):
            found.append(f"{page}: {target}: no such heading")
    return found


def missing_files(page, root):
    """Names of files of the tree that are not there."""
    named = [name for name in NAMED.findall(page.read_text()) if not re.search(r"[A-Z]{2,}", Path(name).stem.replace("README", "") + str(Path(name).parent))]
    return [f"{page}: {name}: no such file in the tree" for name in named if not (root / name).is_file()]


def check_itself():
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / "page.md"
        page.write_text("# One (two)\n[a](#one-two) [b](page.md#one-two) [c](https://x.org/y) `[d](none.md)`\n")
        assert faults_of(page) == [], faults_of(page)
        page.write_text("# One\n[a](#two) [b](none.md) ![c](none.png)\n```\n# two\n```\n")
        assert len(faults_of(page)) == 3, faults_of(page)
        (page.parent / "src").mkdir()
        (page.parent / "src/a.cpp").write_text("")
        page.write_text("`src/a.cpp`, src/b.hpp, `src/test_NAME.cpp`, build/src/c.cpp, `src/LAYER/a.cpp`")
        assert len(missing_files(page, page.parent)) == 1, missing_files(page, page.parent)


def main():
    check_itself()
    root = Path(sys.argv[1])
    pages = [path for path in sorted(root.rglob("*.md")) if not {"build", ".git"} & set(path.relative_to(root).parts)]
    faults = [fault for page in pages for fault in faults_of(page)]
    # The changelog and reports of what was measured speak of the tree as it was.
    faults += [fault for page in pages if page.name != "CHANGELOG.md" for fault in missing_files(page, root)]
    navigation = (root / "mkdocs.yml").read_text()
    named = set(re.findall(r"[\w\-/]+\.md", navigation))
    there = {path.relative_to(root / "docs").as_posix() for path in (root / "docs").rglob("*.md")}
    faults += [f"docs/{page}: not in the navigation of mkdocs.yml" for page in sorted(there - named)]
    faults += [f"mkdocs.yml: docs/{page} is not there" for page in sorted(named - there)]
    print("\n".join(faults) or f"{len(pages)} pages")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
