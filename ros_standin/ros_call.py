# SPDX-License-Identifier: BSD-3-Clause
"""Usage: ./rosflight ros call SERVICE [FIELD:=VALUE...]

Calls a service of a running node once and prints the answer; the type is that of the service.

  ./rosflight ros call toggle_arm
  ./rosflight ros call param_set name:=PID_ROLL_RATE_P value:=0.08

Exit code 1: the service refused (`success` or `exists` is false in its answer), or did not answer within
30 s; 2: a wrong argument. Arguments of ROS follow after --ros-args.
"""

import importlib
import os
import sys
import time

import rclpy
import yaml

TIMEOUT_S = 30.0
APPEARS_S = 10.0


class Wrong(ValueError):
    pass


def type_of(node, service: str):
    """The class of a service, by its name in the graph."""
    end = time.monotonic() + APPEARS_S
    while time.monotonic() < end:
        known = dict(node.get_service_names_and_types())
        if service in known:
            package, _, name = known[service][0].split("/")
            return getattr(importlib.import_module(f"{package}.srv"), name)
        time.sleep(0.1)
    ours = sorted(name for name in known if "parameter" not in name and "type_description" not in name)
    raise Wrong(f"found no service {service}, allowed: {', '.join(ours) or 'none, because no node runs'}")


def converted(text: str, default):
    """The text as a value of the default's type; any list will do for sequences and arrays."""
    if isinstance(default, str):
        return text
    value = yaml.safe_load(text)
    if isinstance(default, float) and type(value) is int:
        value = float(value)
    if type(value) is not (type(default) if isinstance(default, (bool, int, float)) else list):
        raise TypeError
    return value


def fill(request, words: list[str]):
    fields = request.get_fields_and_field_types()
    for word in words:
        name, separator, text = word.partition(":=")
        if not separator or name not in fields:
            allowed = ", ".join(f"{field} ({kind})" for field, kind in fields.items()) or "no field"
            raise Wrong(f"found '{word}', allowed FIELD:=VALUE with {allowed}")
        try:
            setattr(request, name, converted(text, getattr(request, name)))
        except (AssertionError, TypeError, ValueError, yaml.YAMLError):
            raise Wrong(f"{name}: found '{text}', allowed {fields[name]}") from None
    return request


def for_the_answer():
    """Standard output, for the answer alone: what libraries of DDS print there goes to standard error."""
    answer = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return answer


def call(node, service: str, words: list[str], out) -> int:
    name = node.resolve_service_name(service)
    kind = type_of(node, name)
    client = node.create_client(kind, name)
    request = fill(kind.Request(), words)
    future = client.call_async(request) if client.wait_for_service(APPEARS_S) else None
    if future is not None:
        rclpy.spin_until_future_complete(node, future, timeout_sec=TIMEOUT_S)
    if future is None or not future.done():
        print(f"rosflight: {name} did not answer within {TIMEOUT_S:g} s", file=sys.stderr)
        return 1
    answer = future.result()
    for field in answer.get_fields_and_field_types():
        print(f"{field}: {getattr(answer, field)}", file=out)
    return 1 if refused(answer) else 0


def refused(answer) -> bool:
    """False in one of these fields: a service of the project says no."""
    return any(getattr(answer, field, True) is False for field in ("success", "exists"))


def main(arguments: list[str]) -> int:
    # Not rclpy's remove_ros_args: name:=value is a remapping for it, in front of --ros-args too.
    at = arguments.index("--ros-args") if "--ros-args" in arguments else len(arguments)
    words, ros_arguments = arguments[1:at], arguments[at:]
    if not words or words[0] in ("-h", "--help"):
        print(__doc__)
        return 0 if words else 2
    out = for_the_answer()
    rclpy.init(args=ros_arguments)
    try:
        return call(rclpy.create_node("rosflight_call"), words[0], words[1:], out)
    except Wrong as why:
        print(f"rosflight: {why}", file=sys.stderr)
        return 2
    finally:
        out.close()
        rclpy.try_shutdown()


if __name__ == "__main__":
    sys.exit(main(sys.argv))
