"""Small results from which reports are made."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr


@pytest.fixture(scope="session")
def ellipses_of():
    """Function that makes ellipses of motions of several earthquakes over a grid of structures."""

    def make(frequencies=(0.5, 1.0, 2.0), damping_ratios=(0.02, 0.05), motions=24, events=8, names=None):
        rng = np.random.default_rng(1)
        event = np.arange(motions) % events
        scatter = 0.3 * rng.normal(size=events)[event] + 0.5 * rng.normal(size=motions)
        f, xi = np.array(frequencies), np.array(damping_ratios)
        thresholds = np.array([0.02, 0.05])
        shape = (motions, f.size, xi.size, thresholds.size, 1, 1, 1)
        size = (
            np.exp(scatter).reshape(-1, 1, 1, 1, 1, 1, 1)
            * (thresholds / 0.05).reshape(1, 1, 1, -1, 1, 1, 1) ** 2
        )
        noise = np.exp(0.1 * rng.normal(size=(2, *shape)))
        of_xi = (xi / 0.02).reshape(1, 1, -1, 1, 1, 1, 1) ** 2
        a = 1.5e-4 * size * of_xi * noise[0]
        b = 2.5 * size * of_xi / f.reshape(1, -1, 1, 1, 1, 1, 1) ** 2 * noise[1]
        dimensions = ("motion", "f", "xi", "threshold", "metric", "curve", "side")
        names = [f"E{each}/M{rank}" for rank, each in enumerate(event)] if names is None else names
        return xr.Dataset(
            {"a": (dimensions, np.broadcast_to(a, shape)), "b": (dimensions, np.broadcast_to(b, shape))},
            coords={
                "motion": np.array(names),
                "event": ("motion", np.array([f"E{each}" for each in event])),
                "duration": ("motion", np.full(motions, 40.0)),
                "f": f,
                "xi": xi,
                "threshold": thresholds,
                "metric": ["rms"],
                "curve": ["ellipse"],
                "side": ["lag"],
            },
            attrs={"window": "record", "experimental_fraction": 1.0},
        )

    return make


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
