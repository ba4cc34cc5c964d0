# SPDX-License-Identifier: BSD-3-Clause
"""./rosflight completion, as bash calls it."""
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ASK = """
source <("$1" completion bash) || exit 3
shift
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_rosflight && printf '%s\\n' "${COMPREPLY[@]}"
"""


def bash(script, *words, cwd=ROOT):
    return subprocess.run(["bash", "-uc", script, "bash", *map(str, words)], capture_output=True, text=True, cwd=cwd)


def offered(*words, cwd=ROOT, command="./rosflight"):
    done = bash(ASK, ROOT / "rosflight", command, *words, cwd=cwd)
    assert (done.returncode, done.stderr) == (0, ""), done
    return set(done.stdout.split())


def names(folder):
    return {path.stem for path in (ROOT / folder).glob("*.yaml")}


def test_every_command_of_the_help_is_offered():
    said = subprocess.run([ROOT / "rosflight", "--help"], capture_output=True, text=True, check=True).stdout
    commands = {line.split()[0] for line in said.splitlines() if line.startswith("  ")}
    assert {"fly", "params", "completion", "ros"} <= commands
    assert offered("") == commands | {"--help", "--version"}
    assert offered("mo") == {"monitor"}


@pytest.mark.parametrize("command", ["fly", "sil", "replay", "params", "calibrate", "monitor", "preflight", "blackbox"])
def test_every_option_of_a_command_is_offered(command):
    text = (ROOT / f"apps/help/{command}.txt").read_text()
    options = {word.strip(",") for line in text.splitlines() if line.lstrip().startswith("-")
               for word in line.replace("-h,", "").split()[:1]}
    assert options and options <= offered(command, "--") | {"-o,--output"}


def test_vehicles_missions_and_choices_are_offered_after_their_option():
    assert offered("fly", "--vehicle", "") == names("vehicles") - {"mixer_frame_x650"}
    assert offered("sil", "--vehicle", "mu") == {"multirotor"}
    assert offered("fly", "--mission", "") == names("missions")
    assert offered("fly", "--log", "") == {"plot", "full", "none"}
    assert offered("sil", "--link-protocol", "l") == {"lean"}


def test_actions_links_and_files_are_offered(tmp_path):
    (tmp_path / "vehicle.yaml").touch()
    # bash divides words at colons
    assert offered("params", "tcp", ":", "127.0.0.1", ":", "5760", "") == {"list", "get", "set", "load", "save", "diff"}
    assert offered("params", "") == {"serial:", "udp:", "tcp:", "pty:"}
    assert offered("params", "/dev/ttyACM0", "load", "veh", cwd=tmp_path, command=ROOT / "rosflight") == {"vehicle.yaml"}
    assert offered("calibrate", "/dev/ttyACM0", "a") == {"accel", "airspeed"}
    assert offered("completion", "") == {"bash", "zsh"}


def test_bash_itself_completes_with_it():
    done = bash('source <("$1" completion bash); complete -p rosflight ./rosflight', ROOT / "rosflight")
    assert done.stdout.count("-F _rosflight") == 2


def test_zsh_gets_the_same_after_its_emulation_of_bash():
    printed = {shell: subprocess.run([ROOT / "rosflight", "completion", shell], capture_output=True, text=True,
                                     check=True).stdout for shell in ("bash", "zsh")}
    assert printed["zsh"].endswith(printed["bash"]) and "bashcompinit" in printed["zsh"].splitlines()[0]
    assert "@ROOT@" not in printed["bash"]


@pytest.mark.parametrize("words", [[], ["fish"]])
def test_another_shell_is_one_line(words):
    done = subprocess.run([ROOT / "rosflight", "completion", *words], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"rosflight: completion: found '{(words or ['nothing'])[0]}', allowed bash, zsh\n"
