"""The paper's four cases as one labelled dataset, which can be stored."""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from reliab.paper.cases import CaseOutcome


def cases_dataset(outcomes: Sequence[CaseOutcome]) -> xr.Dataset:
    """Gather what became of the cases of Tables 5 and 6.

    Parameters
    ----------
    outcomes : sequence of CaseOutcome
        Under one ground motion.

    Returns
    -------
    xarray.Dataset
        Over `case` (1, 2, …): `f` [Hz], `xi`, `estimated_delay` [steps], `gain`, `mass` [kg], `A`, `d` [s]
        and `rms` [-]; over (case, time [s]): `ideal` and `measured` displacement [m].
    """
    cases = [outcome.case for outcome in outcomes]
    numbers = {
        "f": [case.frequency for case in cases],
        "xi": [case.damping_ratio for case in cases],
        "estimated_delay": [case.estimated_delay for case in cases],
        "gain": [case.amplitude for case in cases],
        "mass": [case.mass for case in cases],
        "A": [outcome.amplitude for outcome in outcomes],
        "d": [outcome.equivalent_delay for outcome in outcomes],
        "rms": [outcome.rms for outcome in outcomes],
    }
    histories = {
        "ideal": np.stack([outcome.ideal for outcome in outcomes]),
        "measured": np.stack([outcome.measured for outcome in outcomes]),
    }
    return xr.Dataset(
        {
            **{name: ("case", values) for name, values in numbers.items()},
            **{name: (("case", "time"), values) for name, values in histories.items()},
        },
        coords={"case": np.arange(1, len(cases) + 1), "time": outcomes[0].times},
    )
