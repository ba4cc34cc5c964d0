# SPDX-License-Identifier: BSD-3-Clause
import pytest


@pytest.fixture(scope="module")
def rig(tmp_path_factory):
    from ros_rig import Rig
    rig = Rig(tmp_path_factory.mktemp("io"))
    yield rig
    rig.close()
