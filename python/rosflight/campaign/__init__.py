# SPDX-License-Identifier: BSD-3-Clause
"""Thousands of flights from one file, with a verdict (docs/campaigns.md). Needs pip install '.[campaign]'.

    from rosflight import campaign
    rows = campaign.fly("campaign.yaml", "out")
    print(rows.passed, len(rows), rows["tracking_rms_m"].max())
"""

from ._campaign import Campaign, fly, read
from ._compare import Comparison, compare
from ._report import report
from ._statistics import clopper_pearson
from ._yaml import CampaignError

__all__ = ["Campaign", "CampaignError", "Comparison", "clopper_pearson", "compare", "fly", "read", "report"]
