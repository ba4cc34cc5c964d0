# SPDX-License-Identifier: BSD-3-Clause
"""What is put right in the wheels of ROS 2 before packages are built against them."""

import os
import re

import wheels


def test_paths_of_the_building_machine_are_rewritten(tmp_path, monkeypatch):
    monkeypatch.setattr(wheels, "VENV", tmp_path)
    monkeypatch.setattr(wheels, "_replacements", lambda: [
        (re.compile(r"/opt/python/cp\d+-cp\d+/include/python3\.\d+"), "/usr/include/python3.11")])
    touched, left = tmp_path / "share/a/A.cmake", tmp_path / "share/b/B.cmake"
    for path, text in ((touched, 'set(x "/opt/python/cp311-cp311/include/python3.11;y")'), (left, "z")):
        path.parent.mkdir(parents=True)
        path.write_text(text)
    os.utime(left, ns=(5, 5))
    wheels.correct_paths()
    assert touched.read_text() == 'set(x "/usr/include/python3.11;y")'
    assert left.stat().st_mtime_ns == 5, "what needs no change is left alone"
