# SPDX-License-Identifier: BSD-3-Clause
"""Gazebo with a world of ours: its server where it is installed, and the stand-in for it (ros/rosflight_sim/gazebo)."""

import os
import signal
import subprocess

import pytest
from ros_rig import PREFIXES
from sim_rig import VEHICLE, Process, executable

PLUGINS = "gazebo_stand_in_plugins"


def stand_in():
    """The program; skips the test where it was not built."""
    try:
        return executable("rosflight_sim", "gazebo_stand_in")
    except StopIteration:
        pytest.skip("gazebo_stand_in is not built: Gazebo's libraries are not installed (tools/ready.sh packages gazebo)")


def on_stand_in():
    """The variables with which the launch files start the stand-in."""
    program = stand_in()
    return {"ROSFLIGHT_GAZEBO": str(program), "ROSFLIGHT_GAZEBO_PLUGINS": str(program.parent / PLUGINS)}


def fortress():
    """The variables with which they start the server of Gazebo Fortress. Skips the test where it is not installed."""
    place = next((prefix / "lib/rosflight_sim" for prefix in PREFIXES if (prefix / "lib/rosflight_sim/gazebo_server").exists()), None)
    if place is None:
        pytest.skip("Gazebo Fortress is not installed (libignition-gazebo-dev, Ubuntu 22.04): no real server was run")
    return {"ROSFLIGHT_GAZEBO": str(place / "gazebo_server"), "ROSFLIGHT_GAZEBO_PLUGINS": str(place / "gazebo")}


SERVERS = pytest.mark.parametrize("server", [pytest.param(on_stand_in, id="stand_in"), pytest.param(fortress, id="fortress")])


def world(path, *elements, vehicle=VEHICLE):
    """Writes a world as the launch files do, with NAME=VALUE elements of the plugin."""
    made = subprocess.run([executable("rosflight_sim", "gazebo_world"), "fortress", f"vehicle={vehicle}", *elements],
                          capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stderr
    path.write_text(made.stdout)
    return path


class Server(Process):
    """The stand-in with a world file."""

    def __init__(self, file):
        program = stand_in()
        super().__init__(program, file, env={**os.environ, "IGN_GAZEBO_SYSTEM_PLUGIN_PATH": str(program.parent / PLUGINS)})

    def toggle_pause(self):
        """As a person does in Gazebo's window."""
        self.process.send_signal(signal.SIGUSR1)
