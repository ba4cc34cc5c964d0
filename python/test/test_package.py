# SPDX-License-Identifier: BSD-3-Clause
"""The wheel in an empty environment, what it promises about types, and every command and example that the documents show."""

import re
import shlex
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest
import rosflight

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = ("python/README.md", "docs/python.md", "apps/help/python.txt")


def run(command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, stdin=subprocess.DEVNULL, **options)
    assert done.returncode == 0, f"{command}: {done.stdout[-3000:]}{done.stderr[-3000:]}"
    return done.stdout


def test_the_wheel_flies_in_an_empty_environment(tmp_path):
    """With NumPy alone, in another folder, where nothing of the sources is needed."""
    run([sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", tmp_path, ROOT])
    wheel, = tmp_path.glob("*.whl")
    run([sys.executable, "-m", "venv", tmp_path / "empty"])
    python = tmp_path / "empty/bin/python"
    run([python, "-m", "pip", "install", "--no-input", wheel, f"numpy=={metadata.version('numpy')}"])
    said = run([python, "-c", "import rosflight; print(rosflight.__file__, rosflight.fly(mission='hop', seed=7).log_sha256)"], cwd=tmp_path)
    place, digest = said.split()
    assert Path(place).is_relative_to(tmp_path / "empty")
    assert digest == rosflight.fly(mission="hop", seed=7, out=tmp_path / "here").log_sha256
    lines = run([python, "-c", "import rosflight\ntry: rosflight.read('flights/0001')\nexcept ImportError as e: print(e)"], cwd=tmp_path)
    assert lines == "rosflight.read: found no mcap, allowed with mcap and mcap-ros2-support installed\n"


def test_data_types_and_stubs_are_installed():
    package = Path(rosflight.__file__).parent
    names = {str(path.relative_to(package)) for path in package.rglob("*") if path.is_file()}
    assert {"py.typed", "_core.pyi", "vehicles/multirotor.yaml", "missions/default.yaml"} <= names
    shipped = {str(path.relative_to(ROOT)) for folder in ("vehicles", "missions") for path in (ROOT / folder).rglob("*.yaml")}
    assert shipped <= names


def test_stable_abi_from_python_3_12():
    tags = metadata.distribution("rosflight").read_text("WHEEL")
    wanted = "cp312-abi3" if sys.version_info >= (3, 12) else f"cp3{sys.version_info.minor}-cp3{sys.version_info.minor}"
    assert f"Tag: {wanted}-linux" in tags


def test_pip_and_the_build_use_the_same_packages():
    """What pyproject.toml pins for pip is pinned alike for ./rosflight."""
    listed = re.search(r"^requires = \[(.*)\]$", (ROOT / "pyproject.toml").read_text(), re.M)[1]
    built_with = set(re.findall(r'"([^"]+)"', listed))

    def pinned(name):
        return {line for line in (ROOT / "tools" / name).read_text().splitlines() if line and not line.startswith("#")}

    assert built_with <= pinned("requirements-python.txt")
    assert pinned("requirements-build.txt") <= built_with


def commands():
    lines = [line.strip() for name in DOCUMENTS for line in (ROOT / name).read_text().splitlines() if line.startswith("    ")]
    shown = {re.sub(r"\s+#.*", "", line) for line in lines}
    return sorted(line for line in shown if line.startswith("./rosflight python "))


def with_more(command):
    """Needs gigabytes more, which the tests do not install."""
    return " --with " in command


@pytest.mark.parametrize("command", [command for command in commands() if not with_more(command)])
def test_commands_of_the_documents_run(command, tmp_path):
    words = shlex.split(command)[2:]
    words = [str(ROOT / word) if word.startswith("python/") else word for word in words]
    assert run([sys.executable, *words], cwd=tmp_path)


def test_an_example_without_its_packages_is_one_line_and_exit_code_2():
    command, = (command for command in commands() if with_more(command))
    file = shlex.split(command)[-1]
    done = subprocess.run([sys.executable, str(ROOT / file)], capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and "allowed with ./rosflight python --with sb3" in done.stderr


def test_every_example_is_in_the_documents():
    shown = "\n".join(commands()) + (ROOT / "docs/learned-controller.md").read_text()  # whose commands test_learned.py runs
    assert all(f"python/examples/{path.name}" in shown for path in (ROOT / "python/examples").glob("*.py"))


@pytest.mark.parametrize("block", [block for name in DOCUMENTS[:2]
                                   for block in re.findall(r"^```python\n(.*?)^```", (ROOT / name).read_text(), re.M | re.S)])
def test_python_of_the_documents_runs(block, tmp_path):
    run([sys.executable, "-c", block], cwd=tmp_path)
