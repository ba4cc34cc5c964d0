# SPDX-License-Identifier: BSD-3-Clause
"""Generate C headers or a Python module from the dialect with pymavlink's own generator.

usage: generate.py (C | Python3) DIALECT.xml OUTPUT
"""

import contextlib
import io
import os
import sys

from pymavlink.generator import mavgen


def main() -> int:
    language, dialect, output = sys.argv[1:]
    parent = os.path.dirname(os.path.abspath(output))
    os.makedirs(parent, exist_ok=True)
    options = mavgen.Opts(output, wire_protocol="1.0", language=language)
    chatter = io.StringIO()
    with contextlib.redirect_stdout(chatter), contextlib.redirect_stderr(chatter):
        good = mavgen.mavgen(options, [dialect])
    if not good:
        sys.stderr.write(chatter.getvalue())
        sys.stderr.write(f"{dialect}: the MAVLink generator refused it\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
