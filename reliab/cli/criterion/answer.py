"""What `reliab criterion` answers: rows, tables on the terminal, and the criterion's file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reliab.cli.output import console, table
from reliab.errors import InputError
from reliab.files import written_whole
from reliab.significant import significant

if TYPE_CHECKING:
    import xarray as xr

    from reliab.criterion import Criterion

_HEADINGS = (
    *("f [Hz]", "ξ [-]", "α [-]", "error [-]", "confidence [-]", "a [-]", "b [ms²]"),
    *("|A − 1| alone ≤", "lag alone ≤ [ms]", "lead alone ≤ [ms]"),
)
_CURVES = {
    "inscribed": "inscribed in the motions' boundaries",
    "ellipse": "fitted to the motions' boundaries by least squares, as in the paper",
}
_DIAGNOSTICS = {
    "parameter": "left",
    "mean": "right",
    "spread": "right",
    "R-hat": "right",
    "bulk size": "right",
    "tail size": "right",
    "autocorrelation time": "right",
}
_KEYS = ("mean", "spread", "r_hat", "bulk_size", "tail_size", "autocorrelation_time")
_FORMATS = (".3f", ".3f", ".4f", ".0f", ".0f", ".1f")


def row(
    criterion: "Criterion", dataset: "xr.Dataset | None", frequency: float, damping_ratio: float
) -> dict[str, Any]:
    """Summarise a criterion at one structure, with its motions where the dataset has it.

    `frequency`, `damping_ratio` [Hz, -].
    """
    from reliab.criterion import describe_sample, summarise
    from reliab.sweep import at_share

    summary = summarise(criterion, frequency, damping_ratio)
    if criterion.population is None:
        summary.update(_kept_by(criterion, summary))
    elif dataset is not None and frequency in dataset["f"] and damping_ratio in dataset["xi"]:
        of_share = at_share(dataset, criterion.provenance.experimental_fraction)
        summary.update(describe_sample(of_share, criterion, frequency, damping_ratio))
    return summary


def _kept_by(criterion: "Criterion", summary: Mapping[str, Any]) -> dict[str, Any]:
    """Measure on the real motions that ship with the package how many keep a printed law."""
    from reliab.criterion import printed_share
    from reliab.shipped import shipped
    from reliab.sweep import open_ellipses

    real = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"), window=criterion.provenance.window)
    kept = printed_share(criterion, real, summary["f"], summary["xi"])
    sentence = (
        f"Of {kept['n_motions']} real motions, {kept['share']:.0%} have a boundary that contains this "
        f"ellipse at f = {kept['f']:g} Hz and ξ = {kept['xi']:g}, where the paper states "
        f"{criterion.confidence:.0%}; measured on the ellipses of datasets/real_suite, for all structures "
        "by `reliab run validation`."
    )
    return {"kept_by": kept, "warnings": [sentence, *summary["warnings"]]}


def check_one(count: int, out: Path | None) -> None:
    """Refuse a file for several criteria, before any of them is derived."""
    if out is not None and count > 1:
        raise InputError(
            "A criterion's file holds one criterion",
            value=f"{count} of them",
            remedy="Give one threshold, one confidence and one share of the stiffness",
            where=str(out),
        )


def write(criterion: "Criterion", out: Path | None) -> None:
    """Write a criterion for later use."""
    if out is None:
        return
    try:
        with written_whole(out) as file:
            file.write_text(criterion.to_json(), encoding="utf-8")
    except OSError as error:
        raise InputError(
            "The criterion's file must be writable",
            value=error.strerror,
            remedy="Name another file",
            where=str(out),
        ) from error


def show(rows: Sequence[Mapping[str, Any]], posteriors: Sequence[Mapping[str, Any]]) -> None:
    """Print criteria, the diagnostics of their posteriors, and what should be known of both."""
    first = rows[0]
    shown = table(
        f"(A − 1)²/a + d²/b ≤ 1 from {first['n_motions']} {first['motions']} of {first['n_events']} "
        "earthquakes",
        dict.fromkeys(_HEADINGS, "right"),
    )
    for row in rows:
        shown.add_row(
            *(f"{row[key]:g}" for key in ("f", "xi", "alpha", "threshold", "confidence")),
            *(significant(row[key]) for key in ("a", "b", "amplitude_limit", "delay_limit_ms")),
            "-" if row["lead_limit_ms"] is None else significant(row["lead_limit_ms"]),
        )
    terminal = console()
    for posterior in posteriors:
        _show_posterior(posterior)
    terminal.print(shown)
    together = "a and b together" if first["joint"] else "a and b each for itself"
    terminal.print(f"Method: {first['method']}, {together}. Law: {first['law']}.", highlight=False)
    for sentence in _definitions(rows):
        terminal.print(sentence, markup=False, highlight=False)
    for warning in dict.fromkeys(warning for row in rows for warning in row["warnings"]):
        terminal.print(f"Note: {warning}", markup=False, highlight=False)


def _definitions(rows: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """Say what the limits and the error mean."""
    from reliab.vocabulary import LABELS

    alone = (
        "Each limit alone is that of a test without the other error; a test with both must "
        "lie inside the ellipse."
    )
    first = rows[0]
    error = f"Error: {LABELS[first['metric']].long_name}. Window: {first['window']}."
    shares = ", ".join(dict.fromkeys(f"{row['alpha']:g}" for row in rows))
    fraction = f"Experimental fraction α: {shares}."
    return alone, f"{error} {fraction} Ellipses: {_CURVES[first['curve']]}."


def _show_posterior(posterior: Mapping[str, Any]) -> None:
    shown = table(
        f"Posterior at {posterior['threshold']:g} of {posterior['metric']}: {posterior['ensembles']} "
        f"ensembles of {posterior['walkers']} walkers, {posterior['steps']} steps, "
        f"{posterior['accepted']:.0%} of the moves taken",
        _DIAGNOSTICS,
    )
    for parameter in posterior["parameters"]:
        numbers = zip(_KEYS, _FORMATS, strict=True)
        shown.add_row(
            parameter["parameter"],
            *("-" if parameter[key] is None else format(parameter[key], digits) for key, digits in numbers),
        )
    terminal = console()
    terminal.print(shown)
    if posterior["converged"]:
        terminal.print("Converged: R-hat < 1.01 and effective sizes > 1,000 for every parameter.")
        return
    terminal.print("THIS POSTERIOR HAS NOT CONVERGED.", style="bold red")
    for complaint in posterior["complaints"]:
        terminal.print(complaint, style="red", highlight=False)
