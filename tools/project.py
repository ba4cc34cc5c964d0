# SPDX-License-Identifier: BSD-3-Clause
"""What every tool needs to know of the project: where it is, which files are ours, how to build."""

import contextlib
import os
import signal
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NOT_OURS = {"build", "flights"}


def own_files(root: Path = ROOT) -> list[Path]:
    """Every file that is committed or about to be, relative to root, sorted."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=root, capture_output=True, text=True)
    if listed.returncode == 0:
        files = {Path(name) for name in listed.stdout.split("\0") if name}
    else:  # a source archive without git
        files = {path.relative_to(root) for path in root.rglob("*") if path.is_file()}
    return sorted(path for path in files if _is_ours(path) and (root / path).is_file())


def _is_ours(path: Path) -> bool:
    folders = path.parts[:-1]
    return not (NOT_OURS & set(folders[:1]) or {"__pycache__", "node_modules"} & set(folders)
                or any(part.startswith(".") and part != ".ci" for part in folders))


def jobs() -> int:
    return int(os.environ.get("ROSFLIGHT_JOBS") or os.cpu_count() or 1)


def build(preset: str, *targets: str, keep_going: bool = False) -> bool:
    """Configures and builds; progress and errors go to stderr, all output to build/PRESET/build.log."""
    environment = dict(os.environ)
    if keep_going:
        environment["ROSFLIGHT_KEEP_GOING"] = "1"
    command = ["bash", str(ROOT / "tools/ready.sh"), "build", preset, *targets]
    return subprocess.run(command, env=environment, stdout=subprocess.DEVNULL).returncode == 0


def descendants(of: int) -> list[int]:
    """Processes that a process has started, and theirs."""
    children: dict[int, list[int]] = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(stat.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue  # it has ended meanwhile
        children.setdefault(parent, []).append(int(stat.parent.name))
    found, ahead = [], [of]
    while ahead:
        mine = children.get(ahead.pop(), [])
        found += mine
        ahead += mine
    return found


def end_children_with_us():
    """A signal that ends this process ends what it has started too."""
    def end(number, _frame):
        for child in descendants(os.getpid()):
            with contextlib.suppress(ProcessLookupError):
                os.kill(child, signal.SIGTERM)
        os._exit(128 + number)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup
            signal.signal(number, end)


def is_up_to_date(preset: str, target: str) -> bool:
    """True when a build of the target would do nothing: it can be run as what the sources say."""
    dry = subprocess.run(["ninja", "-C", str(ROOT / "build" / preset), "-n", target],
                         capture_output=True, text=True)
    return dry.returncode == 0 and "no work to do" in dry.stdout
