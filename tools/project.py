# SPDX-License-Identifier: BSD-3-Clause
"""What every tool needs to know of the project: where it is, which files are ours, how to build."""

import os
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
    return not (NOT_OURS & set(folders[:1]) or "__pycache__" in folders
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


def is_up_to_date(preset: str, target: str) -> bool:
    """True when a build of the target would do nothing: it can be run as what the sources say."""
    dry = subprocess.run(["ninja", "-C", str(ROOT / "build" / preset), "-n", target],
                         capture_output=True, text=True)
    return dry.returncode == 0 and "no work to do" in dry.stdout
