# SPDX-License-Identifier: BSD-3-Clause
"""Packages that are installed: the ament index, read without any library of ROS."""

import os
from pathlib import Path

from .errors import LaunchError, near, one_of

INDEX = Path("share/ament_index/resource_index/packages")


class Packages:
    """The packages below the folders of AMENT_PREFIX_PATH; the first folder that has one wins."""

    def __init__(self, prefixes: list[Path]):
        self._prefix_of: dict[str, Path] = {}
        for prefix in prefixes:
            index = prefix / INDEX
            for marker in sorted(index.iterdir()) if index.is_dir() else []:
                self._prefix_of.setdefault(marker.name, prefix)

    @classmethod
    def of_environment(cls, environment=os.environ) -> "Packages":
        path = environment.get("AMENT_PREFIX_PATH", "")
        return cls([Path(folder) for folder in path.split(os.pathsep) if folder])

    def has(self, package: str) -> bool:
        return package in self._prefix_of

    def prefix(self, package: str) -> Path:
        if package not in self._prefix_of:
            raise LaunchError(f"package: found {package!r}, allowed one of the "
                              f"{len(self._prefix_of)} packages of AMENT_PREFIX_PATH"
                              + near(package, self._prefix_of))
        return self._prefix_of[package]

    def share(self, package: str) -> Path:
        return self.prefix(package) / "share" / package

    def executable(self, package: str, name: str) -> Path:
        folder = self.prefix(package) / "lib" / package
        file = folder / name
        if "/" not in name and _is_executable(file):
            return file
        there = [path.name for path in folder.iterdir() if _is_executable(path)] \
            if folder.is_dir() else []
        raise LaunchError(f"exec: found {name!r}, allowed {one_of(there)} of package {package}")

    def launch_file(self, package: str, name: str) -> Path:
        """A launch file of a package by its name, with or without a folder."""
        share = self.share(package)
        for candidate in (share / "launch" / name, share / name):
            if candidate.is_file():
                return candidate
        there = [path.name for path in (share / "launch").glob("*.xml")]
        raise LaunchError(f"launch file of {package}: found {name!r}, allowed {one_of(there)}")


def _is_executable(file: Path) -> bool:
    return file.is_file() and os.access(file, os.X_OK)
