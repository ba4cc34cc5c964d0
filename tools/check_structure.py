# SPDX-License-Identifier: BSD-3-Clause
"""Checks that the folders are the architecture: who includes whom, licences, READMEs, paths, sizes.

Usage: check_structure.py. Prints one line per complaint and ends with 1 if there is any.
"""

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

import project

# What the files of a folder may include, besides the folder itself. The longest folder that a path
# starts with counts. "*" is everything. A single file may be allowed by naming it.
MAY_INCLUDE = {
    "test_support": [],
    "config": [],
    "link": [],
    "firmware/hal": [],
    "firmware/core": ["firmware/hal", "link"],
    "firmware/boards": ["firmware/hal"],
    "sim": ["firmware/hal", "config"],
    "log": ["link", "firmware/hal", "sim/types.hpp"],
    "companion": ["link", "config"],
    "autonomy": ["config"],
    "apps": ["*"],
    "bench": ["*"],
    "examples": ["*"],
    "ros": ["*"],
}
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
SOURCE_SUFFIXES = {".cpp", ".hpp", ".c", ".h", ".py", ".sh", ".cmake"}
LICENCE = "SPDX-License-Identifier: BSD-3-Clause"
MOST_LINES, MANY_LINES = 600, 400


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


# ---- includes -----------------------------------------------------------------------------------


def allowed_for(path: Path, folder: str) -> list[str]:
    allowed = list(MAY_INCLUDE[folder])
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
            target = folder_of(name)
            if target in (None, folder) or "*" in allowed or target in allowed or name in allowed:
                continue
            complaints.append(f"{path}:{number}: {folder} must not include {name}; it may use: "
                              f"{', '.join(allowed) or 'nothing of ours'}")
    return complaints


def check_rooted(tree: Tree) -> list[str]:
    """Quoted includes are paths from the root, so that the table above sees them all."""
    return [f'{path}:{number}: write "{name}" as a path from the root of the project'
            for path in tree.cpp() if "*" not in MAY_INCLUDE.get(folder_of(str(path)), [])
            for number, name in tree.includes(path) if folder_of(name) is None]


def check_ros_free(tree: Tree) -> list[str]:
    """ROS headers stay inside ros/."""
    return [f"{path}:{number}: ROS header {name} outside ros/"
            for path in tree.cpp() if path.parts[0] != "ros"
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


# ---- licences, sizes, documents -----------------------------------------------------------------


def check_licences(tree: Tree) -> list[str]:
    """One SPDX line near the top of every source."""
    return [f"{path}: no line '{LICENCE}' among its first three" for path in tree.sources()
            if LICENCE not in "\n".join(tree.text(path).splitlines()[:3])]


def check_sizes(tree: Tree) -> list[str]:
    """A source of more than 600 lines holds a second idea."""
    complaints = []
    for path in tree.sources():
        lines = tree.text(path).count("\n")
        if lines > MOST_LINES:
            complaints.append(f"{path}: {lines} lines, at most {MOST_LINES}")
        elif lines > MANY_LINES:
            print(f"   note: {path} has {lines} lines; look for the second idea inside")
    return complaints


def check_readmes(tree: Tree) -> list[str]:
    """Every top folder, and every folder that builds something, says what it is."""
    top = {Path(p.parts[0]) for p in tree.files if len(p.parts) > 1 and p.parts[0][0] != "."}
    built = {p.parent for p in tree.files if p.name == "CMakeLists.txt" and "test" not in p.parts}
    return [f"{folder}: no README.md" for folder in sorted(top | built)
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


CHECKS = [check_includes, check_rooted, check_ros_free, check_cycles, check_licences, check_sizes,
          check_readmes, check_paths]


def run(root: Path = project.ROOT) -> dict[str, list[str]]:
    """Complaints of each check, by its name."""
    tree = Tree(root, project.own_files(root))
    return {check.__name__: check(tree) for check in CHECKS}


if __name__ == "__main__":
    said = [line for complaints in run().values() for line in complaints]
    print("\n".join(said))
    sys.exit(bool(said))
