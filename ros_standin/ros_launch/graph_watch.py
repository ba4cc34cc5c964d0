# SPDX-License-Identifier: BSD-3-Clause
"""Prints the full names of all nodes of the ROS graph, as a JSON list a line, whenever they change."""

import json
import time

import rclpy


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("_launch_graph_watch", start_parameter_services=False,
                             enable_rosout=False)
    before: list[str] = []
    while True:
        names = sorted(namespace.rstrip("/") + "/" + name
                       for name, namespace in node.get_node_names_and_namespaces())
        if names != before:
            print(json.dumps(names), flush=True)
            before = names
        time.sleep(0.1)


if __name__ == "__main__":
    main()
