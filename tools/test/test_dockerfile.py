# SPDX-License-Identifier: BSD-3-Clause
"""The Dockerfiles pass their linter. That the package in the first installs and flies is shown by test_install.py."""

import subprocess

import pytest
from project import ROOT

HADOLINT = ROOT / ".venv" / "bin" / "hadolint"


FILES = ["Dockerfile", "docker/humble.Dockerfile", "docker/jazzy.Dockerfile"]


@pytest.mark.parametrize("file", FILES)
def test_dockerfile_passes_the_linter(file):
    done = subprocess.run([HADOLINT, file], cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "")


def test_no_dockerfile_is_left_out():
    assert {str(path.relative_to(ROOT)) for path in [ROOT / "Dockerfile", *ROOT.glob("docker/*Dockerfile")]} == set(FILES)


@pytest.mark.parametrize("distribution", ["humble", "jazzy"])
def test_an_image_with_ros_differs_in_the_distribution_only_and_runs_what_the_readme_says(distribution):
    text = (ROOT / f"docker/{distribution}.Dockerfile").read_text()
    assert text.lower().replace(distribution, "X") == (ROOT / "docker/jazzy.Dockerfile").read_text().lower().replace("jazzy", "X")
    readme = (ROOT / "ros/README.md").read_text()
    for command in ("rosdep install --from-paths . ros --ignore-src", "tools/ready.sh packages run",
                    "tools/ready.sh build release rosflight_libraries", "colcon build --base-paths ros"):
        assert command in readme and command in text.replace(f"--rosdistro {distribution} ", ""), command


def test_the_linter_finds_an_image_without_a_version(tmp_path):
    (tmp_path / "Dockerfile").write_text("FROM debian\n")
    done = subprocess.run([HADOLINT, tmp_path / "Dockerfile"], capture_output=True, text=True)
    assert done.returncode == 1 and "DL3006" in done.stdout
