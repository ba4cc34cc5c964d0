# SPDX-License-Identifier: BSD-3-Clause
"""The generator of the parameter table: what it makes, and one line for each mistake in the table."""
import csv
import math
import pathlib
import re
import subprocess
import sys

import pytest

CORE = pathlib.Path(__file__).resolve().parents[1]
GENERATOR = CORE / "params" / "generate.py"
COLUMNS = ["name", "type", "default", "min", "max", "sentinel", "armed", "units", "description"]
GOOD = ["SYS_ID", "int32", "1", "1", "255", "", "", "", "Number of this aircraft"]


def run(tmp_path, text):
    table = tmp_path / "table.csv"
    if isinstance(text, bytes):
        table.write_bytes(text)
    else:
        table.write_text(text)
    header, page = tmp_path / "table.hpp", tmp_path / "page.md"
    done = subprocess.run([sys.executable, str(GENERATOR), str(table), str(header), str(page)],
                          capture_output=True, text=True)
    return done, header, page


def table(*rows, columns=COLUMNS):
    return "\n".join([",".join(columns), *(",".join(row) for row in rows)]) + "\n"


def changed(**cells):
    row = dict(zip(COLUMNS, GOOD))
    row.update(cells)
    return list(row.values())


def test_makes_a_row_and_an_entry_of_each_parameter(tmp_path):
    float_row = ["PRI_MIXER_0_1", "float", "0.5", "-inf", "inf", "", "locked", "N", "A gain"]
    sentinel_row = ["FAILSAFE_THR", "float", "-1.0", "0", "1", "-1", "", "", "If |x| is lost"]
    done, header, page = run(tmp_path, table(GOOD, float_row, sentinel_row))
    assert done.returncode == 0, done.stderr
    text = header.read_text()
    assert ("    int_kind(1, 1.0f, 255.0f, 1.0f, 0),\n    float_kind(0.5f, -kInfinity, kInfinity, 0.5f, 1),\n"
            "    float_kind(-1.0f, 0.0f, 1.0f, -1.0f, 0),\n") in text
    assert names_in(text) == ["SYS_ID", "PRI_MIXER_0_1", "FAILSAFE_THR"]
    assert "kParamCount = 3;" in text
    assert "{kInfinity, 0.0f, false}," in text and "{0.0f, 0.0f, false}," in text
    assert [line.strip() for line in text.splitlines() if line.strip().startswith("k") and line.endswith(",")] \
        == ["kSysId,", "kPriMixer0_1,", "kFailsafeThr,"]
    lines = page.read_text().splitlines()
    assert "| 1 | PRI_MIXER_0_1 | float | 0.5 | -inf .. inf | N | locked | A gain |" in lines
    assert any("0 .. 1 or -1" in line and r"If \|x\| is lost" in line for line in lines)


def names_in(header):
    """The names of the table, unpacked by the rule of next_name() in parameter_row.hpp."""
    table = re.search(r"kParamNames\{\{\n(.*?)\}\};", header, re.S)[1]
    rest = bytes(int(number) for number in re.findall(r"[0-9]+", table))
    names = []
    while rest:
        shared, own = rest[0] >> 4, (rest[0] & 15) + 1
        names.append((names[-1] if names else "")[:shared] + rest[1:1 + own].decode())
        rest = rest[1 + own:]
    return names


def test_names_are_packed_and_blocks_begin_with_a_whole_one(tmp_path):
    names = ["A", *(f"ABCDEFGHIJKLMNO{letter}" for letter in "ABCDEFGHIJKLMNOPQ"), "ABC"]
    done, header, _ = run(tmp_path, table(*(changed(name=name) for name in names)))
    assert done.returncode == 0, done.stderr
    text = header.read_text()
    assert names_in(text) == names
    # 1 + 1 for A, 1 + 15 for the next, 1 + 1 for each of 14; then 1 + 16, 1 + 1, and 1 + 1 for ABC, whose AB is shared.
    assert "std::array<std::uint8_t, 67>" in text and "kNameBlocks{{\n    0, 46,\n}};" in text


def test_each_armed_rule_stands_once_in_the_header(tmp_path):
    rows = [["A", "float", "1", "0", "9", "", armed, "", "A"] for armed in ("4 step 0.02", "1.5 up", "4", "4")]
    for name, row in zip("ABCD", rows):
        row[0] = name
    done, header, page = run(tmp_path, table(*rows))
    assert done.returncode == 0, done.stderr
    text = header.read_text()
    assert "{4.0f, 0.02f, false},\n    {1.5f, 0.0f, true},\n    {4.0f, 0.0f, false},\n}};" in text
    assert "".join(f"    float_kind(1.0f, 0.0f, 9.0f, 1.0f, {rule}),\n" for rule in range(3)) + "}};" in text
    assert "std::array<std::uint8_t, kParamCount> kParamKindOf{{\n    0, 1, 2, 2,\n}};" in text
    assert "| 1.5 up |" in page.read_text()


@pytest.mark.parametrize("row, key", [
    (changed(name="sys_id"), "name"),
    (changed(name=""), "name"),
    (changed(name="ABCDEFGHIJKLMNOPQ"), "name"),
    (changed(name="9LIVES"), "name"),
    (changed(type="double"), "type"),
    (changed(default="one"), "default"),
    (changed(default=""), "default"),
    (changed(default="1.5"), "default"),
    (changed(default="1.0"), "default"),
    (changed(default="nan"), "default"),
    (changed(default="0"), "default"),
    (changed(default="256"), "default"),
    (changed(min="x"), "min"),
    (changed(max=""), "max"),
    (changed(max="16777217"), "max"),
    (changed(min="9", max="5", default="7"), "min"),
    (changed(sentinel="none"), "sentinel"),
    (changed(sentinel="0.5"), "sentinel"),
    (changed(armed="yes"), "armed"),
    (changed(armed="4"), "armed"),
    (changed(type="float", armed="0.5"), "armed"),
    (changed(type="float", armed="4 up up"), "armed"),
    (changed(type="float", armed="4.. step 1"), "armed"),
    (changed(type="float", default="inf", max="inf"), "default"),
    (changed(type="float", max="1e39"), "max"),
])
def test_a_bad_cell_gives_one_line_with_file_line_and_key(tmp_path, row, key):
    other = changed(name="OTHER")
    done, header, page = run(tmp_path, table(other, row))
    assert done.returncode == 2
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    assert "table.csv:3:" in lines[0]
    assert key in lines[0]
    assert not header.exists() and not page.exists()


@pytest.mark.parametrize("text, words", [
    ("", "columns"),
    (table(GOOD, columns=COLUMNS[:-1] + ["text"]), "columns"),
    (table(), "no parameter"),
    (table(GOOD[:-1]), "number of columns"),
    (table(GOOD + ["more"]), "number of columns"),
    (b"\xff\xfe\x00binary", "table.csv"),
    (table(GOOD)[:-1] + ',"open', "table.csv"),
])
def test_a_bad_file_gives_one_line(tmp_path, text, words):
    done, header, page = run(tmp_path, text)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert words in done.stderr
    assert not header.exists() and not page.exists()


def test_a_name_twice_names_both_lines(tmp_path):
    done, _, _ = run(tmp_path, table(GOOD, changed(name="OTHER"), GOOD))
    assert done.returncode == 2
    assert "table.csv:4:" in done.stderr and "line 2" in done.stderr


def test_a_missing_file_or_argument_gives_one_line(tmp_path):
    for arguments in ([], [str(tmp_path / "none.csv"), "a.hpp", "b.md"]):
        done = subprocess.run([sys.executable, str(GENERATOR), *arguments], capture_output=True, text=True,
                              cwd=tmp_path)
        assert done.returncode == 2
        assert len(done.stderr.splitlines()) == 1, done.stderr


def test_our_own_table_describes_every_parameter():
    with open(CORE / "parameters.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    with open(CORE / "test" / "data" / "reference_parameters.csv", newline="") as file:
        reference = [row["name"] for row in csv.DictReader(file)]
    assert len(reference) == 333 and [row["name"] for row in rows[:333]] == reference
    for row in rows:
        assert row["description"].strip(), row["name"]
        assert math.isfinite(float(row["default"])), row["name"]
