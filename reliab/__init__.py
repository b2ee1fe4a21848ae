"""Probabilistic reliability of real-time hybrid simulation.

Commands that answer have functions here: `load_motions`, `simulate`, `ellipses`, `derive_criterion`,
`assess`, `design_test`, `cross_validate`, `diagnose` and `write_report`; beside them stand what reads their
input (`open_results`, `read_ellipses`, `read_recording`, `read_campaign`, `open_study`),
`published_criterion`, `run_study`, a `Structure` and the `InputError` that bad input raises. Each is imported
when it is first asked for.
"""

from typing import TYPE_CHECKING

from reliab.lazy_exports import exports
from reliab.version import __version__

if TYPE_CHECKING:
    from reliab.api.assessment import assess
    from reliab.api.boundaries import ellipses
    from reliab.api.design import design_test
    from reliab.api.simulation import simulate
    from reliab.criterion import derive_criterion, published_criterion, read_ellipses
    from reliab.discrepancy import diagnose, read_campaign
    from reliab.errors import InputError
    from reliab.motions import load_motions
    from reliab.recordings import read_recording
    from reliab.structures.structure import Structure
    from reliab.study import open_study, run_study, write_report
    from reliab.sweep import open_results
    from reliab.validation.cross_validation import cross_validate

_HOMES = {
    "load_motions": "reliab.motions",
    "simulate": "reliab.api.simulation",
    "ellipses": "reliab.api.boundaries",
    "open_results": "reliab.sweep",
    "read_ellipses": "reliab.criterion",
    "derive_criterion": "reliab.criterion",
    "published_criterion": "reliab.criterion",
    "cross_validate": "reliab.validation.cross_validation",
    "read_recording": "reliab.recordings",
    "assess": "reliab.api.assessment",
    "design_test": "reliab.api.design",
    "read_campaign": "reliab.discrepancy",
    "diagnose": "reliab.discrepancy",
    "open_study": "reliab.study",
    "run_study": "reliab.study",
    "write_report": "reliab.study",
    "Structure": "reliab.structures.structure",
    "InputError": "reliab.errors",
}

__all__ = [
    "InputError",
    "Structure",
    "__version__",
    "assess",
    "cross_validate",
    "derive_criterion",
    "design_test",
    "diagnose",
    "ellipses",
    "load_motions",
    "open_results",
    "open_study",
    "published_criterion",
    "read_campaign",
    "read_ellipses",
    "read_recording",
    "run_study",
    "simulate",
    "write_report",
]


__getattr__ = exports(__name__, _HOMES)


def __dir__() -> list[str]:
    return sorted(__all__)
