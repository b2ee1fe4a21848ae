"""``reliab criterion``: how much amplitude error and delay a test may have."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich import box
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

app = typer.Typer()

_WIDTH_OF_PIPES = 160
_STRUCTURE = (1.0, 0.02)  # the paper's, where nothing is said

Motions = Annotated[
    list[str] | None,
    typer.Option("--motions", metavar="SOURCE...", help="Records, folders or a built-in suite."),
]
Sets = Annotated[
    list[str] | None,
    typer.Option("--sets", metavar="NAME...", help="Sets of a catalogue; held_out counts only if named."),
]
Results = Annotated[
    Path | None, typer.Option("--results", metavar="STORE", help="Results store of `reliab simulate`.")
]
Ellipses = Annotated[
    Path | None,
    typer.Option("--ellipses", metavar="FILE.csv", help="Table with columns a, b and motion or event."),
]
Frequencies = Annotated[
    list[float] | None, typer.Option("--f", metavar="HZ...", help="Natural frequencies [Hz].")
]
DampingRatios = Annotated[
    list[float] | None, typer.Option("--xi", metavar="RATIO...", help="Damping ratios, 0.02 for 2 %.")
]
Thresholds = Annotated[
    list[float] | None, typer.Option("--threshold", metavar="ERROR...", help="Errors, 0.05 for 5 %.")
]
Confidences = Annotated[
    list[float] | None, typer.Option("--confidence", metavar="SHARE...", help="Shares of ground motions.")
]
MetricName = Annotated[str, typer.Option("--metric", metavar="rms|mte", help="Error of the whole test.")]
WindowName = Annotated[
    str, typer.Option("--window", metavar="record|SECONDS|arias", help="Where the error is taken.")
]
MethodName = Annotated[str, typer.Option("--method", metavar="NAME", help="What the confidence means.")]
Assurance = Annotated[
    float | None,
    typer.Option(
        "--assurance", metavar="SHARE", help="Share of suites that keep the promise (tolerance ...)."
    ),
]
DistributionName = Annotated[
    str | None, typer.Option("--distribution", metavar="NAME", help="Family for the method quantile.")
]
Joint = Annotated[
    bool, typer.Option("--joint/--each", help="Whether a and b hold together or each for itself.")
]
JsonTarget = Annotated[
    str | None, typer.Option("--json", metavar="FILE|-", help="Write JSON to a file, or - for nothing else.")
]


@app.command("criterion")
def criterion(
    *,
    motions: Motions = None,
    sets: Sets = None,
    results: Results = None,
    ellipses: Ellipses = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    threshold: Thresholds = None,
    confidence: Confidences = None,
    metric: MetricName = "rms",
    window: WindowName = "record",
    method: MethodName = "quantile",
    assurance: Assurance = None,
    distribution: DistributionName = None,
    joint: Joint = False,
    json_target: JsonTarget = None,
) -> None:
    """Derive how much amplitude error and delay a test may have."""
    from reliab.criterion.derivation import derive_criterion
    from reliab.criterion.methods import method_of
    from reliab.criterion.summary import summarise

    table = _ellipses(motions, sets, results, ellipses, f, xi, threshold, metric, window)
    chosen = method_of(method, assurance=assurance, distribution=distribution)
    rows = [
        summarise(
            derive_criterion(
                table,
                frequency=each_f,
                damping_ratio=each_xi,
                threshold=each_threshold,
                metric=metric,
                confidence=each_confidence,
                method=chosen,
                joint=joint,
            ),
            table,
            each_f,
            each_xi,
        )
        for each_f in f or table["f"].values.tolist()
        for each_xi in xi or table["xi"].values.tolist()
        for each_threshold in threshold or table["threshold"].values.tolist()
        for each_confidence in confidence or (0.95,)
    ]
    content: dict[str, Any] = {"criteria": rows, **(rows[0] if len(rows) == 1 else {})}
    if not _write_json(content, json_target):
        _show(rows)


def _ellipses(
    motions: list[str] | None,
    sets: list[str] | None,
    results: Path | None,
    ellipses: Path | None,
    f: list[float] | None,
    xi: list[float] | None,
    threshold: list[float] | None,
    metric: str,
    window: str,
) -> "xr.Dataset":
    thresholds = tuple(threshold or (0.05,))
    given = [source for source in (motions, results, ellipses) if source]
    if len(given) != 1:
        raise InputError(
            "A criterion is derived from exactly one of --motions, --results and --ellipses",
            value=f"{len(given)} of them",
            remedy="Give --motions with folders of records, or --motions synthetic for the built-in suite",
        )
    if ellipses is not None:
        return _from_table(ellipses, f, xi, thresholds, metric)
    if results is not None:
        return _from_store(results, thresholds, metric)
    frequencies, damping_ratios = tuple(f or _STRUCTURE[:1]), tuple(xi or _STRUCTURE[1:])
    return _simulate(motions or [], sets, frequencies, damping_ratios, thresholds, metric, window)


def _from_table(
    path: Path, f: list[float] | None, xi: list[float] | None, thresholds: tuple[float, ...], metric: str
) -> "xr.Dataset":
    from reliab.criterion.ellipse_csv import read_ellipses

    return read_ellipses(
        path,
        frequency=(f or _STRUCTURE)[0],
        damping_ratio=(xi or _STRUCTURE[1:])[0],
        threshold=thresholds[0],
        metric=metric,
    )


def _from_store(path: Path, thresholds: tuple[float, ...], metric: str) -> "xr.Dataset":
    from reliab.sweep import ellipses_from_results, open_results
    from reliab.vocabulary import Metric

    return ellipses_from_results(open_results(path), thresholds=thresholds, metrics=(Metric(metric),))


def _simulate(
    sources: list[str],
    sets: list[str] | None,
    frequencies: tuple[float, ...],
    damping_ratios: tuple[float, ...],
    thresholds: tuple[float, ...],
    metric: str,
    window: str,
) -> "xr.Dataset":
    from reliab.indices.window import Window
    from reliab.motions import load_motions
    from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
    from reliab.vocabulary import Metric

    request = EllipseRequest(
        frequencies=frequencies,
        damping_ratios=damping_ratios,
        thresholds=thresholds,
        metrics=(Metric(metric),),
        window=Window.parse(window),
    )
    suite = load_motions(*sources, sets=sets)
    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("boundaries", total=len(suite))
        return trace_ellipses(suite, request, progress=lambda done, _: bar.update(task, completed=done))


def _show(rows: list[dict[str, Any]]) -> None:
    first = rows[0]
    table = Table(
        title=f"(A − 1)²/a + d²/b ≤ 1 from {first['n_motions']} motions of {first['n_events']} earthquakes",
        box=box.SIMPLE,
        padding=(0, 1, 0, 0),
    )
    for heading in (
        "f [Hz]",
        "ξ",
        "error",
        "confidence",
        "a",
        "b [ms²]",
        "|A − 1| ≤",
        "d ≤ [ms]",
        "corr(a, b)",
    ):
        table.add_column(Text(heading), justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            *(f"{row[key]:g}" for key in ("f", "xi", "threshold", "confidence")),
            *(f"{row[key]:.3g}" for key in ("a", "b", "amplitude_limit", "delay_limit_ms")),
        )
    console = _console()
    console.print(table)
    console.print(f"Method: {first['method']}, {'a and b together' if first['joint'] else 'a and b each'}.")
    for warning in dict.fromkeys(warning for row in rows for warning in row["warnings"]):
        console.print(f"Note: {warning}", markup=False, highlight=False)


def _console() -> Console:
    """Tables fit the terminal; in a pipe or a file they are wide enough to be searched."""
    console = Console()
    return console if console.is_terminal else Console(width=_WIDTH_OF_PIPES)


def _write_json(content: dict[str, Any], target: str | None) -> bool:
    """Write JSON if asked for; tell whether it is all that may stand on standard output."""
    if target is None:
        return False
    text = json.dumps(content, indent=2, ensure_ascii=False)
    if target == "-":
        typer.echo(text)
        return True
    try:
        Path(target).write_text(f"{text}\n", encoding="utf-8")
    except OSError as error:
        raise InputError(
            "The JSON file must be writable", value=error.strerror, remedy="Name another file", where=target
        ) from error
    return False
