"""`reliab explore`: a web page with sliders for the tolerable region, in which a test file is placed."""

from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.completion import metrics, results
from reliab.cli.options import JsonTarget
from reliab.cli.output import console, write_json

_MEGABYTE = 1e6

Out = Annotated[Path, typer.Option("--out", metavar="FILE.html", help="The page to write.")]
Ellipses = Annotated[
    Path,
    typer.Option(
        "--ellipses",
        autocompletion=results,
        metavar="FILE.nc",
        help="Ellipses from `reliab ellipses`, or real_suite: 100 real ground motions (shipped).",
    ),
]
Frequency = Annotated[
    float | None, typer.Option("--f", metavar="HZ", help="Natural frequency with which the page opens.")
]
DampingRatio = Annotated[
    float | None, typer.Option("--xi", metavar="RATIO", help="Damping ratio with which the page opens.")
]
Alpha = Annotated[
    float, typer.Option("--alpha", metavar="SHARE", help="Share of the stiffness in the laboratory.")
]
Threshold = Annotated[
    float | None, typer.Option("--threshold", metavar="ERROR", help="Error of the whole test, 0.05 for 5 %.")
]
MetricName = Annotated[
    str | None,
    typer.Option(
        "--metric", autocompletion=metrics, metavar="rms|mte", help="Error of the whole test: RMS^R or MTE^R."
    ),
]
Confidence = Annotated[
    float, typer.Option("--confidence", metavar="SHARE", help="Share of ground motions, 0.95 for 95 %.")
]


def explore(
    *,
    out: Out = Path("criterion.html"),
    ellipses: Ellipses = Path("real_suite"),
    f: Frequency = None,
    xi: DampingRatio = None,
    alpha: Alpha = 1.0,
    threshold: Threshold = None,
    confidence: Confidence = 0.95,
    metric: MetricName = None,
    json_target: JsonTarget = None,
) -> None:
    """Write a web page, for use offline, of tolerable errors and of where a test dropped on it lies."""
    from reliab.explore import Settings, write_page
    from reliab.shipped import or_shipped
    from reliab.sweep import open_windows

    path = or_shipped(ellipses, "datasets", "ellipses.nc")
    windows = open_windows(path)
    lengths = {label: table for label, table in windows.items() if label != "arias"}
    settings = Settings(
        frequency=f,
        damping_ratio=xi,
        experimental_fraction=alpha,
        threshold=threshold,
        confidence=confidence,
        metric=metric,
    )
    write_page(out, lengths or windows, settings, source=f"the ellipses of {ellipses.name}")
    size = out.stat().st_size
    answer = {"page": str(out), "bytes": size, "ellipses": ellipses.name, "windows": list(lengths or windows)}
    if not write_json(answer, json_target):
        console().print(f"{out}: {size / _MEGABYTE:.1f} MB, open it in any browser.", highlight=False)
