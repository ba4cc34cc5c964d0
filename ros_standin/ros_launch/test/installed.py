# SPDX-License-Identifier: BSD-3-Clause
"""A folder that looks like an installed workspace: packages whose nodes are small scripts."""

import sys
from pathlib import Path


class Installed:
    def __init__(self, prefix: Path):
        self.prefix = prefix

    def package(self, name: str, **scripts: str) -> Path:
        """Adds a package with one executable a script; returns its share folder."""
        index = self.prefix / "share/ament_index/resource_index/packages"
        index.mkdir(parents=True, exist_ok=True)
        (index / name).touch()
        share = self.prefix / "share" / name
        (share / "launch").mkdir(parents=True, exist_ok=True)
        programs = self.prefix / "lib" / name
        programs.mkdir(parents=True, exist_ok=True)
        for script, text in scripts.items():
            file = programs / script
            file.write_text(f"#!{sys.executable}\n{text}")
            file.chmod(0o755)
        return share

    def launch_file(self, text: str, name: str = "it.launch.xml") -> Path:
        file = self.prefix / name
        file.write_text(text)
        return file
