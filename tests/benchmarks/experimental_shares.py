"""How tolerable errors grow with a smaller share α of the stiffness in the laboratory, on real motions.

``python tests/benchmarks/experimental_shares.py RECORDS OUT`` traces the boundaries of every fifth motion
of a folder at 5 % RMS^R and writes `growth.csv` (a and b over those of α = 1, beside the law of
`reliab.criterion.experimental_share`, and the error at α of tests on the ellipses of α = 1) and `stiff.csv`
(in closed form for small errors: motions under which a smaller share tolerates less). Ten minutes.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from reliab.core.vocabulary import Metric, Side
from reliab.motions.loading import load_motions
from reliab.motions.suite import MotionSuite
from reliab.simulation.engine import Loop
from reliab.simulation.linear_loop.cells import Cells
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_table import EllipseRequest, predict_ellipses, trace_ellipses
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.curves import Ellipse
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window

SHARES = (0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0)
FREQUENCIES, DAMPING_RATIOS = (0.5, 1.0, 2.0, 3.0), (0.01, 0.02, 0.05, 0.1)
STIFF, STIFF_DAMPING_RATIOS = (3.0, 5.0, 8.0, 10.0, 15.0, 20.0), (0.02, 0.05, 0.1, 0.2)
THRESHOLD, POINTS = 0.05, 13
QUANTILE = 1.645  # of the normal distribution, for the limit that 95 % of lognormal motions keep


def errors_on_ellipses(motions: MotionSuite, ellipses: xr.Dataset) -> xr.DataArray:
    """Largest error over the threshold of tests on the inscribed ellipse of α = 1, for every share."""
    ellipse = ellipses.sel(alpha=1.0, curve="inscribed").squeeze(["threshold", "metric"])
    empty = xr.full_like(
        ellipses["a"].sel(curve="inscribed").squeeze(["threshold", "metric"], drop=True), np.nan
    )
    angles = np.linspace(0.0, np.pi, POINTS)
    for motion in motions:
        excitation = excitation_of(motion, Window())
        for f in FREQUENCIES:
            for xi in DAMPING_RATIOS:
                for side in Side:
                    place = {"motion": motion.name, "f": f, "xi": xi, "side": str(side)}
                    a, b = (float(ellipse[name].sel(place)) for name in ("a", "b"))
                    gain = 1.0 + np.sqrt(a) * np.cos(angles)
                    delay = 1e-3 * side.sign * np.sqrt(b) * np.sin(angles)
                    for share in SHARES:
                        structure = Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
                        loop = Loop(excitation=excitation, structure=structure)
                        deviation = loop.deviation(Cells(structure=structure, gain=gain, delay=delay))
                        worst = float(relative_error(deviation, Metric.RMS).max())
                        empty.loc[place | {"alpha": share}] = worst / THRESHOLD
    return empty


def growth_table(ellipses: xr.Dataset, errors: xr.DataArray) -> pd.DataFrame:
    """One row for each damping ratio and share, over motions and frequencies."""
    logarithms = np.log(
        ellipses[["a", "b"]].sel(curve="ellipse", side="lag").squeeze(["threshold", "metric"])
    )
    limits = np.exp(logarithms.mean("motion") - QUANTILE * logarithms.std("motion"))
    limits = limits / limits.sel(alpha=1.0)
    ratios = (ellipses[["a", "b"]] / ellipses[["a", "b"]].sel(alpha=1.0)).squeeze(["threshold", "metric"])
    rows = []
    for xi in DAMPING_RATIOS:
        for share in SHARES[:-1]:
            strength = 1.0 / (8.0 * xi**2)
            law = (1.0 + strength) / (1.0 + strength * share**2)
            row = {"xi": xi, "alpha": share, "law": round(law, 3)}
            here = ratios.sel(xi=xi, alpha=share)
            for name in ("a", "b"):
                growth = here[name].sel(curve="ellipse", side="lag").values / law
                low, middle, high = np.nanquantile(growth, (0.05, 0.5, 0.95))
                row |= {f"{name}_05": low, f"{name}_50": middle, f"{name}_95": high}
                limit_growth = limits[name].sel(xi=xi, alpha=share).values / law
                row |= {f"{name}_limit_least": limit_growth.min(), f"{name}_limit_most": limit_growth.max()}
                row |= {f"{name}_least": float(here[name].min())}
            for side in Side:
                row[f"error_{side}"] = float(errors.sel(xi=xi, alpha=share, side=str(side)).max())
            rows.append(row)
    return pd.DataFrame(rows).round(3)


def stiff_table(motions: MotionSuite) -> pd.DataFrame:
    """Motions under which some smaller share tolerates less, to first order."""
    shares = (0.05, 0.2, 0.5, 0.8, 1.0)
    ellipses = (
        predict_ellipses(
            motions,
            EllipseRequest(
                frequencies=STIFF,
                damping_ratios=STIFF_DAMPING_RATIOS,
                experimental_fractions=shares,
                curves=(Ellipse,),
            ),
        )
        .sel(side="lag")
        .squeeze(["threshold", "metric", "curve"])
    )
    rows = []
    for f in STIFF:
        for xi in STIFF_DAMPING_RATIOS:
            row = {"f": f, "xi": xi, "n_motions": len(motions)}
            for name in ("a", "b"):
                here = ellipses[name].sel(f=f, xi=xi)
                ratio = (here / here.sel(alpha=1.0)).min("alpha")
                row |= {f"{name}_less": int((ratio < 1.0 - 1e-9).sum()), f"{name}_least": float(ratio.min())}
            rows.append(row)
    return pd.DataFrame(rows).round(3)


def main(records: str, out: str) -> None:
    motions = load_motions(records)[::5]
    folder = Path(out)
    stiff_table(motions).to_csv(folder / "stiff.csv", index=False)
    request = EllipseRequest(
        frequencies=FREQUENCIES, damping_ratios=DAMPING_RATIOS, experimental_fractions=SHARES
    )
    ellipses = trace_ellipses(motions, request)
    growth_table(ellipses, errors_on_ellipses(motions, ellipses)).to_csv(folder / "growth.csv", index=False)
    print(f"{len(motions)} motions of {len(set(motions.events))} earthquakes")


if __name__ == "__main__":
    main(*sys.argv[1:])
