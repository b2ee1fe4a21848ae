"""Criteria of published laws."""

from reliab.criterion.criterion import Criterion
from reliab.criterion.laws import OF_MANY_MOTIONS, known
from reliab.criterion.provenance import Provenance
from reliab.vocabulary import Metric


def published_criterion(name: str) -> Criterion:
    """Make the criterion of a published or corrected law.

    Parameters
    ----------
    name : str
        A law that promises a confidence over motions, such as "guo_2017_18".

    Returns
    -------
    Criterion
        At 5 % RMS^R and the 95 % that the paper states.

    Raises
    ------
    InputError
        If there is no such law.

    Examples
    --------
    Case 1 of Table 6:

    >>> criterion = published_criterion("guo_2017_18")
    >>> round(float(criterion.index(1.0039, 0.39e-3, 1.0, 0.02)), 3)
    0.956
    """
    law = known(OF_MANY_MOTIONS, name)
    return Criterion(
        law=law,
        threshold=0.05,
        metric=str(Metric.RMS),
        confidence=0.95,
        method="quantile",
        joint=False,
        provenance=Provenance(source=f"Guo and others (2017), {law.equation}", n_motions=100, n_events=19),
    )
