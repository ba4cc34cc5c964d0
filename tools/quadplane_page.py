# SPDX-License-Identifier: BSD-3-Clause
"""Counts what the quad-plane took, in files and lines, into docs/quadplane.md.

Usage: quadplane_page.py [--check]. --check writes nothing and ends with 1 if the page is not up to date.
"""

import sys
from pathlib import Path

import project

DOCUMENT = "docs/quadplane.md"
BEGIN = "<!-- Counted by tools/quadplane_page.py: do not edit. -->\n"
END = "<!-- End of what is counted. -->\n"
SOURCES = {".cpp", ".hpp"}

#: What was written, and the beginnings of its files' names.
PARTS = [
    ("forces module", ["sim/quadplane/"]),
    ("vehicle file", ["vehicles/quadplane.yaml"]),
    ("mission", ["missions/quadplane.yaml"]),
    ("guidance and control", ["autonomy/quadplane/"]),
    ("mixers, and facts for guidance, from the vehicle file", ["flight/vehicle/quadplane_setup."]),
]
TESTS = ("tests", ["autonomy/quadplane/test/", "flight/test/quadplane"])
#: Where existing files had to name the new aircraft.
NAMED_IN = ("sim/", "flight/", "autonomy/", "config/", "base/", "apps/")


def is_code(path: Path) -> bool:
    return path.suffix in SOURCES or path.suffix == ".yaml"


def files_of(names: list[str], files: list[Path], tests: bool) -> list[Path]:
    return [path for path in files if is_code(path) and ("test" in path.parts) == tests
            and any(path.as_posix().startswith(name) for name in names)]


def lines_of(paths: list[Path], root: Path) -> int:
    return sum((root / path).read_text().count("\n") for path in paths)


def naming(files: list[Path], root: Path, own: set[Path]) -> tuple[int, int]:
    """Files that were there and name the aircraft, and their lines that do."""
    counts = []
    for path in files:
        code = path.suffix in SOURCES or path.name == "CMakeLists.txt"
        if path in own or not code or "test" in path.parts or not path.as_posix().startswith(NAMED_IN):
            continue
        counts.append(sum("quadplane" in line.lower() for line in (root / path).read_text().splitlines()))
    return sum(count > 0 for count in counts), sum(counts)


def table(root: Path = project.ROOT) -> str:
    files = project.own_files(root)
    rows = ["| part | where | files | lines |", "|---|---|---|---|"]
    own: set[Path] = set()
    for title, names in [*PARTS, TESTS]:
        found = files_of(names, files, tests=title == TESTS[0])
        if not found:
            sys.exit(f"{DOCUMENT}: {title}: no file begins with {' or '.join(names)}")
        own |= set(found)
        where = ", ".join(f"`{name}`" if (root / name).exists() else f"`{name}*`" for name in names)
        rows.append(f"| {title} | {where} | {len(found)} | {lines_of(found, root)} |")
    count, lines = naming(files, root, own)
    rows.insert(-1, f"| registration: lines that name it in files that were there | factory in `sim/registry.cpp`, plan in "
                    f"`flight/flight_setup.cpp`, guidance in `flight/guidance.cpp`, build files | {count} | {lines} |")
    return "\n".join(rows) + "\n"


def page(text: str, counted: str) -> str:
    """The page with another table between its two marks."""
    if text.count(BEGIN) != 1 or text.count(END) != 1:
        sys.exit(f"{DOCUMENT}: found no single pair of marks around the table, allowed one: {BEGIN.strip()}")
    before, rest = text.split(BEGIN)
    return before + BEGIN + "\n" + counted + "\n" + END + rest.split(END)[1]


def main() -> int:
    path = project.ROOT / DOCUMENT
    text = path.read_text()
    made = page(text, table())
    if sys.argv[1:] == ["--check"]:
        if text == made:
            return 0
        print(f"{DOCUMENT}: not up to date; run tools/quadplane_page.py", file=sys.stderr)
        return 1
    if sys.argv[1:]:
        print(__doc__.splitlines()[2], file=sys.stderr)
        return 2
    path.write_text(made)
    return 0


if __name__ == "__main__":
    sys.exit(main())
