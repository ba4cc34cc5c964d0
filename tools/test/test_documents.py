# SPDX-License-Identifier: BSD-3-Clause
"""Every command that a document shows is run as written, or what shows it instead is named here.

Commands are the lines of code blocks that begin as one, and `./rosflight ...` between backticks in a text. They run in a
folder that looks like the root of the project, so that what they write is thrown away; /tmp stands for a folder of
that run. Blocks of C++ and Python in a document must be found in the sources.
"""

import os
import re
import shlex
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest
from project import ROOT, own_files
from stages import fuzzers

PROGRAMS = r"(?:docker|\./rosflight|P/bin|cmake|ninja|ctest|build/\S+|tools/\S+|\.venv/bin/\S+|colcon|ros2|[A-Z_]+=\S+ )"
OTHER_LANGUAGES = ("cpp", "python", "mermaid")
HISTORY = "CHANGELOG.md"

# What is not run here: the beginning of a command (a regular expression) -> what shows it, or why nothing can.
ELSEWHERE = {
    r"\./rosflight test\b": "this is a part of it",
    r"\./rosflight (params|calibrate|monitor|preflight) \S+:": "ground/test/test_sil_ground_tools.py, line by line",
    r"\./rosflight (view|fly --view)\b": "web/test/page.browser.test.ts",
    r"\./rosflight python\b": "python/test/test_package.py",
    r"\./rosflight campaign\b": "python/test/test_campaign_command.py",
    r"ROSFLIGHT_POLICY=": "builds another firmware: python/test/test_learned.py runs the page, tools/test/test_ready.py the variable",
    r"\./rosflight bench\b": "tools/test/test_bench.py; measuring takes minutes",
    r"\./rosflight ros (build|run|demo)\b": "the stage ros of ./rosflight test",
    r"docker ": "needs a Docker daemon; tools/test/test_dockerfile.py and test_the_debian_package_flies",
    r"colcon build": "needs a ROS installation, or what the stage ros installs",
    r"ros2 run .*port:=/dev/": "needs hardware",
    r"ros2 (launch|run) ros(copter|flight|plane)_": "ros/forwarders/test/test_documented_commands.py",
    r"ros2 run rosflight_io": "ros/rosflight_io/test, by each kind of link",
    r"ros2 (launch own_modules|service call toggle_(arm|override))": "ros/examples/test/test_own_modules.py",
    r"cmake (-S \. -B build -DCMAKE_INSTALL_PREFIX=install|--build build --target install)": "ros/examples/test/test_own_modules.py",
    r"tools/ready.sh (packages|venv)": "each start of ./rosflight",
    r"tools/ready.sh build arm64": "the stage arm64-rest of ./rosflight test",
    r"tools/ready.sh build gazebo": "the stage build of ./rosflight test",
    r"tools/ready.sh web": "the stage web of ./rosflight test",
    r"\.venv/bin/python3 tools/beyond_one_machine.py": "tools/test/test_beyond_one_machine.py",
    r"\.venv/bin/python3 flight/jsbsim/jsbsim_compare.py": "flight/jsbsim/test",
    r"\./rosflight fly --physics": "flight/jsbsim/test/test_physics_command.py",
    r"\./rosflight fly --board qemu_m7": "flight/test/emulated_test.cpp",
    r"\./rosflight fly --board pixracer_pro": "flight/test/h7_flight_test.cpp",
    r"\./rosflight fly --board varmint": "flight/test/h7_flight_test.cpp",
    r"\./rosflight firmware flash": "needs hardware; tools/test/test_firmware_files.py",
    r"\./rosflight (preflight|monitor|blackbox) /dev/ttyACM0": "needs hardware; flight/test/h7_record_test.cpp reads a record",
    r"\./rosflight firmware build": "the stage cortex-m7 of ./rosflight test",
    r"build/sanitizers/\w+/fuzz_": "the stage fuzz of ./rosflight test",
    r".*\.venv/bin/(python -m )?pytest\b": "the stage python of ./rosflight test",
    r"build/release/apps/measure/sil_link_latency": "apps/measure: real time, for a person to look at",
}


@dataclass(frozen=True)
class Command:
    file: str
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.text}"


def documents() -> list[Path]:
    return [path for path in own_files() if path.suffix == ".md"]


def commands_of(path: Path) -> list[Command]:
    found, fence, pending = [], None, ""
    for number, line in enumerate((ROOT / path).read_text().splitlines(), 1):
        if line.startswith("```"):
            fence = None if fence is not None else line[3:]
            continue
        code = fence is not None and fence not in OTHER_LANGUAGES or fence is None and line.startswith("    ")
        if not code:
            found += [Command(str(path), number, text) for text in re.findall(r"`(\./rosflight [^`]+)`", line)
                      if fence is None]
            continue
        text = pending + line.strip()
        if text.endswith("\\"):
            pending = text[:-1]
            continue
        pending = ""
        if not re.match(PROGRAMS, text):
            continue
        text = re.sub(r"\s+#.*", "", text)
        found += [Command(str(path), number, part.strip()) for part in re.split(r"&&|;(?=\s)", text)]
    return found


COMMANDS = [command for path in documents() if path.name != HISTORY for command in commands_of(path)]


def is_elsewhere(command: Command) -> bool:
    return any(re.match(pattern, command.text) for pattern in ELSEWHERE)


def is_usage(command: Command) -> bool:
    """It has words to be replaced: FILE, [NAME...], or no argument where one is needed."""
    words = command.text.split()
    if words[0] == "./rosflight" and len(words) == 2 and not words[1].startswith("fly"):
        return True
    return bool(re.search(r"\[|\.\.\.|\||(?<![\w/.=-])[A-Z]{3,}(?![\w.])|--vehicle V\b", command.text))


def of(prefix: str) -> list[Command]:
    return [c for c in COMMANDS if c.text.startswith(prefix) and not is_elsewhere(c)]


def once(commands: list[Command]) -> list[Command]:
    """Each text once."""
    return list({command.text: command for command in commands}.values())


USAGES = [c for c in COMMANDS if c.text.startswith("./rosflight") and is_usage(c) and not is_elsewhere(c)]
LAUNCHES = [c for c in of("./rosflight ros ") if c not in USAGES]
SILS = [c for c in of("./rosflight sil") if c not in USAGES]
# What builds outside the tree: the commands of one document in their order.
STEPS = [c for c in COMMANDS if re.match(r"cmake --install|cmake -S|cmake --build|P/bin/|ROSFLIGHT_DATA_DIR=|"
                                         r"\./rosflight fly --plugin", c.text) and not is_elsewhere(c)]
RUNS = [c for c in of("./rosflight ") + of("build/release/examples") + of("build/release/bench/worlds") if c not in USAGES + LAUNCHES + SILS + STEPS]
BUILDS = of("cmake --preset") + of("tools/ready.sh build") + of("ninja -C build/") + of("ctest --test-dir build/") + of("build/release/link/test")


def test_every_command_is_looked_at():
    known = {*USAGES, *LAUNCHES, *SILS, *STEPS, *RUNS, *BUILDS}
    unknown = [str(c) for c in COMMANDS if c not in known and not is_elsewhere(c)]
    assert not unknown, "\n".join(unknown)
    assert len(COMMANDS) > 120, "the documents are read"
    unused = [pattern for pattern in ELSEWHERE if not any(re.match(pattern, c.text) for c in COMMANDS)]
    assert not unused, f"no document shows these any more: {unused}"


def test_what_shows_a_command_elsewhere_exists():
    for reason in ELSEWHERE.values():
        for path in re.findall(r"\b(?:[a-z_0-9]+/)+[a-z_0-9.]+", reason):
            assert (ROOT / path).exists(), path


@pytest.fixture(scope="module")
def root(tmp_path_factory) -> Path:
    """Looks like the root of the project; what is written into it is thrown away."""
    folder = tmp_path_factory.mktemp("root")
    for entry in ROOT.iterdir():
        if entry.name not in ("build", "flights"):
            (folder / entry.name).symlink_to(entry)
    (folder / "build").mkdir()
    (folder / "scratch").mkdir()
    (folder / "flights").mkdir()
    (folder / "build" / "release").symlink_to(ROOT / "build" / "release")
    tutorial = (ROOT / "docs" / "own-airframe.md").read_text()
    (folder / "my_hexa.yaml").write_text(vehicle_of(tutorial))
    (folder / "pilot.yaml").write_text("events: [{at_s: 2, switch: arm, on: true}]\n")
    return folder


def vehicle_of(tutorial: str) -> str:
    """The two blocks of YAML of docs/own-airframe.md, one after the other."""
    blocks = re.findall(r"(?:^    [^\n]*\n)+", tutorial, re.M)
    return "".join(re.sub("^    ", "", block, flags=re.M) for block in blocks if "./rosflight" not in block)


def run(command: str, root: Path, scratch: Path | None = None) -> subprocess.CompletedProcess:
    text = command.replace("/tmp/", f"{scratch or root / 'scratch'}/")
    return subprocess.run(["bash", "-c", text], cwd=root, capture_output=True, text=True, timeout=300)


@pytest.mark.parametrize("command", once(RUNS), ids=str)
def test_it_runs(command, root):
    done = run(command.text, root)
    assert done.returncode == 0, f"{command}\n{done.stdout[-1500:]}{done.stderr[-1500:]}"


@pytest.mark.parametrize("file", sorted({command.file for command in STEPS}))
def test_steps_outside_the_tree(file, tmp_path, root):
    for command in STEPS:
        if command.file == file:
            done = run(command.text, root, tmp_path)
            assert done.returncode == 0, f"{command}\n{done.stdout[-1500:]}{done.stderr[-1500:]}"


@pytest.mark.parametrize("command", once(SILS), ids=str)
def test_sil_starts(command, root):
    text = command.text.replace("/tmp/", f"{root}/scratch/").removesuffix("&")
    process = subprocess.Popen(shlex.split(text), cwd=root, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               start_new_session=True)
    try:
        first = process.stdout.readline()
    finally:
        os.killpg(process.pid, signal.SIGINT)
        _, complaint = process.communicate(timeout=30)
    assert first.startswith("sil ready link="), f"{command}: {first}{complaint}"


@pytest.mark.parametrize("command", once(USAGES), ids=str)
def test_a_usage_names_options_that_exist(command):
    words = command.text.split()
    name = words[1]
    if name.startswith("-") or name in ("ros", "test", "bench", "log"):
        text = run(f"./rosflight {name} --help", ROOT).stdout + "--help"
    else:
        text = (ROOT / "apps" / "help" / f"{name}.txt").read_text()
    for option in re.findall(r"(?<!\w)--?[a-z][a-z-]*", command.text):
        assert re.search(rf"(?<![\w-]){option}\b", text), f"{command}: no option {option}"


@pytest.mark.parametrize("command", once(LAUNCHES), ids=str)
def test_what_is_launched_or_called_exists(command):
    words = command.text.split()[2:]
    if words == ["launch"]:
        return
    if words[0] == "launch":
        package = next(path.parent for path in (ROOT / "ros").rglob("package.xml")
                       if f"<name>{words[1]}</name>" in path.read_text())
        files = list((package / "launch").glob(f"{words[2].split('.')[0]}.launch.*"))
        assert files, f"{command}: no such launch file"
        arguments = "".join(path.read_text() for path in (package / "launch").iterdir() if path.is_file())
        for name in re.findall(r"(\w+):=", command.text):
            assert re.search(rf"['\"]{name}['\"]", arguments), f"{command}: no argument {name}"
        tests = "".join(path.read_text() for path in (ROOT / "ros").rglob("test_*.py"))
        tests += "".join(path.read_text() for path in (ROOT / "test_support").rglob("*.py"))
        stem = words[2].split(".")[0]
        assert stem in tests, f"{command}: no test launches it"
    elif words[0] == "call":
        sources = "".join(path.read_text() for path in (ROOT / "ros").rglob("*.cpp"))
        assert f'"{words[1]}"' in sources or f'"~/{words[1]}"' in sources, f"{command}: no such service"
    else:
        assert words[0] == "test", command
        for name in words[1:]:
            assert (ROOT / name).exists() or list((ROOT / "ros").glob(name)) or list((ROOT / "ros_standin").glob(name))


def test_targets_and_tests_that_are_built_exist(root):
    for command in BUILDS:
        target = re.match(r"tools/ready.sh build (release|sanitizers) (.*)", command.text)
        if command.text.startswith("cmake"):
            assert command.text == "cmake --preset release", f"{command}: configures build/release in another way"
        elif target and target[1] == "sanitizers":
            assert target[2] in fuzzers(), command
        elif target or command.text.startswith("ninja"):
            done = run(f"ninja -C build/release -n {target[2]}" if target else f"{command.text} -n", root)
            assert done.returncode == 0, f"{command}\n{done.stdout[-500:]}{done.stderr[-500:]}"
        elif command.text.startswith("ctest"):
            listed = re.search(r"Total Tests: (\d+)", run(f"{command.text} -N", root).stdout)
            assert listed and int(listed[1]) > 0, f"{command}: no test"
        else:
            assert run(f"ninja -C build/release -n {command.text.removeprefix('build/release/')}", root).returncode == 0


def squeezed(text: str) -> str:
    return re.sub(r"\s+", "", re.sub(r"//.*|(?<!['\"])#.*", "", text))


def blocks(language: str) -> list[tuple[str, str]]:
    return [(str(path), block) for path in documents()
            for block in re.findall(rf"^```{language}\n(.*?)^```", (ROOT / path).read_text(), re.M | re.S)]


@pytest.mark.parametrize("language, suffixes", [("cpp", (".cpp", ".hpp")), ("python", (".py",))])
def test_blocks_of_code_are_found_in_the_sources(language, suffixes):
    """Statement by statement, so that a document may leave some out."""
    sources = squeezed("\n".join((ROOT / path).read_text() for path in own_files() if path.suffix in suffixes))
    missing = [f"{path}: {line.strip()}" for path, block in blocks(language) for line in block.splitlines()
               if squeezed(line) not in sources]
    assert not missing, "\n".join(missing)
