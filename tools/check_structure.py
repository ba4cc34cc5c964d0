# SPDX-License-Identifier: BSD-3-Clause
"""Checks that the folders are the architecture: includes, constants, namespaces, licences, READMEs, paths, sizes.

Usage: check_structure.py. Prints one line per complaint and ends with 1 if there is any.
"""

import re
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import check_boards
import project

# What the files of a folder may include, besides the folder itself. The longest folder that a path
# starts with counts. A single file may be allowed by naming it.
# Everybody may use base; what runs on a microcontroller only its headers without I/O, heap and exceptions.
BARE_BASE = ["base/angles.hpp", "base/atmosphere.hpp", "base/constants.hpp", "base/crc32.hpp", "base/eigen.hpp"]
BARE_METAL = ("link", "firmware/hal", "firmware/core")
MAY_INCLUDE = {
    "cmake/toolchains": [],
    "base": [],
    "test_support": [],
    "config": [],
    "link": [],
    "firmware/hal": [],
    "firmware/core": ["firmware/hal", "link"],
    "firmware/boards": ["firmware/hal"],
    "sim": ["firmware/hal", "config"],
    "messages": ["link", "firmware/hal", "sim/types.hpp", "sim/world_sensors/samples.hpp"],
    "log": ["messages", "link", "firmware/hal", "sim/types.hpp", "sim/world_sensors/samples.hpp"],
    "companion": ["link", "config"],
    "ground": ["link", "config", "companion", "log", "firmware/hal", "firmware/boards/parts/flight_record.hpp"],
    "autonomy": ["config"],
    "flight": ["link", "firmware/hal", "firmware/core", "firmware/boards", "sim", "messages", "log", "companion", "autonomy",
               "config"],
    "flight/gazebo/coupling": ["flight", "sim", "messages", "config"],
    "flight/gazebo/engine": ["flight/gazebo/engine_block.hpp"],
    "web/server": [],
    "python": ["flight", "log", "companion", "autonomy", "sim", "link", "firmware/hal", "firmware/core", "firmware/boards", "config"],
    "viewer": ["flight", "log", "web/server", "ground", "companion", "sim", "link", "config"],
    "viewer/holoocean": ["sim", "config", "firmware/boards/common/host/child_process.hpp"],
    "apps": ["viewer", "viewer/holoocean", "flight", "flight/gazebo/coupling", "web/server/access.hpp", "ground", "companion", "sim", "link", "firmware/hal", "firmware/core",
             "firmware/boards", "config"],
    "bench": ["flight", "autonomy", "companion", "sim", "link", "firmware/hal", "firmware/core", "firmware/boards", "test_support"],
    "examples": ["flight", "autonomy", "sim", "config"],
    "ros/rosflight_common": ["autonomy", "config", "sim", "flight/vehicle/vehicle_setup.hpp"],
    "ros/examples": ["ros/rosflight_sim"],
    "ros/roscopter": ["ros/rosflight_common", "autonomy", "config", "flight/vehicle/mixer_fault.hpp", "flight/vehicle/vehicle_setup.hpp"],
    "ros/rosflight_demos": [],
    "ros/rosflight_gcs": ["ros/rosflight_common"],
    "ros/rosflight_io": ["ros/rosflight_common", "companion", "ground/parameter_info.hpp", "link", "messages"],
    "ros/rosflight_sim": ["ros/rosflight_common", "viewer/holoocean", "sim", "config", "companion", "link", "messages", "firmware/hal", "firmware/core",
                          "firmware/boards", "flight/gazebo/coupling", "flight/gazebo/engine", "flight/vehicle/vehicle_setup.hpp"],
    "ros/rosplane": ["ros/rosflight_common", "autonomy", "config", "flight/vehicle/vehicle_setup.hpp"],
    "ros_standin": [],
}
# Each ROS package and each example is a project of its own.
OWN_INCLUDE_DIRECTORIES = ("ros", "ros_standin", "examples")
# Where an image is put together, the board meets what runs on it.
MAIN_MAY_INCLUDE = {"firmware/boards": ["firmware/core", "link"]}
# Tests may in addition drive the folder through these.
TESTS_MAY_INCLUDE = {
    "firmware/core": ["firmware/boards/simulated/simulated_board.hpp"],
    "firmware/boards": ["firmware/core", "link"],
}

ROS_HEADER = re.compile(
    r"(rcl\w*|rmw\w*|ament\w*|tf2\w*|rosbag2\w*|rosidl\w*|builtin_interfaces|\w+_msgs|\w+_srvs|"
    r"pluginlib|class_loader|message_filters|controller_\w+|hardware_interface|gazebo\w*)/"
)
SOURCE_SUFFIXES = {".cpp", ".hpp", ".c", ".h", ".py", ".sh", ".cmake", ".ts", ".tsx", ".mjs", ".css"}
LICENCE = "SPDX-License-Identifier: BSD-3-Clause"
COPYRIGHT = re.compile(r"^\W*(copyright\b.*\d{4}|\(c\) *\d{4})", re.I)
MAX_LINES, MANY_LINES = 600, 400
MANY_UNITS = 4  # a folder that a person can own


@dataclass
class Tree:
    """The project's files, read once."""

    root: Path
    files: list[Path]
    _text: dict = field(default_factory=dict)

    def text(self, path: Path) -> str:
        if path not in self._text:
            self._text[path] = (self.root / path).read_text(errors="replace")
        return self._text[path]

    def sources(self) -> list[Path]:
        return [p for p in self.files if p.suffix in SOURCE_SUFFIXES or p.name == "CMakeLists.txt"
                or is_shell(self.root / p)]

    def cpp(self) -> list[Path]:
        return [p for p in self.files if p.suffix in (".cpp", ".hpp", ".c", ".h")]

    def includes(self, path: Path, brackets: str = '""') -> list[tuple[int, str]]:
        """Line number and name of each include written with these brackets."""
        pattern = re.compile(rf"\s*#\s*include\s*{brackets[0]}([^>\"]+){brackets[1]}")
        lines = enumerate(self.text(path).splitlines(), 1)
        return [(number, match[1]) for number, line in lines if (match := pattern.match(line))]


def is_shell(path: Path) -> bool:
    if path.suffix == ".sh":
        return True
    if path.suffix:
        return False
    with path.open("rb") as file:
        return re.match(rb"#!.*\b(ba)?sh\b", file.read(40)) is not None


def folder_of(path: str, table=MAY_INCLUDE) -> str | None:
    """The longest folder of the table that holds the path."""
    return max((f for f in table if path.startswith(f + "/")), key=len, default=None)


def folder_of_include(name: str) -> str | None:
    """Headers of a ROS package are included by the package's name, all others by their path from the root."""
    return folder_of(name) or folder_of("ros/" + name)


# ---- includes -----------------------------------------------------------------------------------


def allowed_for(path: Path, folder: str) -> list[str]:
    bare = folder in BARE_METAL and "test" not in path.parts
    allowed = MAY_INCLUDE[folder] + (BARE_BASE if bare else ["base"])
    if path.stem == "main" or path.stem.endswith("_main"):
        allowed += MAIN_MAY_INCLUDE.get(folder, [])
    if "test" in path.parts:
        allowed += ["test_support"]
        allowed += TESTS_MAY_INCLUDE.get(folder, [])
    return allowed


def check_includes(tree: Tree) -> list[str]:
    """Folders include only what the table lets them."""
    complaints = []
    for path in tree.cpp():
        folder = folder_of(str(path))
        if folder is None:
            complaints.append(f"{path}: C++ in a folder that MAY_INCLUDE does not know")
            continue
        allowed = allowed_for(path, folder)
        for number, name in tree.includes(path):
            target = folder_of_include(name)
            if target in (None, folder) or target in allowed or name in allowed:
                continue
            complaints.append(f"{path}:{number}: {folder} must not include {name}; it may use: "
                              f"{', '.join(allowed) or 'nothing of ours'}")
    return complaints


# Numbers that stand in base/ alone, as they would be written in C++.
CONSTANTS = re.compile(
    r"(?<![\w.])(3\.1415926\d*|0\.0174532\d*|57\.29\d+|9\.80665|101325|6378137|298\.257\d*|1\.225)(?![\d])"
    r"|[pP]i\w*(<\w+>)? */ *180|180(\.0)?[fF]? */ *[\w:]*\b(k?[pP]i)\b|std::numbers::pi|\bM_PI\b")
# The direction of the wind is bit-equal with earlier flights: (x pi)/180 rounds unlike x (pi/180).
CONSTANTS_ALLOWED = {"flight_setup.cpp": "base::kPi / 180"}


def check_constants(tree: Tree) -> list[str]:
    """A constant of nature or mathematics stands once, in base/; tests have their own as a check on it."""
    complaints = []
    for path in tree.cpp():
        if path.parts[0] == "base" or {"test", "fuzz"} & set(path.parts):
            continue
        for number, line in enumerate(tree.text(path).splitlines(), 1):
            code = re.sub(r'//.*|/\*.*?\*/|"(?:[^"\\]|\\.)*"', "", line).replace(
                CONSTANTS_ALLOWED.get(path.name, "//"), "")
            if found := CONSTANTS.search(code):
                complaints.append(f"{path}:{number}: {found[0]}: take it from base/constants.hpp or base/atmosphere.hpp")
    return complaints


# Folders whose parts have a namespace of their own; elsewhere a part may have one, named like its folder.
OWN_NAMESPACE = ("autonomy/estimation", "autonomy/fixedwing", "autonomy/multirotor", "sim/rc", "sim/sensors")
# Namespaces that are not the folder's, with the reason.
NAMESPACE_EXCEPTIONS = {
    "sim/portable_math.hpp": "rosflight::sim::portable",  # replaces the C library: calls say which function they mean
    "firmware/boards/qemu_m7": "rosflight::boards::m7",  # drivers of the Cortex-M7, not of its emulator
    "ros/rosflight_sim/include/rosflight_sim/view_tools.hpp": "rosflight_sim::views",  # functions of *_views.cpp alone
}


def namespace_of(path: Path) -> str:
    """rosflight::FOLDER; a ROS package and an example are projects with a namespace of their own."""
    top, *rest = path.parts[:-1]
    if top == "examples":
        return rest[0]
    if top == "ros":
        return rest[0]
    if top == "firmware":
        return f"rosflight::{rest[0]}"
    own = folder_of(str(path), OWN_NAMESPACE)
    return "rosflight::" + (own or top).replace("/", "::")


def check_namespaces(tree: Tree) -> list[str]:
    """Namespace = folder. What a file adds below it is named after a folder on its path, or `detail`."""
    complaints = []
    for path in tree.cpp():
        if {"test", "fuzz"} & set(path.parts) or path.parts[0] == "ros_standin":
            continue
        folder = folder_of(str(path), NAMESPACE_EXCEPTIONS)
        exception = NAMESPACE_EXCEPTIONS.get(str(path)) or NAMESPACE_EXCEPTIONS.get(folder)
        wanted = [namespace_of(path)] + [exception] * bool(exception)
        for number, line in enumerate(tree.text(path).splitlines(), 1):
            found = re.match(r"(?:inline )?namespace (rosflight\w*(?:::\w+)+|ros\w+) \{", line)
            if found and not any(_within(found[1], name, path) for name in wanted):
                complaints.append(f"{path}:{number}: namespace {found[1]}, expected {wanted[0]}")
    return complaints


def _within(namespace: str, outer: str, path: Path) -> bool:
    inner = namespace.removeprefix(outer).removeprefix("::")
    return namespace.startswith(outer) and set(inner.split("::")) <= {"", "detail", path.stem, *path.parts}


def check_rooted(tree: Tree) -> list[str]:
    """Quoted includes are paths from the root, so that the table above sees them all."""
    return [f'{path}:{number}: write "{name}" as a path from the root of the project'
            for path in tree.cpp() if path.parts[0] not in OWN_INCLUDE_DIRECTORIES
            for number, name in tree.includes(path) if folder_of(name) is None]


def check_ros_free(tree: Tree) -> list[str]:
    """ROS headers stay inside ros/ and what stands in for ROS."""
    return [f"{path}:{number}: ROS header {name} outside ros/"
            for path in tree.cpp() if path.parts[0] not in ("ros", "ros_standin")
            for number, name in tree.includes(path, "<>") + tree.includes(path)
            if ROS_HEADER.match(name)]


def check_cycles(tree: Tree) -> list[str]:
    """Neither the folders of the table nor the files include each other in a circle."""
    files = {str(path): [name for _, name in tree.includes(path)] for path in tree.cpp()}
    folders = {folder: [f for f in (folder_of(a + "/") or folder_of(a) for a in allowed) if f]
               for folder, allowed in MAY_INCLUDE.items()}
    return [f"circle: {' -> '.join(circle)}" for graph in (folders, files)
            for circle in circles(graph)]


def circles(graph: dict[str, list[str]]) -> list[list[str]]:
    """Each circle that a depth-first walk meets, first node repeated at the end."""
    found: list[list[str]] = []
    done: set[str] = set()

    def walk(node: str, trail: list[str]):
        if node in trail:
            found.append(trail[trail.index(node):] + [node])
        elif node not in done and node in graph:
            for following in graph[node]:
                walk(following, trail + [node])
            done.add(node)

    for node in graph:
        walk(node, [])
    return found


# Libraries that know nothing of the world they are tested in: not even through what they use.
MUST_NOT_LINK = {"autonomy": ("sim", "flight"), "estimation": ("sim", "flight"), "companion": ("sim", "flight")}


def libraries(tree: Tree) -> dict[str, list[str]]:
    """What each library of the project uses, as the CMake files say: name -> names."""
    found: dict[str, list[str]] = {}
    for path in tree.files:
        if path.name != "CMakeLists.txt":
            continue
        text = re.sub(r"#.*", "", tree.text(path))
        for name, body in re.findall(r"rosflight_library\(\s*(\w+)([^)]*)\)", text):
            uses = body.split("USES", 1)[1] if "USES" in body else ""
            found[name] = re.findall(r"rosflight::(\w+)", uses)
    return found


def check_links(tree: Tree) -> list[str]:
    """Libraries link nothing of what MUST_NOT_LINK names, directly or through others."""
    graph = libraries(tree)
    complaints = []
    for library, forbidden in MUST_NOT_LINK.items():
        ways = {library: [library]}
        waiting = [library] if library in graph else []
        while waiting:
            name = waiting.pop()
            for used in graph.get(name, []):
                if used not in ways:
                    ways[used] = ways[name] + [used]
                    waiting.append(used)
        complaints += [f"library {library} must not link {name}: {' -> '.join(ways[name])}"
                       for name in forbidden if name in ways]
    return complaints


# ---- licences, sizes, documents -----------------------------------------------------------------


def check_licences(tree: Tree) -> list[str]:
    """One SPDX line near the top of every source, and no copyright of others: their files stay with them, and the project's own is in
    LICENSE."""
    complaints = [f"{path}: no line '{LICENCE}' among its first three" for path in tree.sources()
                  if LICENCE not in "\n".join(tree.text(path).splitlines()[:3])]
    return complaints + [f"{path}:{number}: a copyright; other people's files are installed, not kept here"
                         for path in tree.sources()
                         for number, line in enumerate(tree.text(path).splitlines(), 1) if COPYRIGHT.search(line)]


BEAST_UNIT, BEAST_PARTS = Path("web/server/web_server.cpp"), Path("web/server/detail")
GENERATED = {".js", ".map", ".wasm", ".gz", ".br", ".tgz"}


def check_web(tree: Tree) -> list[str]:
    """Boost.Beast is compiled in one translation unit, and no bundle or package of the page is committed."""
    complaints = []
    for path in tree.cpp():
        if path == BEAST_UNIT or path.parent == BEAST_PARTS:
            continue
        complaints += [f"{path}:{number}: includes {name}; only {BEAST_UNIT} and {BEAST_PARTS} may"
                       for number, name in tree.includes(path, "<>") + tree.includes(path)
                       if name.startswith(("boost/beast", f"{BEAST_PARTS}/"))]
    complaints += [f"{path}: is generated, to be left out" for path in tree.files
                   if path.parts[0] in ("web", "build") and (path.suffix in GENERATED or {"build", "node_modules"} & set(path.parts))]
    return complaints


def check_sizes(tree: Tree) -> list[str]:
    """A source of more than 600 lines holds a second idea."""
    complaints = []
    for path in tree.sources():
        lines = tree.text(path).count("\n")
        if lines > MAX_LINES:
            complaints.append(f"{path}: {lines} lines, at most {MAX_LINES}")
        elif lines > MANY_LINES:
            print(f"   note: {path} has {lines} lines; look for the second idea inside")
    return complaints


def check_readmes(tree: Tree) -> list[str]:
    """Every top folder, every folder that builds something, and every folder with four units of C++ or Python says what it is.

    A header and its source are one unit. Tests are described by the README of what they test, the inside of a ROS package by
    that of the package.
    """
    top = {Path(p.parts[0]) for p in tree.files if len(p.parts) > 1 and p.parts[0][0] != "."}
    built = {p.parent for p in tree.files if p.name == "CMakeLists.txt" and "test" not in p.parts}
    units = {p.with_suffix("") for p in tree.files if p.suffix in (".cpp", ".hpp", ".c", ".h", ".py")
             and not {"test", "fuzz"} & set(p.parts) and p.parts[0] not in ("ros", "ros_standin")}
    owned = {folder for folder, count in Counter(unit.parent for unit in units).items()
             if count >= MANY_UNITS and folder.parts}
    return [f"{folder}: no README.md" for folder in sorted(top | built | owned)
            if folder / "README.md" not in tree.files]


def check_paths(tree: Tree) -> list[str]:
    """Paths that documents name exist: `in backticks` from the root, [links](x) from the document."""
    top = {p.parts[0] for p in tree.files if len(p.parts) > 1}
    complaints = []
    for document in (p for p in tree.files if p.suffix == ".md"):
        for number, line in enumerate(tree.text(document).splitlines(), 1):
            named = [(tree.root, name) for name in re.findall(r"`(?:\./)?([\w.*/-]+)`", line)
                     if "/" in name and name.split("/")[0] in top]
            named += [(tree.root / document.parent, name)
                      for name in re.findall(r"\]\(([^)#\s:]+)(?:#[^)]*)?\)", line)]
            complaints += [f"{document}:{number}: no such path: {name}"
                           for base, name in named if not _exists(base, name)]
    return complaints


def _exists(base: Path, name: str) -> bool:
    return any(base.glob(name.rstrip("/"))) if "*" in name else (base / name).exists()


CHECKS = [check_includes, check_constants, check_namespaces, check_rooted, check_ros_free, check_cycles, check_links, check_licences, check_sizes,
          check_readmes, check_paths, check_web,
          check_boards.check_one_image, check_boards.check_unicorn, check_boards.check_parts]


def run(root: Path = project.ROOT) -> dict[str, list[str]]:
    """Complaints of each check, by its name."""
    tree = Tree(root, project.own_files(root))
    return {check.__name__: check(tree) for check in CHECKS}


if __name__ == "__main__":
    said = [line for complaints in run().values() for line in complaints]
    print("\n".join(said))
    sys.exit(bool(said))
