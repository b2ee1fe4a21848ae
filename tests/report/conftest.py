"""Small results from which reports are made."""

import numpy as np
import pandas as pd
import pytest


@pytest.fixture(scope="session")
def rates():
    """Rates of two criteria at three confidences, over all structures and at two frequencies."""
    rows = [
        {
            "measure": measure,
            "candidate": name,
            "confidence": confidence,
            "f": f,
            "rate": rate,
            "low": max(rate - 0.05, 0.0),
            "high": min(rate + 0.04, 1.0),
        }
        for measure, factor in (("containment", 1.0), ("false_safe", 0.02), ("accepted_share", 0.5))
        for name in ("ours", "printed #1")
        for confidence in (0.8, 0.9, 0.95)
        for f in (np.nan, 0.5, 1.0)
        for rate in (factor * confidence,)
    ]
    return pd.DataFrame(rows)
