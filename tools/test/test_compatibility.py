# SPDX-License-Identifier: BSD-3-Clause
"""docs/compatibility.md is complete: 77 weak points, each decided, each with tests that exist."""

import re

import project
import pytest

DOCUMENT = project.ROOT / "docs/compatibility.md"
ROW = re.compile(r"\| (\d+) \| [^|]+ \| (\w+) \| [^|]+ \| ([^|]+) \|")
NAMED_TEST = re.compile(r"`(\w+\.cpp): (\w+)\.(\w+)`")

rows = [match for line in DOCUMENT.read_text().splitlines() if (match := ROW.fullmatch(line))]
named_tests = sorted(set(NAMED_TEST.findall(DOCUMENT.read_text())))


def test_the_77_numbers_are_there_once_and_in_order():
    assert [int(row[1]) for row in rows] == list(range(1, 78))


@pytest.mark.parametrize("row", rows, ids=lambda row: row[1])
def test_each_is_decided_and_shown(row):
    assert row[2] in ("taken", "kept", "board")
    assert NAMED_TEST.search(row[3])


@pytest.fixture(scope="module")
def sources():
    """Text by file name; folders may use a name twice."""
    found: dict[str, str] = {}
    for path in project.own_files(project.ROOT):
        if path.name.endswith("_test.cpp"):
            found[path.name] = found.get(path.name, "") + (project.ROOT / path).read_text()
    return found


@pytest.mark.parametrize("file, suite, name", named_tests, ids=lambda part: part)
def test_the_named_test_exists(sources, file, suite, name):
    assert file in sources, f"no such test file: {file}"
    assert re.search(rf"\bTEST(_F|_P)?\(\s*{suite},\s*{name}\s*\)", sources[file]), \
        f"{file} has no test {suite}.{name}"
