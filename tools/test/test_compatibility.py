# SPDX-License-Identifier: BSD-3-Clause
"""docs/compatibility.md and docs/safety.md are complete: 77 weak points, each decided, 36 findings, each promise and
each difference with tests that exist. Tests that docs/compatibility-ros.md names exist too."""

import re

import project
import pytest

DOCUMENT = project.ROOT / "docs/compatibility.md"
ROW = re.compile(r"\| (\d+) \| [^|]+ \| (\w+) \| [^|]+ \| ([^|]+) \|")
NAMED_TEST = re.compile(r"`(\w+\.cpp): (\w+)\.(\w+)`")

SAFETY = project.ROOT / "docs/safety.md"
ROS = project.ROOT / "docs/compatibility-ros.md"
FINDING = re.compile(r"\| (\d+) \| [^|]+ \| ([^|]+) \|")
PROMISE = re.compile(r"\| ([A-Z][^|]+) \| ([^|]+) \|")
PYTHON_TEST = re.compile(r"`(test_\w+\.py): (test_\w+)`")

rows = [match for line in DOCUMENT.read_text().splitlines() if (match := ROW.fullmatch(line))]
safety_lines = SAFETY.read_text().splitlines()
findings = [match for line in safety_lines if (match := FINDING.fullmatch(line))]
promises = [match for line in safety_lines if (match := PROMISE.fullmatch(line))]
documents = DOCUMENT.read_text() + SAFETY.read_text() + ROS.read_text()
named_tests = sorted(set(NAMED_TEST.findall(documents)))
python_tests = sorted(set(PYTHON_TEST.findall(documents)))


def test_the_77_numbers_are_there_once_and_in_order():
    assert [int(row[1]) for row in rows] == list(range(1, 78))


@pytest.mark.parametrize("row", rows, ids=lambda row: row[1])
def test_each_is_decided_and_shown(row):
    assert row[2] in ("taken", "kept", "board")
    assert NAMED_TEST.search(row[3])


def test_the_36_findings_are_there_once_and_in_order():
    assert [int(row[1]) for row in findings] == list(range(1, 37))


@pytest.mark.parametrize("row", findings, ids=lambda row: f"finding {row[1]}")
def test_each_finding_is_shown(row):
    assert NAMED_TEST.search(row[2])
    assert "?" not in row[2]


@pytest.mark.parametrize("row", promises, ids=lambda row: row[1][:40])
def test_each_promise_is_shown(row):
    assert NAMED_TEST.search(row[2]) or PYTHON_TEST.search(row[2])


@pytest.mark.parametrize("file, name", python_tests, ids=lambda part: part)
def test_the_named_python_test_exists(file, name):
    texts = [(project.ROOT / path).read_text() for path in project.own_files(project.ROOT) if path.name == file]
    assert any(re.search(rf"^def {name}\(", text, re.MULTILINE) for text in texts), f"{file} has no {name}"


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
