# SPDX-License-Identifier: BSD-3-Clause
"""Rules of check_structure.py for the boards: one image for emulation and silicon, who links Unicorn, drivers that know no chip."""

import re
from pathlib import Path

BOARDS = Path("firmware/boards")
# Their sources have no preprocessor conditions today, and need none: headers use #pragma once.
ONE_IMAGE = ("common", "parts", "pixracer_pro", "stm32h7", "varmint")
CONDITION = re.compile(r"\s*#\s*(?:el)?if(?:n?def)?\b.*")
UNICORN_LIST = BOARDS / "stm32h7/emulator/CMakeLists.txt"
# Who links what is under the GPL: the library, and what has it in it.
UNICORN_TARGETS = {"unicorn": {"h7_chip"}, "h7_chip": {"h7_emulator", "h7_processor_test"}}
CHIPS = ("firmware/boards/stm32h7/", "firmware/boards/qemu_m7/")


def check_one_image(tree) -> list[str]:
    """The image that is emulated is the one for silicon: no #if in the sources of the boards."""
    return [f"{path}:{number}: {line.strip()}: one image runs everywhere; write it as a constant or as a file of its own"
            for path in tree.cpp() if any(path.is_relative_to(BOARDS / name) for name in ONE_IMAGE)
            for number, line in enumerate(tree.text(path).splitlines(), 1) if CONDITION.fullmatch(line)]


def linked_with(text: str, word: str) -> set[str]:
    """Targets that a CMake file links with something whose name has the word in it, loops and variables resolved."""
    text = re.sub(r"#.*", "", text)
    values = dict(re.findall(r"set\(\s*(\w+)\s+([^)]*)\)", text))
    holders = {name for name, value in values.items() if word in value.lower()}
    loops = [(match.start(), match.end(), match[1], match[2].split())
             for match in re.finditer(r"foreach\(\s*(\w+)\s+IN\s+ITEMS\s+([^)]*)\).*?endforeach\(", text, re.S)]
    found: set[str] = set()
    for match in re.finditer(r"(?:target_link_libraries|rosflight_(?:library|program|test))\(\s*(\S+)([^)]*)\)", text):
        if word not in match[2].lower() and not any(f"${{{name}}}" in match[2] for name in holders):
            continue
        items = next((items for begin, end, name, items in loops
                      if begin < match.start() < end and match[1] == f"${{{name}}}"), [match[1]])
        found.update(items)
    return found


def check_unicorn(tree) -> list[str]:
    """Unicorn is under the GPL: the emulator and the test of its processor link it, and nothing else."""
    complaints = []
    for path in tree.files:
        if path.name != "CMakeLists.txt" and path.suffix != ".cmake":
            continue
        for library, targets in UNICORN_TARGETS.items():
            allowed = targets if path == UNICORN_LIST else set()
            complaints += [f"{path}: {target} must not link {library}; only {' and '.join(sorted(targets))} of {UNICORN_LIST} may"
                           for target in sorted(linked_with(tree.text(path), library) - allowed)]
    return complaints + [f"{path}:{number}: includes {name}; only {UNICORN_LIST.parent} may"
                         for path in tree.cpp() if not path.is_relative_to(UNICORN_LIST.parent)
                         for number, name in tree.includes(path, "<>") + tree.includes(path) if name.startswith("unicorn/")]


def check_parts(tree) -> list[str]:
    """Drivers of parts take a bus and a clock and know no chip."""
    return [f"{path}:{number}: a part driver must not include {name} of a chip"
            for path in tree.cpp() if path.is_relative_to(BOARDS / "parts")
            for number, name in tree.includes(path, "<>") + tree.includes(path) if name.startswith(CHIPS)]
