"""The literature that reports refer to, and from what a report can be made again."""

from collections.abc import Mapping
from typing import Final

from reliab.criterion.provenance import Provenance, read_versions
from reliab.report.document import Source


def provenance_of(
    settings_by_name: Mapping[str, object], criterion: Provenance | None = None
) -> dict[str, str]:
    """Collect versions, checksums and settings.

    `settings_by_name`: what the caller knows, by its name: the hash of the study, seeds, …; shown first.
    """
    lines = {name: _line(value) for name, value in settings_by_name.items()}
    if criterion is None:
        return {"packages": _line(read_versions()), **lines}
    settings = _line(criterion.settings)
    derivations = {
        "source": criterion.source,
        "motions, earthquakes": f"{criterion.n_motions}, {criterion.n_events}",
        "records, SHA-256": criterion.records_checksum,
        "window": criterion.window,
        "settings of the method": settings,
        "packages": _line(criterion.packages),
    }
    return {**lines, **{name: text for name, text in derivations.items() if text and name not in lines}}


def _line(value: object) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{str(name).replace('_', ' ')} {_line(item)}" for name, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_line(item) for item in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


SOURCES: Final = (
    Source(
        label="guo2017",
        text=(
            "Guo and others (2017). Reliability assessment of real-time hybrid simulation under worst-case "
            "scenarios using frequency-domain evaluation indices. Published online 13 February 2017."
        ),
    ),
    Source(
        label="guo2014",
        text=(
            "Guo, T., Chen, C., Xu, W. and Sanchez, F. (2014). A frequency response analysis approach for "
            "quantitative assessment of actuator tracking for real-time hybrid simulation. "
            "Smart Materials and Structures 23(4), 045042."
        ),
    ),
    Source(
        label="ferguson1973",
        text=(
            "Ferguson, T. S. (1973). A Bayesian analysis of some nonparametric problems. "
            "Annals of Statistics 1(2), 209–230."
        ),
    ),
    Source(
        label="gelman2013",
        text="Gelman, A. and others (2013). Bayesian data analysis, third edition, section 3.3.",
    ),
    Source(
        label="searle1992",
        text="Searle, S. R., Casella, G. and McCulloch, C. E. (1992). Variance components, section 3.6.",
    ),
    Source(
        label="davison1997",
        text=(
            "Davison, A. C. and Hinkley, D. V. (1997). Bootstrap methods and their application, section 3.8."
        ),
    ),
    Source(
        label="odeh1980",
        text=(
            "Odeh, R. E. and Owen, D. B. (1980). Tables for normal tolerance limits, sampling plans, and "
            "screening."
        ),
    ),
    Source(
        label="dabaghi2018",
        text=(
            "Dabaghi, M. and Der Kiureghian, A. (2018). Simulation of orthogonal horizontal components of "
            "near-fault ground motion for specified earthquake source and site characteristics. "
            "Earthquake Engineering and Structural Dynamics 47(6), 1369–1393."
        ),
    ),
    Source(
        label="wallace2005",
        text=(
            "Wallace, M. I., Sieber, J., Neild, S. A., Wagg, D. J. and Krauskopf, B. (2005). Stability "
            "analysis of real-time dynamic substructuring using delay differential equation models. "
            "Earthquake Engineering and Structural Dynamics 34(15), 1817–1832."
        ),
    ),
)
"""Every source by its label; a report lists those that it refers to."""
