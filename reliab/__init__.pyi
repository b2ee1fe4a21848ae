from .api import (
    assess as assess,
    calibrate as calibrate,
    calibrate_probabilities as calibrate_probabilities,
    compare as compare,
    derive_criteria as derive_criteria,
    design_test as design_test,
    diagnose_campaign as diagnose_campaign,
    ellipses as ellipses,
    export_monitor as export_monitor,
    follow_test as follow_test,
    judge_paper_cases as judge_paper_cases,
    perform_study as perform_study,
    record as record,
    simulate as simulate,
    simulate_suite as simulate_suite,
    trace_boundaries as trace_boundaries,
    validate_criteria as validate_criteria,
    validate_rebuilt_error as validate_rebuilt_error,
    write_explorer as write_explorer,
)
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
