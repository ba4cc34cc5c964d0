# SPDX-License-Identifier: BSD-3-Clause
"""The script ./rosflight in a project of its own, with dpkg, apt, sudo, cmake and ninja replaced."""

import fcntl
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# Stands in for an interpreter: makes an environment in no time, whose pip is always content.
QUICK_PYTHON = """#!/bin/bash
[[ $2 == venv ]] || exit 0
mkdir -p "$3/bin" "$3/lib/python3.11/site-packages/pip"
ln -s "$0" "$3/bin/python3"
"""
PACKAGES = "[run]\ng++\nccache\nold-name @jammy\nnew-name @noble\n[test]\nvalgrind  # counts\n"


class House:
    """A copy of the script in a folder with spaces, and a PATH that starts with replacements."""

    def __init__(self, place: Path):
        self.root = place / "a house"
        self.bin = place / "bin"
        self.calls = place / "calls"
        (self.root / "tools").mkdir(parents=True)
        self.bin.mkdir()
        shutil.copy(ROOT / "rosflight", self.root)
        for name in ("ready.sh", "run_tests.py", "bench.py"):
            shutil.copy(ROOT / "tools" / name, self.root / "tools")
        (self.root / "tools/system_packages.txt").write_text(PACKAGES)
        (self.root / "tools/requirements.txt").write_text("# nothing\n")
        (self.root / "tools/requirements-build.txt").write_text("# nothing\n")
        (self.root / "CMakePresets.json").write_text("{}\n")
        self.python = place / "quick-python"
        self.python.write_text(QUICK_PYTHON)
        self.python.chmod(0o755)
        self.os_release = place / "os-release"
        self.os_release.write_text("VERSION_CODENAME=noble\n")
        self.installed("g++", "ccache", "new-name", "valgrind")
        self.replace("sudo", "exit 1")
        self.replace("apt-get", "exit 0")
        self.replace("id", "echo 1000")
        self.replace("cmake", 'mkdir -p build/$2 && touch build/$2/build.ninja')
        self.replace("ninja", 'mkdir -p "$2/apps" && printf "#!/bin/sh\\necho flown \\"\\$@\\"\\n" '
                              '>"$2/apps/rosflight" && chmod +x "$2/apps/rosflight"')

    def replace(self, name: str, body: str):
        """A program in PATH that notes its call and runs the body."""
        path = self.bin / name
        path.write_text(f'#!/bin/bash\necho "{name} $*" >>"{self.calls}"\n{body}\n')
        path.chmod(0o755)

    def installed(self, *names: str):
        lines = "\\n".join(f"installed {name}" for name in names)
        self.replace("dpkg-query", f"printf '{lines}\\n'")

    def start(self, *arguments: str, **environment: str) -> subprocess.CompletedProcess:
        return subprocess.run(
            [str(self.root / "rosflight"), *arguments], cwd="/", capture_output=True, text=True,
            stdin=subprocess.DEVNULL, timeout=120, env={**self.environment(), **environment})

    def environment(self) -> dict:
        return {**os.environ, "PATH": f"{self.bin}:{os.environ['PATH']}",
                "ROSFLIGHT_OS_RELEASE": str(self.os_release), "ROSFLIGHT_PYTHON": str(self.python)}

    def called(self, program: str) -> list[str]:
        """The calls since the last question."""
        lines = self.calls.read_text().splitlines() if self.calls.exists() else []
        self.calls.write_text("\n".join(l for l in lines if not l.startswith(program + " ")) + "\n")
        return [line for line in lines if line.startswith(program + " ")]


@pytest.fixture
def house(tmp_path):
    return House(tmp_path)


def test_help_lists_the_commands_and_prepares_nothing(house):
    done = house.start("--help")
    assert done.returncode == 0
    for command in ("fly", "replay", "sil", "mixer", "trim", "sdf", "test", "bench"):
        assert f"\n  {command} " in done.stdout
    assert not house.calls.exists() and not (house.root / "build").exists()


@pytest.mark.parametrize("command", ["test", "bench"])
def test_help_of_a_tool_needs_no_ready_machine(house, command):
    done = house.start(command, "--help")
    assert done.returncode == 0
    assert done.stdout.startswith(f"Usage: ./rosflight {command} [NAME...]")
    assert not (house.root / "build").exists()


def test_unknown_command_is_one_line_and_exit_code_2(house):
    done = house.start("fyl")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == ("rosflight: unknown command 'fyl'; "
                           "allowed: fly, view, log, replay, sil, mixer, trim, sdf, params, calibrate, monitor, preflight, blackbox, completion, campaign, python, test, firmware, bench, ros, --help, --version\n")


def test_no_command_shows_the_help_as_an_error(house):
    done = house.start()
    assert done.returncode == 2
    assert "Usage: ./rosflight COMMAND" in done.stderr


def test_missing_packages_without_root_or_sudo_give_the_line_to_run(house):
    house.installed("ccache")
    done = house.start("fly")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == (
        "sudo apt-get update && sudo apt-get install -y --no-install-recommends g++ new-name")
    assert house.called("apt-get") == []


def test_missing_packages_are_installed_by_root_for_this_release_only(house):
    house.installed("g++", "new-name")
    house.os_release.write_text("VERSION_CODENAME=virginia\nUBUNTU_CODENAME=jammy\n")
    house.replace("id", "echo 0")
    assert house.start("fly").returncode == 0
    update, install = house.called("apt-get")
    assert update.endswith(" update")
    assert install.endswith(" install -y --no-install-recommends ccache old-name")


def test_missing_packages_are_installed_with_sudo_that_asks_nothing(house):
    house.installed("g++")
    house.replace("sudo", '[[ $2 == true ]] || exec "${@:2}"')
    assert house.start("fly").returncode == 0
    assert [line.split()[-1] for line in house.called("apt-get")] == ["update", "new-name"]
    assert all(line.startswith("sudo -n ") for line in house.called("sudo"))


def test_failing_apt_shows_what_it_said(house):
    house.installed("ccache")
    house.replace("id", "echo 0")
    house.replace("apt-get", "echo E: no such package; exit 100")
    done = house.start("fly")
    assert done.returncode == 2
    assert "E: no such package" in done.stderr and "apt.log" in done.stderr


def test_program_gets_the_arguments_as_they_are(house):
    done = house.start("fly", "--mission", "two words.yaml", "")
    assert (done.returncode, done.stdout) == (0, "flown fly --mission two words.yaml \n")


def test_second_start_installs_and_configures_nothing(house):
    house.start("fly")
    for program in ("dpkg-query", "cmake", "ninja"):
        assert house.called(program)
    done = house.start("fly")
    assert (done.returncode, done.stderr) == (0, "")
    assert house.called("dpkg-query") == house.called("cmake") == []
    assert house.called("ninja")  # ninja itself finds out that nothing changed


def test_arm64_is_built_where_debians_packages_for_it_are(house):
    """Without root and without a foreign architecture: its libraries are unpacked, not installed."""
    shutil.copy(ROOT / "tools/arm64.sh", house.root / "tools")
    (house.root / "tools/system_packages.txt").write_text("[run]\ng++\n[arm64]\ncompiler\n[arm64-depends]\nlibone\n[arm64-root]\nlibone-dev\n")
    house.installed("g++", "compiler")
    build = [str(house.root / "tools/ready.sh"), "build", "arm64"]
    refused = subprocess.run(build, env=house.environment(), capture_output=True, text=True)
    assert refused.returncode == 2
    assert refused.stderr == f"rosflight: preset arm64: found {house.os_release} of noble, allowed Debian 12 (bookworm)\n"
    house.os_release.write_text("VERSION_CODENAME=bookworm\n")
    house.replace("apt-get", '[[ $* != *" download "* ]] || touch libone.deb libone-dev.deb')
    house.replace("dpkg-deb", 'mkdir -p "$3/usr/lib" && touch "$3/usr/lib/$(basename "$2")"')
    done = subprocess.run(build, env=house.environment(), capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert (house.root / "build/arm64-root/depends").read_text() == "libone\n"
    assert {p.name for p in (house.root / "build/arm64-root/usr/lib").iterdir()} == {"libone.deb", "libone-dev.deb"}
    update, download = house.called("apt-get")
    assert download.endswith(" download libone libone-dev") and "Dir::State::status=" in update
    assert "preset arm64" in house.called("cmake")[0]
    subprocess.run(build, env=house.environment(), check=True)
    assert house.called("apt-get") == []
    subprocess.run([*build[:-1], "arm64-tests"], env=house.environment(), check=True)
    assert house.called("apt-get") == [] and "preset arm64-tests" in house.called("cmake")[-1]


def test_gazebos_engine_is_installed_and_built_when_a_flight_asks_for_it(house):
    (house.root / "tools/system_packages.txt").write_text("[run]\ng++\n[gazebo]\nlibgazebo @bookworm\n")
    house.os_release.write_text("VERSION_CODENAME=bookworm\n")
    house.installed("g++")
    assert house.start("fly").returncode == 0
    assert not any("gazebo" in call for call in house.called("cmake"))
    refused = house.start("fly", "--physics", "gazebo")
    assert refused.returncode == 2 and refused.stderr.endswith(" libgazebo\n")
    house.installed("g++", "libgazebo")
    for words in (["--physics", "gazebo"], ["--physics=gazebo"]):
        shutil.rmtree(house.root / "build/gazebo", ignore_errors=True)
        assert house.start("fly", *words).returncode == 0
        assert "preset gazebo" in house.called("cmake")[0]
        assert any(call.endswith(" gazebo_engine") for call in house.called("ninja"))


@pytest.mark.parametrize("words", [["--physics", "jsbsim"], ["--physics=jsbsim"]])
def test_jsbsims_environment_is_made_when_a_flight_asks_for_it(words, house):
    (house.root / "tools/requirements-jsbsim.txt").write_text("jsbsim\n")
    assert house.start("fly").returncode == 0
    assert not (house.root / ".venv-jsbsim").exists()
    assert house.start("fly", *words).returncode == 0
    assert (house.root / ".venv-jsbsim/.stamp").exists()


def test_a_release_without_gazebo_is_named_its_packages(house):
    (house.root / "tools/system_packages.txt").write_text("[run]\ng++\n[gazebo]\nlibgazebo @bookworm\n")
    house.os_release.write_text("VERSION_CODENAME=noble\n")
    house.installed("g++")
    done = house.start("fly", "--physics", "gazebo")
    assert "libgz-physics7-dev libgz-common5-dev libgz-plugin2-dev" in done.stderr
    house.os_release.write_text("VERSION_CODENAME=bookworm\n")
    house.installed("g++", "libgazebo")
    assert "libgz-physics7-dev" not in house.start("fly", "--physics", "gazebo").stderr


def test_changed_package_list_is_looked_through_again(house):
    house.start("fly")
    house.called("dpkg-query")
    (house.root / "tools/system_packages.txt").write_text("[run]\nnovel\n")
    done = house.start("fly")
    assert done.returncode == 2
    assert done.stderr.endswith(" novel\n")


def test_more_packages_for_python_come_first_in_its_path(house):
    (house.root / "tools/requirements-python.txt").write_text("# nothing\n")
    (house.root / "tools/requirements-sb3.txt").write_text("stable-baselines3\n")
    (house.root / "tools/system_packages.txt").write_text("[run]\ng++\n[python]\n")
    # In place of the package, which does not build here: what ready_python looks at.
    script = house.root / "tools/ready.sh"
    script.write_text(script.read_text() + '\nready_python() { mkdir -p "$root/.venv-python/bin" && ln -sf "$(command -v env)" '
                      '"$root/.venv-python/bin/python3"; }\n')
    done = house.start("python")
    assert done.returncode == 0 and "PYTHONPATH" not in done.stdout and not (house.root / ".venv-sb3").exists()
    done = house.start("python", "--with", "sb3")
    assert f"PYTHONPATH={house.root}/.venv-sb3/lib/python3.11/site-packages\n" in done.stdout
    for words in (["--with"], ["--with", "tf"]):
        refused = house.start("python", *words)
        assert refused.returncode == 2
        assert refused.stderr == f"rosflight: python --with: found '{words[1] if words[1:] else 'nothing'}', allowed sb3\n"


def test_a_policy_is_built_in_while_its_file_is_named(house):
    (house.root / "tools/requirements-policy.txt").write_text("# nothing\n")
    file = house.root / "policy.onnx"
    file.touch()
    for policy, option in ((str(file), f" -DROSFLIGHT_POLICY={file}"), ("", "")):
        assert house.start("fly", ROSFLIGHT_POLICY=policy).returncode == 0
        assert house.called("cmake") == [f"cmake --preset release -DROSFLIGHT_QUICK_BUILD=ON{option}"]
        assert (house.root / ".venv-policy").is_dir()


def test_a_policy_without_a_file_is_one_line_and_exit_code_2(house):
    done = house.start("fly", ROSFLIGHT_POLICY="none.onnx")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == "rosflight: ROSFLIGHT_POLICY: found 'none.onnx', allowed the path of an ONNX file"
    assert house.called("cmake") == []


def test_the_package_is_built_with_the_policy_while_its_file_is_named(house):
    house.python.write_text(QUICK_PYTHON.replace("exit 0", f'{{ echo "python $*" >>"{house.calls}"; exit 0; }}'))
    for name in ("policy", "python"):
        (house.root / f"tools/requirements-{name}.txt").write_text("# nothing\n")
    file = house.root / "policy.onnx"
    file.touch()
    os.utime(file, (1, 1))
    installed = house.root / ".venv-python/lib/python3.11/site-packages/rosflight"

    def built(policy: str) -> list[str]:
        """The policy of each time that the package was built."""
        assert house.start("python", ROSFLIGHT_POLICY=policy).returncode == 0
        installed.mkdir(exist_ok=True)
        calls = "\n".join(house.called("python"))
        return re.findall(r"--config-settings=cmake\.define\.ROSFLIGHT_POLICY=(.*) /", calls)

    assert built(str(file)) == [str(file)]
    assert built(str(file)) == []
    assert built("") == [""]
    assert built("") == []
    assert built(str(file)) == [str(file)]
    time.sleep(0.01)
    file.touch()
    assert built(str(file)) == [str(file)], "it has changed"
    assert house.start("python", ROSFLIGHT_POLICY="none.onnx").returncode == 2


def test_changed_presets_configure_again(house):
    house.start("fly")
    house.called("cmake")
    (house.root / "build/release/CMakeCache.txt").write_text("old values")
    (house.root / "CMakePresets.json").write_text("{ }\n")
    house.start("fly")
    assert house.called("cmake") == ["cmake --preset release -DROSFLIGHT_QUICK_BUILD=ON"]
    assert not (house.root / "build/release/CMakeCache.txt").exists()


@pytest.mark.parametrize("harm", ["python", "stamp", "package", "half"])
def test_broken_environment_is_remade(house, harm):
    house.start("fly")
    venv = house.root / ".venv-build"
    (venv / "left over").touch()
    if harm == "python":
        (venv / "bin/python3").unlink()
        (venv / "bin/python3").symlink_to("/nonexistent/python3")
    elif harm == "stamp":
        (venv / ".stamp").unlink()
    elif harm == "package":
        shutil.rmtree(next(venv.glob("lib/python3*/site-packages/pip")))
    else:
        shutil.rmtree(venv)
        (venv / "left over").mkdir(parents=True)
    done = house.start("fly")
    assert done.returncode == 0
    assert "making the Python environment" in done.stderr
    assert not (venv / "left over").exists()
    assert (venv / "lib/python3.11/site-packages/pip").exists()
    assert house.start("fly").stderr == ""


def test_environment_is_made_by_a_real_interpreter_and_has_pip(house):
    house.python = Path(sys.executable)
    assert house.start("fly").returncode == 0
    python = house.root / ".venv-build/bin/python3"
    assert subprocess.run([python, "-m", "pip", "--version"], capture_output=True).returncode == 0


def test_moved_folder_makes_environment_and_build_anew(house):
    house.start("fly")
    (house.root / "build/release/stale").touch()
    house.root = house.root.rename(house.root.with_name("another house"))
    done = house.start("fly")
    assert done.returncode == 0
    assert "making the Python environment" in done.stderr and "configuring" in done.stderr
    assert not (house.root / "build/release/stale").exists()


def test_changed_requirements_update_the_environment_in_place(house):
    house.start("fly")
    (house.root / ".venv-build/kept").touch()
    (house.root / "tools/requirements-build.txt").write_text("# still nothing\n")
    assert "up to date" in house.start("fly").stderr
    assert (house.root / ".venv-build/kept").exists()


def test_requirement_that_pip_cannot_install_is_told_and_tried_again(house):
    house.python = Path(sys.executable)
    (house.root / "tools/requirements-build.txt").write_text("/nonexistent/wheel.whl\n")
    for _ in range(2):
        done = house.start("fly")
        assert done.returncode == 2
        assert "pip could not install tools/requirements-build.txt" in done.stderr


def test_failing_build_shows_the_error_and_not_the_command_lines(house):
    house.replace("ninja", 'echo "[1/2] Building CXX"; echo "FAILED: a.o"; '
                           'echo "/usr/bin/ccache g++ a.cpp"; echo "a.cpp:1: error: no"; exit 1')
    done = house.start("fly")
    assert (done.returncode, done.stdout) == (2, "")
    assert "a.cpp:1: error: no" in done.stderr and "build.log" in done.stderr
    assert "/usr/bin/ccache" not in done.stderr


def test_failing_configure_is_told_and_tried_again(house):
    house.replace("cmake", 'echo "CMake Error: no compiler"; exit 1')
    for _ in range(2):
        done = house.start("fly")
        assert done.returncode == 2
        assert "CMake Error: no compiler" in done.stderr and house.called("cmake")


def test_the_other_commands_build_and_run_their_own_program(house):
    house.replace("ninja", 'mkdir -p "$2/apps" && printf "#!/bin/sh\\necho tool \\"\\$@\\"\\n" '
                           '>"$2/apps/rosflight_tools" && chmod +x "$2/apps/rosflight_tools"')
    for command in ("replay", "sil", "mixer", "trim", "sdf"):
        assert house.start(command, "word").stdout == f"tool {command} word\n"
    assert all(call.endswith(" rosflight_tools") for call in house.called("ninja"))


def test_progress_of_a_build_is_a_line_each_tenth_without_a_terminal(house):
    house.replace("ninja", 'for i in $(seq 200); do echo "[$i/200] Building"; done')
    (house.root / "build/release/apps").mkdir(parents=True)
    shutil.copy("/bin/true", house.root / "build/release/apps/rosflight")
    lines = [l for l in house.start("fly").stderr.splitlines() if "building" in l]
    assert lines[0].endswith("building release 0 %") and lines[-1].endswith("100 %")
    assert len(lines) == 11


def test_home_that_takes_nothing_puts_the_compiler_cache_into_the_build(house):
    house.replace("ninja", f'echo "cache ${{CCACHE_DIR:-none}}" >>"{house.calls}"')
    (house.root / "build/release/apps").mkdir(parents=True)
    shutil.copy("/bin/true", house.root / "build/release/apps/rosflight")
    environment = {"HOME": "/proc", "XDG_CACHE_HOME": "", "CCACHE_DIR": ""}
    assert house.start("fly", **environment).returncode == 0
    assert house.called("cache") == [f"cache {house.root}/build/ccache"]


def test_two_starts_at_once_prepare_one_after_the_other(house):
    house.replace("cmake", 'mkdir build/busy || exit 1; sleep 0.3; rmdir build/busy; '
                           'mkdir -p build/$2; touch build/$2/build.ninja')
    both = [subprocess.Popen([str(house.root / "rosflight"), "fly"], env=house.environment(),
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            for _ in range(2)]
    assert [process.wait(timeout=120) for process in both] == [0, 0]
    assert house.called("cmake") == ["cmake --preset release -DROSFLIGHT_QUICK_BUILD=ON"]


def test_a_long_build_of_one_preset_does_not_keep_another_waiting(house):
    house.start("fly")
    house.replace("ninja", 'while [[ $2 == *sanitizers && ! -e end ]]; do sleep 0.02; done')
    ready = ["bash", str(house.root / "tools/ready.sh"), "build"]
    long = subprocess.Popen([*ready, "sanitizers"], env=house.environment(), cwd=house.root, stderr=subprocess.DEVNULL)
    try:
        assert subprocess.run([*ready, "release"], env=house.environment(), cwd=house.root, timeout=60).returncode == 0
        assert long.poll() is None
    finally:
        (house.root / "end").touch()
    assert long.wait(timeout=60) == 0


def test_an_environment_that_takes_long_does_not_keep_a_build_waiting(house):
    locks = house.root / "build/.ready"
    locks.mkdir(parents=True)
    with (locks / "lock-venv-ros").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        made = subprocess.Popen(
            ["bash", house.root / "tools/ready.sh", "environment", ".venv-ros", "tools/requirements.txt"],
            stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, env=house.environment())
        assert b"waiting for it" in made.stderr.readline()
        run = house.start("fly")
        assert (run.returncode, "waiting for it" in run.stderr) == (0, False)
    made.communicate(timeout=30)
    assert made.returncode == 0


def test_a_flight_needs_no_python_packages_but_those_of_the_build(house):
    assert house.start("fly").returncode == 0
    assert (house.root / ".venv-build").exists() and not (house.root / ".venv").exists()


@pytest.mark.parametrize("command, packages", [
    ("rosflight fly --view", "npm ci --omit=dev"), ("rosflight view folder", "npm ci --omit=dev"), ("tools/ready.sh web test", "npm ci")])
def test_only_what_shows_or_tests_the_page_builds_it(house, command, packages):
    (house.root / "web").mkdir()
    (house.root / "web/package-lock.json").write_text("{}\n")
    (house.root / "tools/requirements-web.txt").write_text("# nothing\n")
    house.replace("npm", "mkdir node_modules")
    house.replace("node", "exit 0")
    assert house.start("fly").returncode == 0
    assert house.called("npm") == house.called("node") == [] and not (house.root / ".venv-web").exists()
    subprocess.run(["bash", *command.split()], cwd=house.root, env=house.environment(), capture_output=True, timeout=120)
    assert house.called("npm") == [packages]
    assert house.called("node") == [f"node build.mjs {house.root}/build/web"]


@pytest.fixture
def interruptible():
    """Started in the background of a shell, this process ignores SIGINT, and so would all that it starts."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def wait_for(condition) -> bool:
    end = time.monotonic() + 30
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_start_that_is_stopped_stops_its_build_and_frees_the_lock(house, tmp_path, number, interruptible):
    compiler = tmp_path / "compiler"
    house.replace("ninja", f'sleep 300 & echo $! >"{compiler}.new"; mv "{compiler}.new" "{compiler}"; wait')
    run = subprocess.Popen([house.root / "rosflight", "fly"], cwd="/", stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                           stderr=subprocess.PIPE, env=house.environment())
    assert wait_for(compiler.exists)
    pid = int(compiler.read_text())
    assert alive(pid)
    run.send_signal(number)
    run.communicate(timeout=30)
    assert run.returncode == 128 + number
    assert wait_for(lambda: not alive(pid)), "the compiler runs on"
    house.replace("ninja", 'mkdir -p "$2/apps" && printf "#!/bin/sh\\necho flown\\n" >"$2/apps/rosflight" '
                           '&& chmod +x "$2/apps/rosflight"')
    again = house.start("fly")
    assert (again.returncode, again.stdout) == (0, "flown\n")
    assert "waiting for it" not in again.stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_tool_that_is_stopped_stops_what_it_has_started(tmp_path, number, interruptible):
    note = tmp_path / "child"
    program = (f"import sys, subprocess; sys.path.insert(0, {str(ROOT / 'tools')!r}); import project\n"
               "project.end_children_with_us()\n"
               f"subprocess.run(['bash', '-c', 'sleep 300 & echo $! >{note}.new; mv {note}.new {note}; wait'])\n")
    run = subprocess.Popen([sys.executable, "-c", program])
    assert wait_for(note.exists)
    run.send_signal(number)
    assert run.wait(timeout=30) == 128 + number
    assert wait_for(lambda: not alive(int(note.read_text())))
