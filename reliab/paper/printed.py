"""The printed tables, and the ellipses of the records that belong beside them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Final, Self

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from reliab.errors import InputError

ONE_MOTION: Final = "KOBE/NIS000"
ONE_HERTZ, TWO_PERCENT, FIVE_PERCENT = 1.0, 0.02, 0.05
_FILES: Final = {
    "table2": "table2.csv",
    "table3": "table3.csv",
    "table4": "table4.csv",
    "cases": "tables5_6.csv",
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Printed:
    """The paper's tables as typed out.

    Parameters
    ----------
    table2, table3, table4, cases : pandas.DataFrame
        Tables 2, 3, 4, and 5 with 6.
    """

    table2: pd.DataFrame
    table3: pd.DataFrame
    table4: pd.DataFrame
    cases: pd.DataFrame

    @classmethod
    def read(cls, folder: Path) -> Self:
        """Read the CSV files of a folder.

        Parameters
        ----------
        folder : Path
            With `table2.csv`, `table3.csv`, `table4.csv` and `tables5_6.csv`.

        Returns
        -------
        Printed
            The tables.

        Raises
        ------
        InputError
            If a file is missing.
        """
        missing = [name for name in _FILES.values() if not (folder / name).is_file()]
        if missing:
            raise InputError(
                "The folder must hold the paper's printed tables",
                value=f"no {', '.join(missing)}",
                remedy="Use datasets/paper, which ships with reliab",
                where=str(folder),
            )
        return cls(**{key: pd.read_csv(folder / name) for key, name in _FILES.items()})

    def of_table_2(self, parameter: str) -> float:
        """Value of KOBE/NIS000 in Table 2."""
        rows = self.table2["record"].to_numpy() == ONE_MOTION
        return float(self.table2[parameter].to_numpy(dtype=np.float64)[rows][0])


@dataclass(frozen=True, kw_only=True, eq=False)
class Recomputed:
    """Ellipses of 5 % RMS^R from the records, or nothing; what is not there is NaN.

    Parameters
    ----------
    ellipses : xarray.Dataset or None
        `a` and `b` over (motion, f, xi) or more dimensions.
    """

    ellipses: xr.Dataset | None

    def over_motions(self, parameter: str, frequency: float) -> NDArray[np.float64]:
        """Values of all motions at 2 % damping, in the order of the dataset; empty where unknown."""
        return self._at(parameter, {"f": frequency, "xi": TWO_PERCENT})

    def of_motion(self, parameter: str, motion: str, frequency: float, damping_ratio: float) -> float:
        """Value of one motion and structure."""
        found = self._at(parameter, {"f": frequency, "xi": damping_ratio})
        if self.ellipses is None or found.size == 0:
            return float("nan")
        place = np.flatnonzero(self.ellipses["motion"].values.astype(np.str_) == motion)
        return float(found[place[0]]) if place.size else float("nan")

    def _at(self, parameter: str, structure: dict[str, float]) -> NDArray[np.float64]:
        if self.ellipses is None:
            return np.empty(0)
        chosen = self.ellipses[parameter]
        wanted = {**structure, "threshold": FIVE_PERCENT}
        for name, value in wanted.items():
            close = np.flatnonzero(np.isclose(chosen[name].values, value, rtol=1e-9))
            if close.size == 0:
                return np.empty(0)
            chosen = chosen.isel({name: close[0]})
        chosen = chosen.sel(metric="rms", curve="ellipse")
        return np.asarray(chosen.transpose("motion").values, dtype=np.float64)
