"""Numbers of the paper's equations beside what was found."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from reliab.criterion.distributions import Lognormal
from reliab.report.kinds.comparison import NAN, Comparison
from reliab.report.kinds.paper_fits import SHARE, PaperFits, exponential, proportional
from reliab.report.printed import PrintedTables

_E4, _E5 = 1e4, 1e5


def compare_equations(fits: PaperFits, cases: xr.Dataset, printed: PrintedTables) -> Iterator[Comparison]:
    """Compare the numbered equations."""
    definitions = {
        "Equation (1)": "weights w",
        "Equation (2)": "FEI",
        "Equation (3a)": "amplitude A",
        "Equation (3b)": "phase φ",
        "Equation (4)": "equivalent frequency",
        "Equation (5)": "equivalent delay d",
    }
    error = float(abs(cases["A"] - cases["gain"]).max())
    for item, quantity in definitions.items():
        remark = f"used; within {error:.1g} of the gains of Table 5" if item == "Equation (3a)" else "used"
        yield Comparison(item=item, quantity=quantity, remark=remark)
    yield Comparison(item="Equation (6)", quantity="the loop", remark="used")
    for letter, curve in zip("abc", fits.curves, strict=True):
        yield Comparison(item=f"Equation (7{letter})", quantity=curve.name, remark="see Table 1")
    yield Comparison(item="Equation (8)", quantity="ellipse solved for d", remark="b′² should be b′")
    yield Comparison(item="Equation (9)", quantity="straight line of the fit", remark="used")
    yield Comparison(item="Equation (10)", quantity="fitting error", remark="see Table 1")
    yield from _fitted_equations(fits, printed)


def _fitted_equations(fits: PaperFits, printed: PrintedTables) -> Iterator[Comparison]:
    ellipse, (k1_example, k2_example), (k1, k2) = (
        fits.curves[0],
        fits.exponential_of_example,
        fits.exponential_guaranteed,
    )
    a_12, b_12 = (float(Lognormal.fit(values).quantile(SHARE)) for values in (fits.sample.a, fits.sample.b))
    table = printed.frequencies
    again = exponential(table["f_hz"].to_numpy(), table["b"].to_numpy())
    from_table = [f"printed Table 3 gives {value:.4g}" for value in again]
    at_2_hz = f"at 2 Hz {again[0] * np.exp(-2.0 * again[1]):.1g} ms² where Table 3 has 0.33"
    (k3, k4), (factor_a, factor_b) = fits.linear_in_damping, fits.combined
    damping = printed.damping_ratios
    k3_table = proportional(damping["xi"].to_numpy(), damping["a"].to_numpy())
    k4_table = proportional(damping["xi"].to_numpy(), damping["b"].to_numpy())
    quadratic = "a and b grow as ξ²"
    rows = (
        ("(11)", "a", "10⁻⁴", 1.3, _E4 * ellipse.a, ""),
        ("(11)", "b", "ms²", 2.3, ellipse.b, ""),
        ("(12)", "a", "10⁻⁵", 5.3, _E5 * a_12, ""),
        ("(12)", "b", "ms²", 1.04, b_12, ""),
        ("(13)", "exponential of f", "", NAN, NAN, at_2_hz),
        (
            "(14)",
            "a",
            "10⁻⁵",
            5.8,
            _E5 * float(fits.of_example("a", "f").min()),
            "least over the frequencies",
        ),
        ("(14)", "k₁", "ms²", 97.0, k1_example, ""),
        ("(14)", "k₂", "1/Hz", 3.4, k2_example, ""),
        ("(15)", "a", "10⁻⁵", 5.6, _E5 * fits.pooled_a, ""),
        ("(15)", "k₁", "ms²", 121.6, k1, from_table[0]),
        ("(15)", "k₂", "1/Hz", 6.6, k2, from_table[1]),
        ("(16a)", "k₃", "-", 0.046, k3, f"printed Table 4 gives {k3_table:.3g}; {quadratic}"),
        ("(16b)", "k₄", "ms", 100.0, k4, f"printed Table 4 gives {k4_table:.0f}; {quadratic}"),
        ("(17)", "a at ξ = 0.02", "10⁻⁴", _E4 * 0.046 * 0.02, _E4 * k3 * 0.02, "from (16a)"),
        ("(17)", "b at ξ = 0.02", "ms²", 2.0, k4 * 0.02, "from (16b)"),
        (
            "(18)",
            "factor of ξ in a",
            "-",
            0.021,
            factor_a,
            f"at ξ = 0.02 it is {0.021 * 0.02 / 5.6e-5:.1f} times a of (15)",
        ),
        (
            "(18)",
            "factor of ξ in b",
            "ms²",
            6080.0,
            factor_b,
            "from (11), (15) and (17) as in the text",
        ),
    )
    for number, quantity, unit, value, reproduced, remark in rows:
        yield Comparison(
            item=f"Equation {number}",
            quantity=quantity,
            unit=unit,
            printed=value,
            reproduced=reproduced,
            remark=remark,
        )
