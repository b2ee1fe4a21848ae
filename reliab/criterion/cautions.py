"""What a user should know before relying on a criterion, in plain sentences."""

from collections.abc import Sequence

import xarray as xr

from reliab.criterion.ellipse_sample import EllipseSample
from reliab.criterion.goodness_of_fit import objection
from reliab.criterion.methods import Method

_FEW_EVENTS = 30


def caution_of(ellipses: xr.Dataset) -> tuple[str, ...]:
    """Take what a dataset of ellipses says against itself, in its attribute `caution`; nothing by default."""
    return (str(ellipses.attrs["caution"]),) if "caution" in ellipses.attrs else ()


def without_promise(method: str, confidence: float, structures: int) -> tuple[str, ...]:
    """Say that a method can promise nothing at some structures; nothing where there are none.

    Examples
    --------
    >>> without_promise("conformal", 0.99, 1)
    ('Too few motions or earthquakes for conformal at 0.99: the limits are zero, and no test is accepted.',)
    """
    if not structures:
        return ()
    few = f"Too few motions or earthquakes for {method} at {confidence:g}"
    return (f"{few}: the limits are zero, and no test is accepted.",)


def cautions_of(samples: Sequence[Sequence[EllipseSample]], offered: int, method: Method) -> tuple[str, ...]:
    """Say what limits the criterion of a grid of structures.

    Parameters
    ----------
    samples : sequence of sequence of EllipseSample
        Motions of every structure.
    offered : int
        Motions of the dataset.
    method : Method
        What the confidence means.

    Returns
    -------
    tuple of str
        Sentences: motions left out, few earthquakes, lognormality rejected where the method needs it.
    """
    cells = [sample for row in samples for sample in row]
    fewest = min(sample.n_events for sample in cells)
    found = (_left_out(cells, offered, method), few_events(fewest), *_not_lognormal(cells, method))
    return tuple(sentence for sentence in found if sentence)


def _left_out(cells: Sequence[EllipseSample], offered: int, method: Method) -> str:
    fewest = min(sample.n_motions for sample in cells)
    if fewest == offered:
        return ""
    consequence = (
        "which narrows the fitted distribution, so that its lower quantile may lie a little too high; "
        "dirichlet, order_statistic and conformal stay on the safe side"
        if method.assumes_lognormality
        else "so that this is on the safe side"
    )
    return (
        f"Up to {offered - fewest} of {offered} motions have no ellipse at some structure and were left out "
        f"there: their boundaries reach beyond five damping ratios of amplitude error, {consequence}."
    )


def few_events(fewest: int) -> str:
    """Say that there are few earthquakes; nothing from thirty on.

    Parameters
    ----------
    fewest : int
        Number of earthquakes.

    Returns
    -------
    str
        A sentence, or nothing.

    Examples
    --------
    >>> few_events(1)
    'The motions come from one earthquake only, and motions of one earthquake are alike.'
    """
    if fewest >= _FEW_EVENTS:
        return ""
    noun = "one earthquake" if fewest == 1 else f"{fewest} earthquakes"
    return f"The motions come from {noun} only, and motions of one earthquake are alike."


def _not_lognormal(cells: Sequence[EllipseSample], method: Method) -> list[str]:
    if not method.assumes_lognormality:
        return []
    objections = [(objection(sample.a, "a"), objection(sample.b, "b")) for sample in cells]
    if len(cells) == 1:
        return list(objections[0])
    rejected = sum(any(pair) for pair in objections)
    if not rejected:
        return []
    sentence = (
        f"a or b is not lognormal over these motions at {rejected} of {len(cells)} structures, so that a "
        "lognormal quantile does not keep the stated confidence there; the methods dirichlet, "
        "order_statistic and conformal do not need it."
    )
    return [sentence]
