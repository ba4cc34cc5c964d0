# SPDX-License-Identifier: BSD-3-Clause
import pytest


@pytest.fixture
def peer():
    from sim_rig import SimPeer
    with SimPeer() as peer:
        yield peer
