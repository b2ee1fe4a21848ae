"""Whether the published criteria keep their promise: which motions' ellipses contain them."""

import pandas as pd

from reliab.criterion.laws import OF_MANY_MOTIONS

from .printed import TWO_PERCENT
from .records import Records

LAWS = ("guo_2017_15", "guo_2017_18", "guo_2017_15_corrected", "guo_2017_18_corrected")


def containment(records: Records) -> pd.DataFrame:
    """Share of the motions whose own fitted ellipse contains a published criterion, at ξ = 0.02.

    Columns f [Hz] and one for each law, shares [-].
    """
    rows = []
    for f in records.frequencies.tolist():
        sample = records.sample(f)
        row = {"f": f}
        for name in LAWS:
            a, b = (float(limit) for limit in OF_MANY_MOTIONS[name].limits(f, TWO_PERCENT))
            row[name] = float(((sample.a >= a) & (sample.b >= b)).mean())
        rows.append(row)
    return pd.DataFrame(rows)
