# SPDX-License-Identifier: BSD-3-Clause
"""Prints the full names of all nodes of the ROS graph, as a JSON list a line, whenever they change."""

import json
import os
import sys
import time

import rclpy


def main() -> None:
    names_only = os.fdopen(os.dup(1), "w")
    os.dup2(sys.stderr.fileno(), 1)  # libraries of DDS print their errors on standard output
    rclpy.init()
    node = rclpy.create_node("_launch_graph_watch", start_parameter_services=False,
                             enable_rosout=False)
    before: list[str] = []
    while True:
        names = sorted(namespace.rstrip("/") + "/" + name
                       for name, namespace in node.get_node_names_and_namespaces())
        if names != before:
            print(json.dumps(names), file=names_only, flush=True)
            before = names
        time.sleep(0.1)


if __name__ == "__main__":
    main()
