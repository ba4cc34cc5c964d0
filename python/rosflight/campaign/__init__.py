# SPDX-License-Identifier: BSD-3-Clause
"""Thousands of flights from one file, with a verdict (docs/campaigns.md). Needs pip install '.[campaign]'.

    from rosflight import campaign
    rows = campaign.fly("campaign.yaml", "out")
    print(rows.passed, len(rows), rows["tracking_rms_m"].max())
"""

try:
    import pyarrow as _pyarrow
    import scipy as _scipy
    import yaml as _yaml_library
except ImportError as error:
    raise ImportError(f"rosflight.campaign: found no {error.name}, allowed with pip install '.[campaign]'") from None

from ._campaign import Campaign, fly, read
from ._compare import Comparison, compare
from ._report import report
from ._statistics import clopper_pearson
from ._yaml import CampaignError

__all__ = ["Campaign", "CampaignError", "Comparison", "clopper_pearson", "compare", "fly", "read", "report"]
