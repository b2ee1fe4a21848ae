from .api.assessment import assess as assess
from .api.boundaries import ellipses as ellipses
from .api.design import design_test as design_test
from .api.simulation import simulate as simulate
from .criterion import (
    derive_criterion as derive_criterion,
    published_criterion as published_criterion,
    read_ellipses as read_ellipses,
)
from .discrepancy import diagnose as diagnose, read_campaign as read_campaign
from .errors import InputError as InputError
from .motions import load_motions as load_motions
from .recordings import read_recording as read_recording
from .structures.structure import Structure as Structure
from .study import open_study as open_study, run_study as run_study, write_report as write_report
from .sweep import open_results as open_results
from .validation.cross_validation import cross_validate as cross_validate
from .version import __version__ as __version__
