"""`reliab criterion`: how much amplitude error and delay a test may have."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from reliab.cli.criterion.options import (
    Assurance,
    Chains,
    Compare,
    Confidences,
    DistributionName,
    Figures,
    Joint,
    LawName,
    List,
    MethodName,
    Out,
    Steps,
)
from reliab.cli.options import (
    DampingRatios,
    Ellipses,
    Fractions,
    Frequencies,
    JsonTarget,
    MetricName,
    ModelFile,
    Motions,
    Results,
    Sets,
    StructureFile,
    Thresholds,
    WindowIfGiven,
    options_of,
    refuse_others,
)
from reliab.errors import IncompleteError

if TYPE_CHECKING:
    from reliab.cli.criterion.demand import Demand
    from reliab.cli.criterion.derivation import Derived


def criterion(
    *,
    context: typer.Context,
    motions: Motions = None,
    sets: Sets = None,
    results: Results = None,
    ellipses: Ellipses = None,
    f: Frequencies = None,
    xi: DampingRatios = None,
    threshold: Thresholds = None,
    confidence: Confidences = None,
    metric: MetricName = "rms",
    window: WindowIfGiven = None,
    alpha: Fractions = None,
    model: ModelFile = None,
    structure: StructureFile = None,
    method: MethodName = None,
    assurance: Assurance = None,
    distribution: DistributionName = None,
    joint: Joint = None,
    law: LawName = "table",
    steps: Steps = None,
    chains: Chains = None,
    compare: Compare = False,
    figures: Figures = None,
    out: Out = None,
    list_all: List = False,
    json_target: JsonTarget = None,
) -> None:
    """Derive how much amplitude error and delay a test may have."""
    if list_all:
        from reliab.cli.criterion.choices import show_choices

        refuse_others(context, "list_all")
        show_choices()
        return
    from reliab.cli.criterion.answer import row, show, write
    from reliab.cli.criterion.comparison import show_comparison
    from reliab.cli.criterion.demand import Demand
    from reliab.cli.criterion.derivation import derived
    from reliab.cli.criterion.printed_law import printed
    from reliab.cli.criterion.rig import rig_beside, show_rig
    from reliab.cli.criterion.shares import shares_beside, show_shares
    from reliab.cli.output import write_json
    from reliab.criterion.laws import OF_MANY_MOTIONS

    demand = Demand(**options_of(Demand, context))
    of_law = law in OF_MANY_MOTIONS
    derivation = printed(demand) if of_law else derived(demand)
    dataset, criteria = derivation.dataset, derivation.criteria
    structures = demand.structures(dataset)
    rows = [
        row(criterion, None if of_law else dataset, f, xi) for f, xi in structures for criterion in criteria
    ]
    write(criteria[0], out)
    content = {"criteria": rows, **(rows[0] if len(rows) == 1 else {})}
    content |= {
        **_beside(demand, derivation, structures),
        **rig_beside(demand),
        **shares_beside(dataset, criteria, structures),
    }
    if not write_json(content, json_target):
        show(rows, derivation.posteriors)
        if "rig" in content:
            show_rig(content["rig"])
        if "share_law" in content:
            show_shares(content["share_law"])
        if compare:
            show_comparison(content["comparison"])
    _refuse_unconverged(derivation.posteriors, chains)


def _beside(
    demand: "Demand", derivation: "Derived", structures: Sequence[tuple[float, float]]
) -> dict[str, Any]:
    """Return what stands beside the criteria where it is asked for: posteriors, figures, a comparison."""
    from reliab.cli.criterion.comparison import compare
    from reliab.cli.criterion.figures import draw_all

    content: dict[str, Any] = {}
    if derivation.posteriors:
        content["posteriors"] = derivation.posteriors
    if demand.figures is not None:
        drawn = draw_all(
            demand.figures, derivation.dataset, derivation.criteria, structures, derivation.derivations
        )
        content |= {"figures": drawn} if drawn else {}
    if demand.compare:
        content["comparison"] = compare(derivation.dataset, structures, derivation.criteria)
    return content


def _refuse_unconverged(posteriors: Sequence[Mapping[str, Any]], chains: Path | None) -> None:
    """End with an error where a posterior cannot be relied on, after everything has been written."""
    failed = [posterior for posterior in posteriors if not posterior["converged"]]
    if failed:
        complaints = " ".join(sentence for posterior in failed for sentence in posterior["complaints"])
        again = f"{2 * failed[0]['steps']}"
        where = f"Resume with --chains {chains} --steps {again}" if chains else f"Give --steps {again}"
        message = (
            f"THE POSTERIOR HAS NOT CONVERGED, and no limit above may be relied on. {complaints} {where}."
        )
        raise IncompleteError(message)
