# SPDX-License-Identifier: BSD-3-Clause
"""What rclcpp does not compile, rclcpp_lite does not compile either, at the call that a node makes."""

import json
import shlex
import subprocess
from pathlib import Path

import pytest
from ros_peer import executable

NODE = """#include <chrono>
#include <rclcpp/rclcpp.hpp>
#include <rcl_interfaces/msg/log.hpp>
#include <rcl_interfaces/srv/get_parameters.hpp>
using Log = rcl_interfaces::msg::Log;
using Get = rcl_interfaces::srv::GetParameters;
void make(rclcpp::Node& node) {
  int count = 0;
  static_cast<void>(count);
%s
}
"""
GOOD = {"timer": "node.create_wall_timer(std::chrono::seconds(1), [count] { static_cast<void>(count); });",
        "subscription": 'node.create_subscription<Log>("a", 1, [count](Log::ConstSharedPtr) { static_cast<void>(count); });',
        "service": 'node.create_service<Get>("b", [count](Get::Request::SharedPtr, Get::Response::SharedPtr) { static_cast<void>(count); });',
        "client": 'node.create_client<Get>("b")->async_send_request(std::make_shared<Get::Request>(),'
                  " [count](rclcpp::Client<Get>::SharedFuture) { static_cast<void>(count); });"}
# The word `mutable`, which rclcpp's traits do not know, and what they say here.
REFUSED = {"timer": (GOOD["timer"].replace("[count] {", "[count]() mutable { ++count;"), "no mutable lambda"),
           "subscription": (GOOD["subscription"].replace(") {", ") mutable { ++count;"), "rclcpp takes messages as"),
           "service": (GOOD["service"].replace(") {", ") mutable { ++count;"), "no mutable lambda")}


def compiled(body, folder):
    """The compiler's exit code and words, with the options of the stand-in's own tests."""
    place = Path(executable("rclcpp", "rclcpp_lite_api_test")).parents[3]
    entries = json.loads((place / "build/rclcpp/compile_commands.json").read_text())
    entry = next(entry for entry in entries if "api_test" in entry["command"])  # a quick build compiles several files as one
    source = folder / "node.cpp"
    source.write_text(NODE % body)
    command = shlex.split(entry["command"].replace(entry["file"], str(source)))
    command[command.index("-o") + 1] = "/dev/null"
    done = subprocess.run([*command, "-fsyntax-only"], cwd=entry["directory"], capture_output=True, text=True)
    return done.returncode, done.stderr


def test_const_callbacks_compile(tmp_path):
    code, said = compiled("\n".join(GOOD.values()), tmp_path)
    assert code == 0, said


@pytest.mark.parametrize("kind", REFUSED)
def test_a_mutable_lambda_does_not(kind, tmp_path):
    body, why = REFUSED[kind]
    code, said = compiled(body, tmp_path)
    assert code != 0 and "static assertion failed" in said and why in said, said
