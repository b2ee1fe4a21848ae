"""Criteria of several shares of the stiffness beside the law of the share."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, table
from reliab.significant import significant

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion

_HEADINGS = (
    *("f [Hz]", "ξ [-]", "α [-]", "error [-]", "confidence [-]"),
    *("a over that of the largest α", "b over that of the largest α", "law", "a off by", "b off by"),
)


def shares_beside(
    dataset: "xr.Dataset | None", criteria: "Sequence[Criterion]", structures: Sequence[tuple[float, float]]
) -> dict[str, Any]:
    """Compare criteria with the law of the share of the stiffness, where they are of several.

    Returns `share_law`, as :func:`reliab.criterion.share_comparison.compare_shares` returns it; empty for one
    share, and where a law carried or predicted some of the ellipses.
    """
    if dataset is None or "alpha" not in dataset.dims or "caution" in dataset.attrs:
        return {}
    from reliab.criterion import compare_shares

    return {"share_law": compare_shares(criteria, structures)}


def show_shares(share_law: Mapping[str, Any]) -> None:
    """Print how limits of several shares compare with the law."""
    shown = table(
        "Limits over the share of the stiffness, and the law (1 + s)/(1 + s α²) with s = 1/8ξ²",
        dict.fromkeys(_HEADINGS, "right"),
    )
    for row in share_law["ratios"]:
        shown.add_row(
            *(f"{row[key]:g}" for key in ("f", "xi", "alpha", "threshold", "confidence")),
            *("-" if row[key] is None else significant(row[key]) for key in ("a_ratio", "b_ratio", "law")),
            *("-" if row[key] is None else f"{row[key]:+.1%}" for key in ("a_deviation", "b_deviation")),
        )
    terminal = console()
    terminal.print(shown)
    for fit in share_law["fits"]:
        where = f"f = {fit['f']:g} Hz, ξ = {fit['xi']:g}, error {fit['threshold']:g}"
        for name in ("a", "b"):
            strength, deviation = fit[f"{name}_strength"], fit[f"{name}_largest_deviation"]
            if strength is not None:
                terminal.print(
                    f"{name} at {where}: s = {significant(strength)} fits best, off by {deviation:.1%} "
                    f"at most; by the law s = {significant(fit['white_noise'])}.",
                    highlight=False,
                )
    terminal.print(
        "No law is stated for α below 10 ξ, and no ratio of a where boundaries end where tracing ends.",
        highlight=False,
    )
