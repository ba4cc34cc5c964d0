# SPDX-License-Identifier: BSD-3-Clause
"""The program `./rosflight fly` with a policy inside, beside the build: what ROSFLIGHT_POLICY makes, but only one file is compiled and
the program linked again, so that build/release stays as it is."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = ROOT / "build/release"
LIBRARY = "firmware/core/librosflight_policy.a"


def program_with(policy: Path, folder: Path) -> Path:
    """@param policy: an ONNX file. @param folder: for the program and what it is made from."""
    source, compiled, program = folder / "policy.cpp", folder / "policy.o", folder / "rosflight"
    subprocess.run([sys.executable, ROOT / "firmware/core/policy/generate.py", policy, source], check=True)
    subprocess.run(["c++", "-std=c++17", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fPIC", f"-I{ROOT}", "-isystem", "/usr/include/eigen3",
                    "-c", source, "-o", compiled], check=True)
    steps = subprocess.run(["ninja", "-C", BUILD, "-t", "commands", "-s", "apps/rosflight"], capture_output=True, text=True, check=True)
    link = steps.stdout.splitlines()[-1]
    assert link.count(f" {LIBRARY} ") >= 1 and link.count(" -o apps/rosflight ") == 1, link
    subprocess.run(["bash", "-c", link.replace(LIBRARY, str(compiled), 1).replace(f" {LIBRARY} ", " ")
                    .replace(" -o apps/rosflight ", f" -o {program} ")], cwd=BUILD, check=True)
    return program
