# SPDX-License-Identifier: BSD-3-Clause
"""The watch on the graph of ROS, with a library that prints. No ROS."""

import time

from ros_launch.ready import GraphWatch

LIBRARY = """
import os

def init():
    os.write(1, b"\\x1b[37;1m[\\x1b[31;1mRTPS_TRANSPORT_SHM\\x1b[31;1m Error] Failed init_port fastrtps_port7000\\n")

class create_node:
    def __init__(self, *names, **options): pass
    def get_node_names_and_namespaces(self):
        print("not a name")
        return [("talker", "/"), ("listener", "/one")]
"""


def test_what_a_library_prints_is_no_name(tmp_path, monkeypatch):
    (tmp_path / "rclpy.py").write_text(LIBRARY)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    watch, seen = GraphWatch(), set()
    latest = time.monotonic() + 30
    while not seen and time.monotonic() < latest:
        seen = watch.seen()
        time.sleep(0.01)
    watch.stop()
    assert seen == {"/talker", "/one/listener"}
