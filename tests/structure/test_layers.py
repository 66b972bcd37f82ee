#!/usr/bin/env python3
"""Arrows point down: no file includes a layer above its own, public headers hide every third-party library but Eigen, and a library is
seen only in the layers it is for. (A header in src/ is private to its layer: no other may include it.)

Truth: the layers of docs/architecture.md. The first class checks the tree, the second checks the checker on trees with known faults.
"""
import re
import sys
import tempfile
import unittest
from pathlib import Path

LAYERS = ["core", "sphere", "optics", "medium", "transport", "results", "app"]
ROOT = Path(sys.argv.pop(1)) if len(sys.argv) > 1 and Path(sys.argv[1]).is_dir() else Path(__file__).resolve().parents[2]

# A library's headers, and the layers whose .cpp files may see them.
THIRD_PARTY = {
    r"openvdb/": {"medium"},
    r"(hdf5|hdf5_hl|H5\w*)\.h": {"core", "results"},
    r"netcdf\.h": {"medium", "results"},
    r"png\.h": {"medium", "results"},
    r"zlib\.h": {"results"},
    r"toml\+\+/|toml\.hpp": {"app"},
    r"CLI/": {"app"},
    r"(Clp|Coin)\w*\.(hpp|h)": {"optics", "sphere"},
    r"boost/|tbb/|Imath/": set(),
}
# Nothing but Eigen and the C++ standard library may stand in a public header; the latter's names have no dot and no slash.
ALLOWED_IN_PUBLIC_HEADERS = re.compile(r"(Eigen/\w+|[a-z0-9_]+)")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.MULTILINE)


def layer_of(path, root):
    """The layer a file of the tree belongs to; main.cpp stands above all of them."""
    parts = path.relative_to(root).parts
    if parts[:2] == ("include", "cloudbow") and len(parts) > 3:
        return parts[2]
    if parts[0] == "src":
        return parts[1] if len(parts) > 2 else "main"
    return None


def violations(root):
    found = []
    rank = {name: i for i, name in enumerate(LAYERS + ["main"])}
    for path in sorted([*root.glob("include/**/*.h*"), *root.glob("src/**/*.h*"), *root.glob("src/**/*.cpp")]):
        layer = layer_of(path, root)
        if layer not in rank:
            found.append(f"{path.relative_to(root)}: is in no layer (layers: {', '.join(LAYERS)})")
            continue
        public = path.relative_to(root).parts[0] == "include"
        text = path.read_text()
        for match in INCLUDE.finditer(text):
            target = match.group(2)
            place = f"{path.relative_to(root)}:{text.count(chr(10), 0, match.start()) + 1}"
            own = re.match(r"cloudbow/(\w+)/", target)
            if own:
                if own.group(1) not in rank:
                    found.append(f"{place}: includes {target}, which is in no layer")
                elif rank[own.group(1)] > rank[layer]:
                    found.append(f"{place}: {layer} includes {target}, which is above it")
                continue
            if match.group(1) == '"':
                # A file's private neighbour, or a generated header. It must not lead out of the layer.
                if target.startswith("..") or (root / "src" / target).is_file() and not target.startswith(layer + "/"):
                    found.append(f"{place}: includes {target} from outside its layer")
                continue
            if public and not ALLOWED_IN_PUBLIC_HEADERS.fullmatch(target) and not re.fullmatch(r"\w+intrin\.h", target):
                found.append(f"{place}: public header includes third-party <{target}> (only Eigen may stand there)")
            for pattern, layers in THIRD_PARTY.items():
                if re.match(pattern, target) and layer not in layers:
                    allowed = ", ".join(sorted(layers)) or "no layer"
                    found.append(f"{place}: {layer} includes <{target}> (allowed in: {allowed})")
    return found


class Tree(unittest.TestCase):
    def test_every_layer_is_there(self):
        for layer in LAYERS:
            self.assertTrue(any((ROOT / "src" / layer).glob("*.cpp")), f"src/{layer} has no source file")

    def test_no_include_points_up(self):
        found = violations(ROOT)
        if found:
            self.fail("\n" + "\n".join(found))


class Checker(unittest.TestCase):
    """Each fault is found, and only there."""

    def faults_of(self, **files):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in files.items():
                path = root / name.replace("__", "/").replace("_DOT_", ".")
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return violations(root)

    def test_downward_include_is_fine(self):
        self.assertEqual(self.faults_of(src__transport__a_DOT_cpp='#include "cloudbow/core/error.hpp"\n#include <vector>\n'), [])

    def test_upward_include_is_found(self):
        found = self.faults_of(src__sphere__a_DOT_cpp='#include <vector>\n#include "cloudbow/optics/delta_m.hpp"\n')
        self.assertEqual(found, ["src/sphere/a.cpp:2: sphere includes cloudbow/optics/delta_m.hpp, which is above it"])

    def test_upward_include_in_a_header_is_found(self):
        self.assertEqual(len(self.faults_of(include__cloudbow__core__a_DOT_hpp='#include "cloudbow/app/b.hpp"\n')), 1)

    def test_third_party_in_a_private_header_of_its_layer_is_fine(self):
        self.assertEqual(self.faults_of(src__medium__a_DOT_hpp="#include <openvdb/openvdb.h>\n"), [])

    def test_third_party_in_a_public_header_is_found(self):
        for target in ("openvdb/openvdb.h", "hdf5.h", "fmt/format.h", "toml++/toml.h", "CLI/CLI.hpp", "ClpSimplex.hpp"):
            with self.subTest(target):
                self.assertTrue(self.faults_of(include__cloudbow__medium__a_DOT_hpp=f"#include <{target}>\n"))

    def test_eigen_in_a_header_is_fine(self):
        self.assertEqual(self.faults_of(include__cloudbow__core__a_DOT_hpp="#include <Eigen/Core>\n#include <cstdint>\n"), [])

    def test_library_in_the_wrong_layer_is_found(self):
        self.assertEqual(len(self.faults_of(src__transport__a_DOT_cpp="#include <openvdb/openvdb.h>\n")), 1)

    def test_neighbour_of_another_layer_is_found(self):
        found = self.faults_of(src__core__a_DOT_cpp='#include "../app/b.hpp"\n')
        self.assertEqual(len(found), 1)


if __name__ == "__main__":
    unittest.main()
