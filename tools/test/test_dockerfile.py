# SPDX-License-Identifier: BSD-3-Clause
"""The Dockerfile passes its linter. That the package in it installs and flies is shown by test_install.py."""

import subprocess

from project import ROOT

HADOLINT = ROOT / ".venv" / "bin" / "hadolint"


def test_dockerfile_passes_the_linter():
    done = subprocess.run([HADOLINT, "Dockerfile"], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "")


def test_the_linter_finds_an_image_without_a_version(tmp_path):
    (tmp_path / "Dockerfile").write_text("FROM debian\n")
    done = subprocess.run([HADOLINT, tmp_path / "Dockerfile"], capture_output=True, text=True)
    assert done.returncode == 1 and "DL3006" in done.stdout
