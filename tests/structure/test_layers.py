#!/usr/bin/env python3
"""Arrows point down: no file includes a layer above its own, nor a room above its own within a layer; public headers hide every third-party
library but Eigen, and a library is seen only in the layers it is for. A header in src/ is private to its layer: no other may include it. A
public header is one that another layer or a user includes.

Truth: the layers and rooms of docs/architecture.md. The first class checks the tree, the second checks the checker on trees with known faults.
"""
import re
import sys
import tempfile
import unittest
from pathlib import Path

LAYERS = ["core", "sphere", "optics", "medium", "transport", "results", "io", "plots", "app"]
# Rooms of a layer: its folders in src/, from the lowest to the highest. A room includes rooms below it.
ROOMS = {
    "transport": ["problem", "grid", "rays", "scattering", "system", "acceleration", "iteration", "columns", "reduction", "gather", "observers", "driver"],
    "app": ["process", "scene", "assembly", "verify", "planning", "runs", "commands"],
}
LARGEST_ROOM = 2500  # lines
ROOT = Path(sys.argv.pop(1)) if len(sys.argv) > 1 and Path(sys.argv[1]).is_dir() else Path(__file__).resolve().parents[2]

# A library's headers, and the layers whose .cpp files may see them.
THIRD_PARTY = {
    r"openvdb/": {"medium"},
    r"(hdf5|hdf5_hl|H5\w*)\.h": {"core", "io"},
    r"netcdf\.h": {"medium", "io"},
    r"png\.h": {"medium", "io"},
    r"zlib\.h": {"medium", "io"},
    r"cairo[\w-]*\.h|pango/": {"plots"},
    r"mpi\.h": {"core"},
    r"xxh(ash|3)\.h": {"core"},
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


def room_of(path, root):
    """The room of a source or private header within its layer; None: the layer has no rooms, or the header is public."""
    parts = path.relative_to(root).parts
    return parts[2] if parts[0] == "src" and len(parts) > 3 else None


def violations(root):
    found = []
    rank = {name: i for i, name in enumerate(LAYERS + ["main"])}
    for path in sorted([*root.glob("include/**/*.h*"), *root.glob("src/**/*.h*"), *root.glob("src/**/*.cpp")]):
        layer = layer_of(path, root)
        if layer not in rank:
            found.append(f"{path.relative_to(root)}: is in no layer (layers: {', '.join(LAYERS)})")
            continue
        public = path.relative_to(root).parts[0] == "include"
        room = room_of(path, root)
        rooms = ROOMS.get(layer, [])
        if not public and layer in ROOMS and room not in rooms:
            found.append(f"{path.relative_to(root)}: is in no room (rooms of {layer}: {', '.join(rooms)})")
            continue
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
                # A private header, named from src/ or beside its file. It must not lead out of the layer.
                private = re.match(r"(\w+)/(?:(\w+)/)?\w+\.hpp", target)
                if public:
                    found.append(f"{place}: public header includes the private {target}")
                elif target.startswith("..") or private and (root / "src" / target).is_file() and private[1] != layer:
                    found.append(f"{place}: includes {target} from outside its layer")
                elif private and private[1] == layer and private[2] in rooms and rooms.index(private[2]) > rooms.index(room):
                    found.append(f"{place}: room {room} includes {target}, whose room is above it")
                continue
            if public and not ALLOWED_IN_PUBLIC_HEADERS.fullmatch(target) and not re.fullmatch(r"\w+intrin\.h", target):
                found.append(f"{place}: public header includes third-party <{target}> (only Eigen may stand there)")
            for pattern, layers in THIRD_PARTY.items():
                if re.match(pattern, target) and layer not in layers:
                    allowed = ", ".join(sorted(layers)) or "no layer"
                    found.append(f"{place}: {layer} includes <{target}> (allowed in: {allowed})")
    return found


def unneeded_public_headers(root):
    """Public headers that nothing outside their layer includes: neither another layer nor another public header, nor an example of the docs."""
    texts = {path: path.read_text() for path in [*root.glob("include/**/*.hpp"), *root.glob("src/**/*.hpp"), *root.glob("src/**/*.cpp")]}
    texts |= {path: path.read_text() for path in root.glob("docs/*.md")}
    headers = sorted(root.glob("include/cloudbow/*/*.hpp"))
    unneeded = []
    for header in headers:
        name = header.relative_to(root / "include").as_posix()
        def needs(path):
            outside = path.suffix == ".md" or layer_of(path, root) != layer_of(header, root)
            return path != header and (outside or path.is_relative_to(root / "include")) and f'"{name}"' in texts[path]
        if not any(needs(path) for path in texts):
            unneeded.append(name)
    return unneeded


# Functions that users or main.cpp alone call, beside the example of docs/cpp-api.md.
FOR_USERS = {
    "cloudbow/sphere/harmonic_series.hpp", "cloudbow/sphere/rotation.hpp", "cloudbow/sphere/spherical_function.hpp",
    "cloudbow/optics/mie_sphere.hpp", "cloudbow/optics/sphere_fit.hpp", "cloudbow/app/assemble.hpp",
}


class Tree(unittest.TestCase):
    def test_every_layer_is_there(self):
        for layer in LAYERS:
            self.assertTrue(any((ROOT / "src" / layer).rglob("*.cpp")), f"src/{layer} has no source file")

    def test_public_headers_are_needed_outside(self):
        self.assertEqual([name for name in unneeded_public_headers(ROOT) if name not in FOR_USERS], [])

    def test_rooms_are_small(self):
        for layer, rooms in ROOMS.items():
            for room in rooms:
                lines = sum(len(path.read_text().splitlines()) for path in (ROOT / "src" / layer / room).glob("*.?pp"))
                self.assertTrue(0 < lines <= LARGEST_ROOM, f"src/{layer}/{room} has {lines} lines (allowed 1 to {LARGEST_ROOM})")

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
        self.assertEqual(self.faults_of(src__transport__grid__a_DOT_cpp='#include "cloudbow/core/error.hpp"\n#include <vector>\n'), [])

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
        self.assertEqual(len(self.faults_of(src__transport__grid__a_DOT_cpp="#include <openvdb/openvdb.h>\n")), 1)

    def test_neighbour_of_another_layer_is_found(self):
        found = self.faults_of(src__core__a_DOT_cpp='#include "../app/b.hpp"\n')
        self.assertEqual(len(found), 1)

    def test_private_header_of_another_layer_is_found(self):
        found = self.faults_of(src__io__a_DOT_hpp="", src__plots__a_DOT_cpp='#include "io/a.hpp"\n')
        self.assertEqual(found, ["src/plots/a.cpp:1: includes io/a.hpp from outside its layer"])

    def test_room_below_is_fine(self):
        self.assertEqual(self.faults_of(src__transport__rays__a_DOT_cpp='#include "transport/grid/cells.hpp"\n'), [])

    def test_room_above_is_found(self):
        found = self.faults_of(src__transport__grid__a_DOT_hpp='#include "transport/rays/march.hpp"\n')
        self.assertEqual(found, ["src/transport/grid/a.hpp:1: room grid includes transport/rays/march.hpp, whose room is above it"])

    def test_file_outside_of_all_rooms_is_found(self):
        self.assertEqual(len(self.faults_of(src__transport__a_DOT_cpp="")), 1)

    def test_public_header_with_a_private_one_is_found(self):
        self.assertEqual(len(self.faults_of(include__cloudbow__core__a_DOT_hpp='#include "core/b.hpp"\n')), 1)

    def test_public_header_that_only_its_layer_includes_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in (("include/cloudbow/io/a.hpp", ""), ("src/io/a.cpp", '#include "cloudbow/io/a.hpp"\n')):
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            self.assertEqual(unneeded_public_headers(root), ["cloudbow/io/a.hpp"])
            (root / "src/plots").mkdir()
            (root / "src/plots/b.cpp").write_text('#include "cloudbow/io/a.hpp"\n')
            self.assertEqual(unneeded_public_headers(root), [])


if __name__ == "__main__":
    unittest.main()
