"""Options of `reliab criterion`."""

from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.completion import laws, methods

Confidences = Annotated[
    list[float] | None, typer.Option("--confidence", metavar="SHARE...", help="Shares of ground motions.")
]
MethodName = Annotated[
    str | None,
    typer.Option(
        "--method",
        autocompletion=methods,
        metavar="NAME",
        help="What the confidence means: dirichlet (recommended, the default), quantile (the paper's), or "
        "another; --list names all.",
    ),
]
Assurance = Annotated[
    float | None,
    typer.Option(
        "--assurance",
        metavar="SHARE",
        help="How sure the promise is, for methods that state it (see --list): the share of suites that keep "
        "it, or its posterior probability.",
    ),
]
Steps = Annotated[
    int | None,
    typer.Option("--steps", metavar="N", help="Steps of the hierarchical methods' chains, a multiple of 4."),
]
Chains = Annotated[
    Path | None,
    typer.Option(
        "--chains",
        metavar="FILE.h5",
        help="Keep the chains of the hierarchical methods, so that an interrupted or short run can resume.",
    ),
]
Compare = Annotated[
    bool,
    typer.Option(
        "--compare", help="Also judge distributions and laws on earthquakes that they have not seen."
    ),
]
Figures = Annotated[
    Path | None,
    typer.Option(
        "--figures",
        metavar="FOLDER",
        help="Draw criteria over the motions' own ellipses, and traces, ranks and pairs of a posterior.",
    ),
]
DistributionName = Annotated[
    str | None, typer.Option("--distribution", metavar="NAME", help="Family for the method quantile.")
]
Joint = Annotated[
    bool | None,
    typer.Option(
        "--joint/--each",
        help="Whether the confidence holds for a and b together or for each of them separately; by "
        "default together, with quantile separately.",
    ),
]
LawName = Annotated[
    str,
    typer.Option(
        "--law",
        autocompletion=laws,
        metavar="NAME",
        help="How the limits depend on f and ξ: table (of the simulated structures, the default), or another "
        "law, fitted or printed; --list names all.",
    ),
]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="FILE.json", help="Write the criterion for later use.")
]
List = Annotated[
    bool, typer.Option("--list", help="Name all methods, laws and distributions, with what each means.")
]
