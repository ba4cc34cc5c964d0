# SPDX-License-Identifier: BSD-3-Clause
"""What docs/quadplane.md says of files and lines is what is there."""

import re
import subprocess

import project
import pytest
import quadplane_page as counted

PAGE = (project.ROOT / counted.DOCUMENT).read_text()


def row(title, table):
    found = re.search(rf"^\| {re.escape(title)}[^|]*\|[^|]*\| (\d+) \| (\d+) \|$", table, re.MULTILINE)
    assert found, title
    return int(found[1]), int(found[2])


def test_the_page_is_up_to_date():
    assert PAGE == counted.page(PAGE, counted.table()), "run tools/quadplane_page.py"


@pytest.mark.parametrize(("title", "pattern"), [
    ("forces module", "sim/quadplane/*.?pp"), ("vehicle file", "vehicles/quadplane.yaml"),
    ("guidance and control", "autonomy/quadplane/*.?pp"), ("mixers", "flight/vehicle/quadplane_setup.?pp")])
def test_wc_counts_the_same(title, pattern):
    paths = sorted(project.ROOT.glob(pattern))
    wc = subprocess.run(["wc", "-l", *paths], capture_output=True, text=True, check=True)
    assert row(title, PAGE) == (len(paths), int(wc.stdout.splitlines()[-1].split()[0]))


def test_one_forces_class_and_one_vehicle_file():
    """The claim of the page: one header in the forces module, one vehicle file, one flight manager."""
    assert len(list(project.ROOT.glob("sim/quadplane/*.hpp"))) == 1
    assert row("vehicle file", PAGE)[0] == 1
    assert len(list(project.ROOT.glob("autonomy/quadplane/flight_manager.hpp"))) == 1


def test_the_firmware_does_not_name_it():
    named = subprocess.run(["grep", "-rliE", "quadplane|quad-plane", "--include=*.cpp", "--include=*.hpp", "--exclude-dir=test",
                            "firmware/core", "firmware/boards", "firmware/hal"], cwd=project.ROOT, capture_output=True, text=True)
    assert named.stdout == ""


def test_another_line_is_noticed(tmp_path):
    root = tmp_path / "tree"
    for path in project.own_files():
        if "quadplane" in path.as_posix():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_bytes((project.ROOT / path).read_bytes())
    before = counted.table(root)
    with (root / "vehicles/quadplane.yaml").open("a") as file:
        file.write("# one more\n")
    (root / "autonomy/quadplane/one_more.hpp").write_text("1\n2\n")
    after = counted.table(root)
    assert row("vehicle file", after) == (1, row("vehicle file", before)[1] + 1)
    files, lines = row("guidance and control", before)
    assert row("guidance and control", after) == (files + 1, lines + 2)


def test_a_page_without_marks_is_refused():
    with pytest.raises(SystemExit, match="found no single pair of marks"):
        counted.page("# no table", counted.table())
