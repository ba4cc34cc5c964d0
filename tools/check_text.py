# SPDX-License-Identifier: BSD-3-Clause
"""Checks comments, names and prose: typeset equations, words to avoid (docs/style.md), suffixes of frames, long cells.

Usage: check_text.py   one line per complaint; ends with 1 if there is any. Also part of the stage `structure`.
"""

import re
import sys
from pathlib import Path

import project

# Words to avoid as they stand in prose, comments and texts; docs/style.md says what to write instead.
WORDS = {
    r"patien(ce|t|tly)": "timeout",
    r"lengthwise": "longitudinal",
    r"sideways": "lateral",
    r"set-points?": "setpoint",
    r"the house": "this project",
    r"time-outs?": "timeout",
    r"anew": "again",
    r"whoever": "a person or program",
    r"doubts?": "rejects",
    r"believes?": "estimates",
    r"feels?": "measures",
    r"hears?|heard": "receives",
}
# Newtons, so that _N on anything else is a frame that is called W.
NEWTONS = re.compile(r"(^|_)(thrust|weight|force|drag|lift|stiffness|damping|coefficient|pull|normal|static|idle|propeller|rotor|"
                     r"limited|full|wanted|down|up|x|y|15)$")
FRAME_N = re.compile(r"\b([a-zA-Z]\w*?)_N(B|S)?(?:_(?!s2?\b|m\b|s_m\b|S_M\b)\w*)?_?\b")
NOT_FRAMES = {"LOCK_NB"}
EQUATION_ALONE = re.compile(r"^\s*//[/!]?<?\s*\(\d+[a-z]?\)[.,]?$")
EQUATION = re.compile(r"^\s*//[/!]?(?P<space>\s+)\S.*=.*[^\w(]\(\d+[a-z]?\)[.,]?$")
TYPESET_INDENT = 5
# "Of the queue: ..." wants the line above to be read first.
FRAGMENT = re.compile(r"//[/!]?<? Of ")
MAX_CELL = 300
# A path of one machine, in what is built.
OWN_PATH = re.compile(r'"/(tmp|home|root|work|mnt)/')
PROSE = {".md", ".py", ".sh", ".ts", ".tsx", ".yaml", ".msg", ".srv", ".xml", ".cmake", ".txt", ".csv"}
CPP = {".cpp", ".hpp"}
# The list of words itself, quotations of other projects' names, and recorded data.
NOT_CHECKED = {"docs/style.md", "tools/check_text.py", "tools/test/test_check_text.py", "CHANGELOG.md"}


def prose_of(path: Path, line: str) -> str:
    """What of a line a person reads: all of a document, comments and texts of C++."""
    if path.suffix not in CPP:
        return line
    comment = re.search(r"//.*", line)
    texts = re.findall(r'"(?:[^"\\]|\\.)*"', line[:comment.start()] if comment else line)
    return " ".join([*texts, comment[0] if comment else ""])


def words_in(path: Path, text: str) -> list[str]:
    complaints = []
    for number, line in enumerate(text.splitlines(), 1):
        prose = prose_of(path, line)
        for pattern, better in WORDS.items():
            if found := re.search(rf"(?<![\w-])({pattern})(?![\w-])", prose, re.I):
                complaints.append(f"{path}:{number}: '{found[1]}'; write '{better}' (docs/style.md)")
    return complaints


def equations_in(path: Path, text: str) -> list[str]:
    complaints = []
    for number, line in enumerate(text.splitlines(), 1):
        typeset = EQUATION.match(line)
        if EQUATION_ALONE.match(line):
            complaints.append(f"{path}:{number}: the number of an equation stands alone: the line was broken")
        elif typeset and len(typeset["space"]) < TYPESET_INDENT:
            complaints.append(f"{path}:{number}: a numbered equation stands on a line of its own, indented by {TYPESET_INDENT}")
    return complaints


def fragments_in(path: Path, text: str) -> list[str]:
    """Comments that begin in the middle of a sentence; a line that goes on from the comment above it is none."""
    complaints = []
    before = ""
    for number, line in enumerate(text.splitlines(), 1):
        if FRAGMENT.search(line) and not before.lstrip().startswith("//"):
            complaints.append(f"{path}:{number}: a comment that begins with 'Of'; name what it is of")
        before = line
    return complaints


def paths_in(path: Path, text: str) -> list[str]:
    return [f"{path}:{number}: a path of one machine" for number, line in enumerate(text.splitlines(), 1) if OWN_PATH.search(line)]


def cells_in(path: Path, text: str) -> list[str]:
    complaints = []
    for number, line in enumerate(text.splitlines(), 1):
        cells = line.strip().strip("|").split(" | ") if line.startswith("|") else []
        for cell in cells:
            prose = re.sub(r"`[^`]*`", "", cell).strip()
            if len(prose) > MAX_CELL:
                complaints.append(f"{path}:{number}: a table cell of {len(prose)} characters, allowed {MAX_CELL}: "
                                  f"'{prose[:40]}...'")
    return complaints


def frames_in(path: Path, text: str) -> list[str]:
    complaints = []
    for number, line in enumerate(text.splitlines(), 1):
        code = re.sub(r'"(?:[^"\\]|\\.)*"', '""', line)
        for found in FRAME_N.finditer(code):
            if found[0] not in NOT_FRAMES and not NEWTONS.search(found[1]):
                complaints.append(f"{path}:{number}: {found[0]}: the world frame is W; _N is newton")
    return complaints


def run(root: Path = project.ROOT) -> dict[str, list[str]]:
    """Complaints of each check, by its name."""
    found: dict[str, list[str]] = {"words": [], "equations": [], "frames": [], "fragments": [], "cells": [], "paths": []}
    for path in project.own_files(root):
        if str(path) in NOT_CHECKED or path.suffix not in PROSE | CPP or "corpus" in path.parts:
            continue
        text = (root / path).read_text(errors="replace")
        found["words"] += words_in(path, text)
        if path.suffix == ".md":
            found["cells"] += cells_in(path, text)
        if path.suffix in CPP and "test" not in path.parts:
            found["paths"] += paths_in(path, text)
        if path.suffix in CPP:
            found["fragments"] += fragments_in(path, text)
            found["equations"] += equations_in(path, text)
            found["frames"] += frames_in(path, text)
    return found


if __name__ == "__main__":
    said = [line for complaints in run().values() for line in complaints]
    print("\n".join(said))
    sys.exit(bool(said))
