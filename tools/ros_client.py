# SPDX-License-Identifier: BSD-3-Clause
"""One request to a ROS service, for tests and demonstrations whose node spins in a thread of its own."""

import time


def ask(node, kind, service: str, fields: dict, limit_s: float, **options):
    """The response of a service to a request with these fields.

    rmw_fastrtps drops a response when the server has not discovered the reader of a new client within 100 ms; the
    server then logs a warning and the client receives nothing. So a request without a response is sent once more in
    the middle of the time; the second must be answered. Raises AssertionError otherwise.
    """
    client = node.create_client(kind, service, **options)
    try:
        assert client.wait_for_service(limit_s), f"after {limit_s:g} s no service {service}"
        start = time.monotonic()
        futures = [client.call_async(kind.Request(**fields))]
        while not any(future.done() for future in futures):
            waited_s = time.monotonic() - start
            assert waited_s < limit_s, f"after {limit_s:g} s still not: an answer of {service}"
            if len(futures) == 1 and waited_s > limit_s / 2:
                futures.append(client.call_async(kind.Request(**fields)))
            time.sleep(0.005)
        return next(future.result() for future in futures if future.done())
    finally:
        node.destroy_client(client)
