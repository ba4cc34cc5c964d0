# SPDX-License-Identifier: BSD-3-Clause
from ros_session import ros  # noqa: F401
