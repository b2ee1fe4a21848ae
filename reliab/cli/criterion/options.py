"""Options of `reliab criterion`."""

from pathlib import Path
from typing import Annotated

import typer

Confidences = Annotated[
    list[float] | None, typer.Option("--confidence", metavar="SHARE...", help="Shares of ground motions.")
]
MethodName = Annotated[
    str | None,
    typer.Option(
        "--method",
        metavar="NAME",
        help="What the confidence means: dirichlet (recommended, the default), tolerance, posterior, "
        "predictive, order_statistic, conformal, bootstrap, each structure for itself; hierarchical, "
        "hierarchical_robust, all structures at once by MCMC; quantile is the paper's, with fitted "
        "ellipses and a and b each for itself.",
    ),
]
Assurance = Annotated[
    float | None,
    typer.Option(
        "--assurance",
        metavar="SHARE",
        help="Share of suites that keep the promise (tolerance, posterior, order_statistic, bootstrap), "
        "or its posterior probability (hierarchical).",
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
        help="Whether a and b hold together or each for itself; by default together, with quantile each.",
    ),
]
LawName = Annotated[
    str,
    typer.Option(
        "--law",
        metavar="NAME",
        help="table, dimensionless, power or exponential, fitted to the structures; or printed: "
        "guo_2017_12, guo_2017_15, guo_2017_18, and with _corrected.",
    ),
]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="FILE.json", help="Write the criterion for later use.")
]
