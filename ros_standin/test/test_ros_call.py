# SPDX-License-Identifier: BSD-3-Clause
"""What stands on standard output when a library prints there. No ROS."""

import os
import subprocess
import sys
from pathlib import Path

CALL = Path(__file__).resolve().parents[1] / "ros_call.py"
LIBRARY = """
import os

class Future:
    def done(self): return True
    def result(self): return Answer()

class Answer:
    success = True
    def get_fields_and_field_types(self): return {"success": "boolean"}

class Client:
    def wait_for_service(self, limit_s): return True
    def call_async(self, request): return Future()

class create_node:
    def __init__(self, name): pass
    def resolve_service_name(self, name): return "/" + name
    def get_service_names_and_types(self): return [("/arm", ["ours/srv/Arm"])]
    def create_client(self, kind, name): return Client()

def init(args):
    os.write(1, b"[RTPS_TRANSPORT_SHM Error] Failed init_port fastrtps_port7000\\n")

def spin_until_future_complete(node, future, timeout_sec): pass
def try_shutdown(): pass
"""


def test_what_a_library_prints_is_no_answer(tmp_path):
    (tmp_path / "rclpy.py").write_text(LIBRARY)
    (tmp_path / "ours").mkdir()
    (tmp_path / "ours/srv.py").write_text("class Arm:\n    class Request:\n        def get_fields_and_field_types(self): return {}\n")
    said = subprocess.run([sys.executable, CALL, "arm"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert (said.returncode, said.stdout) == (0, "success: True\n"), said.stderr
    assert "RTPS_TRANSPORT_SHM" in said.stderr
