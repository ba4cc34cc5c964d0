# SPDX-License-Identifier: BSD-3-Clause
"""A definition that cannot be used is one line and exit code 2, and nothing is written."""

import subprocess
import sys
from pathlib import Path

import pytest

GENERATE = Path(__file__).resolve().parents[1] / "generate.py"


def generate(folder, text, name="Thing"):
    (folder / "my_msgs" / "msg").mkdir(parents=True)
    file = folder / "my_msgs" / "msg" / f"{name}.msg"
    file.write_text(text)
    done = subprocess.run([sys.executable, GENERATE, folder / "out", folder / "my_msgs"], capture_output=True, text=True)
    return done, file


@pytest.mark.parametrize("text, line, words", [
    ("uint8\n", 1, "found 'uint8', allowed TYPE NAME, TYPE NAME DEFAULT or TYPE NAME=VALUE"),
    ("# a\nuint8 a\nuint8 a\n", 3, "'a' is there twice"),
    ("uint8 Big\n", 1, "found the name 'Big', allowed a field in small letters"),
    ("uint8 small=1\n", 1, "found the name 'small', allowed a constant in CAPITALS"),
    ("uint8 A=256\nuint8 a\n", 1, "found '256', allowed a uint8"),
    ("int8 A=x\nuint8 a\n", 1, "found 'x', allowed a int8"),
    ("string A=x\nuint8 a\n", 1, "found a constant of type 'string', allowed bool"),
    ("uint8 a 300\n", 1, "found '300', allowed a uint8"),
    ("string a hello\n", 1, "found a default for 'string'"),
    ("uint8[<=3] a\n", 1, "found the type 'uint8[<=3]', allowed NAME"),
    ("string[] a\n", 1, "found 'string[]', allowed TYPE[COUNT] and TYPE[] of numbers"),
    ("Other[2] a\n", 1, "found 'Other[2]', allowed TYPE[COUNT] and TYPE[] of numbers, bool[COUNT] and MESSAGE[]"),
    ("Other[] a\n", 1, "no definition of my_msgs/Other in the folders given"),
    ("uint8[0] a\n", 1, "found 'uint8[0]', allowed TYPE[COUNT]"),
    ("Other a\n", 1, "no definition of my_msgs/Other in the folders given"),
    ("std_msgs/Header a\n", 1, "no definition of std_msgs/Header in the folders given"),
])
def test_a_malformed_line_is_named(tmp_path, text, line, words):
    done, file = generate(tmp_path, text)
    assert done.returncode == 2
    assert done.stderr.startswith(f"{file}:{line}: {words}")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("text, name, words", [
    ("# nothing\n", "Thing", "found no field, allowed one or more"),
    ("uint8 a\n", "thing", "found the name 'thing', allowed a capital, then letters and digits"),
    ("Thing a\n", "Thing", "my_msgs/Thing contains itself"),
])
def test_a_malformed_file_is_named(tmp_path, text, name, words):
    done, file = generate(tmp_path, text, name)
    assert (done.returncode, done.stderr) == (2, f"{file}: {words}\n")
