# SPDX-License-Identifier: BSD-3-Clause
"""What `cmake --install` and cpack give away: it flies, and projects outside the tree build on it.

Programs run where the source tree does not exist: in a mount namespace that hides it. Where the machine forbids that,
the check that nothing names the tree remains.
"""

import json
import os
import shutil
import subprocess
from pathlib import Path

import project
import pytest
from project import ROOT

BUILD = ROOT / "build" / "release"
SHORT = ("fly", "--json", "--seed", "7", "--mission", "hop")


def run(*command, **options):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=1200, **options)
    assert done.returncode == 0, f"{command}: {done.stdout[-2000:]}{done.stderr[-2000:]}"
    return done.stdout


def can_hide() -> bool:
    return subprocess.run(["unshare", "--map-root-user", "--mount", "true"], capture_output=True).returncode == 0


def without_tree(*command, **options):
    """Runs a command where the folder of the sources is empty."""
    if not can_hide():
        return run(*command, **options)
    return run("unshare", "--map-root-user", "--mount", "sh", "-c", 'mount -t tmpfs none "$0" && exec "$@"', ROOT,
               *command, **options)


def digest(text: str) -> str:
    flight = json.loads(text)
    assert flight["success"]
    return flight["log_sha256"]


@pytest.fixture(scope="module")
def prefix(tmp_path_factory) -> Path:
    """An installation of what `./rosflight fly` builds and no more, moved after it was made."""
    assert project.build("release", "rosflight")
    folder = tmp_path_factory.mktemp("install")
    run("cmake", "--install", BUILD, "--prefix", folder / "made")
    (folder / "made").rename(folder / "moved")
    return folder / "moved"


@pytest.fixture(scope="module")
def flown(tmp_path_factory) -> str:
    """The log of the program in the tree."""
    out = tmp_path_factory.mktemp("tree") / "flight"
    return digest(run(BUILD / "apps" / "rosflight", *SHORT, "--out", out, cwd=ROOT))


def built(prefix: Path, example: str, folder: Path) -> Path:
    """The example copied away and built with nothing but the installation."""
    shutil.copytree(ROOT / "examples" / example, folder / "source")
    clean = {name: value for name, value in os.environ.items() if not name.startswith("CMAKE")}
    without_tree("cmake", "-G", "Ninja", "-S", folder / "source", "-B", folder / "build", "-DCMAKE_BUILD_TYPE=Release",
                 f"-DCMAKE_PREFIX_PATH={prefix}", env=clean)
    without_tree("cmake", "--build", folder / "build", env=clean)
    used = run("ninja", "-C", folder / "build", "-t", "deps")
    assert f"{ROOT}/" not in used, "an include of the source tree"
    return folder / "build"


def test_it_flies_from_any_folder_to_the_same_log(prefix, flown, tmp_path):
    assert digest(without_tree(prefix / "bin/rosflight", *SHORT, "--out", tmp_path / "f", cwd=tmp_path)) == flown


def test_the_tools_come_along(prefix):
    assert "phugoid" in without_tree(prefix / "bin" / "rosflight", "trim", "--speed", "18")


def test_without_the_tools_one_line_says_what_is_missing(tmp_path):
    alone = shutil.copy(BUILD / "apps" / "rosflight", tmp_path)
    done = subprocess.run([alone, "mixer", "--help"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (f"rosflight: mixer needs {tmp_path}/rosflight_tools: No such file or directory "
                           "(./rosflight mixer builds it)\n")


def test_no_file_names_the_source_tree(prefix):
    texts = [path for path in prefix.rglob("*") if path.suffix in (".cmake", ".hpp", ".yaml")]
    assert len(texts) > 100
    assert not [path for path in texts if f"{ROOT}/" in path.read_text()]


def test_a_module_of_another_project_changes_the_flight(prefix, flown, tmp_path):
    plugin = built(prefix, "custom_drag", tmp_path) / "libcustom_drag.so"
    vehicle = tmp_path / "linear_drag.yaml"
    text = (ROOT / "examples/custom_drag/linear_drag.yaml").read_text()
    vehicle.write_text(text.replace("../../vehicles", f"{prefix}/share/rosflight/vehicles"))
    said = without_tree(prefix / "bin/rosflight", *SHORT, "--out", tmp_path / "f", "--plugin", plugin,
                        "--vehicle", vehicle, cwd=tmp_path)
    assert digest(said) != flown


def test_a_program_of_another_project_flies_its_own_controller(prefix, flown, tmp_path):
    program = built(prefix, "own_controller", tmp_path) / "own_controller"
    data = {**os.environ, "ROSFLIGHT_DATA_DIR": str(prefix / "share/rosflight")}
    without_tree(program, tmp_path / "flight", "hop", cwd=tmp_path, env=data)
    assert list((tmp_path / "flight").glob("*.mcap"))
    missing = subprocess.run([program, tmp_path / "none"], cwd=tmp_path, capture_output=True, text=True,
                             env={**os.environ, "ROSFLIGHT_DATA_DIR": str(tmp_path)})
    assert missing.returncode == 2
    assert missing.stderr.strip() == (f"ROSFLIGHT_DATA_DIR: found {tmp_path}, allowed a folder with vehicles/ and "
                                      "missions/")


@pytest.mark.skipif(not shutil.which("dpkg-shlibdeps"), reason="no Debian system")
def test_the_debian_package_flies(prefix, flown, tmp_path):
    run("cpack", "-G", "DEB", "-B", tmp_path, cwd=BUILD)
    package = next(tmp_path.glob("*.deb"))
    assert "libyaml-cpp" in run("dpkg-deb", "--field", package, "Depends")
    run("dpkg-deb", "--extract", package, tmp_path / "root")
    program = tmp_path / "root/usr/bin/rosflight"
    assert digest(without_tree(program, *SHORT, "--out", tmp_path / "f", cwd=tmp_path)) == flown
