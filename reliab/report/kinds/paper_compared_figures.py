"""Numbers of the paper's figures beside what was found."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from reliab.criterion.distributions import Lognormal
from reliab.criterion.laws import OF_MANY_MOTIONS
from reliab.report.kinds.comparison import Comparison
from reliab.report.kinds.paper_fits import SHARE, PaperFits
from reliab.report.printed import PrintedTables

_PERCENT, _MILLI = 100.0, 1e3
_E4, _E5 = 1e4, 1e5


def compare_figures(fits: PaperFits, cases: xr.Dataset, printed: PrintedTables) -> Iterator[Comparison]:
    """Compare what the paper says of its figures."""
    yield Comparison(item="Figure 1", quantity="block diagram", remark="drawn; the loop of equation (6)")
    yield from _figures_of_histories(fits.example)
    yield from _figures_of_errors(fits)
    yield from _figures_of_motions(fits, printed)
    yield from _figures_over_structure(fits)
    yield Comparison(item="Figure 16", quantity="frame with spring", remark="drawn")
    for case in cases["case"].values.tolist():
        peaks = [float(abs(cases[name].sel(case=case)).max()) for name in ("ideal", "measured")]
        yield Comparison(
            item="Figure 17",
            quantity=f"case {case}: measured over exact peak",
            unit="-",
            reproduced=peaks[1] / peaks[0],
            remark="drawn",
        )


def _figures_of_histories(example: xr.Dataset) -> Iterator[Comparison]:
    moved = _MILLI * abs(example["displacement"])
    strong, late = moved.sel(time=slice(14.0, 30.0)), moved.sel(time=slice(39.0, 41.0))
    errors = example["error_of_gain"].sel(gain=0.99, method="nearest")
    yield Comparison(
        item="Figure 2",
        quantity="displacement, 14 to 30 s",
        unit="mm",
        printed=50.0,
        reproduced=float(strong.isel(test=0).max()),
        remark="from the text",
    )
    yield Comparison(
        item="Figure 3",
        quantity="displacement at 40 s, delay 5 ms",
        unit="mm",
        printed=50.0,
        reproduced=float(late.isel(test=1).max()),
        remark="from the text",
    )
    yield Comparison(
        item="Figure 5",
        quantity="RMSᴿ at an amplitude of 0.99",
        unit="%",
        printed=4.2,
        reproduced=_PERCENT * float(errors.sel(metric="rms")),
        remark="“almost exactly the same”",
    )
    yield Comparison(
        item="Figure 7",
        quantity="peak over that of Figure 2",
        unit="-",
        printed=1.1,
        reproduced=float(moved.isel(test=3).max() / moved.isel(test=0).max()),
        remark="from the text",
    )


def _figures_of_errors(fits: PaperFits) -> Iterator[Comparison]:
    example = fits.example
    critical = _MILLI * float(example.attrs["critical_delay"])
    yield Comparison(item="Figure 4", quantity="critical delay", unit="ms", printed=6.4, reproduced=critical)
    at_limit = example["error_of_delay"].sel(long_delay=6.4e-3, method="nearest")
    below = example["error_of_gain"].sel(gain=0.99, method="nearest")
    for name, metric, unstable, accurate in (("MTEᴿ", "mte", 280.0, 9.2), ("RMSᴿ", "rms", 96.0, 4.2)):
        yield Comparison(
            item="Figure 4",
            quantity=f"{name} at 6.4 ms",
            unit="%",
            printed=unstable,
            reproduced=_PERCENT * float(at_limit.sel(metric=metric)),
            remark="the exact loop gives less",
        )
        yield Comparison(
            item="Figure 6",
            quantity=f"{name} at an amplitude of 0.99",
            unit="%",
            printed=accurate,
            reproduced=_PERCENT * float(below.sel(metric=metric)),
        )
    yield Comparison(
        item="Figure 8",
        quantity="simulations",
        unit="-",
        printed=800.0,
        reproduced=float(example["error"].isel(metric=0).size),
        remark="41 amplitudes × 21 delays",
    )
    yield Comparison(
        item="Figure 9",
        quantity="delay at 5 %, MTEᴿ over RMSᴿ",
        unit="-",
        reproduced=float(example["delay_mte"].max() / example["delay_rms"].max()),
        remark="MTEᴿ is the more stringent",
    )
    yield Comparison(
        item="Figure 10",
        quantity="least fitting error",
        remark=f"{min(fits.curves, key=lambda curve: curve.sse).name}, as in the paper",
    )


def _figures_of_motions(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    sample, table = fits.sample, printed.motions
    remark = f"printed Table 2 gives {np.corrcoef(table['a'], table['b'])[0, 1]:.4f}"
    yield Comparison(
        item="Figure 11",
        quantity="correlation of a and b",
        unit="-",
        printed=0.9774,
        reproduced=sample.correlation,
        remark=remark,
    )
    yield Comparison(
        item="Figure 11",
        quantity="b over a, slope of the line",
        unit="10⁴ ms²",
        printed=1.65,
        reproduced=float(np.polyfit(sample.a, sample.b, 1)[0]) / _E4,
    )
    for name, value, unit, factor in (("a", 5.3, "10⁻⁵", _E5), ("b", 1.04, "ms²", 1.0)):
        as_printed = factor * float(Lognormal.fit(table[name]).quantile(SHARE))
        yield Comparison(
            item="Figure 12",
            quantity=f"5 % quantile of {name}",
            unit=unit,
            printed=value,
            reproduced=factor * float(Lognormal.fit(getattr(sample, name)).quantile(SHARE)),
            remark=f"printed Table 2 gives {as_printed:.3g}",
        )
    law = OF_MANY_MOTIONS["guo_2017_12"]
    a, b = law.limits(sample.frequency, sample.damping_ratio)
    contained = (sample.a >= a) & (sample.b >= b)
    yield Comparison(
        item="Figure 13",
        quantity="motions that contain (12)",
        unit="%",
        printed=95.0,
        reproduced=_PERCENT * float(contained.mean()),
    )


def _figures_over_structure(fits: PaperFits) -> Iterator[Comparison]:
    a, b = fits.of_example("a", "f"), fits.of_example("b", "f")
    yield Comparison(
        item="Figure 14", quantity="least a", unit="10⁻⁵", printed=5.8, reproduced=_E5 * float(a.min())
    )
    yield Comparison(
        item="Figure 14", quantity="greatest a", unit="10⁻⁴", printed=7.0, reproduced=_E4 * float(a.max())
    )
    yield Comparison(
        item="Figure 14", quantity="greatest b", unit="ms²", printed=40.4, reproduced=float(b.max())
    )
    yield Comparison(item="Figure 14", quantity="least b", unit="ms²", printed=0.8, reproduced=float(b.min()))
    yield Comparison(
        item="Figure 15",
        quantity="5 % quantile of a, pooled",
        unit="10⁻⁵",
        printed=5.6,
        reproduced=_E5 * fits.pooled_a,
    )
