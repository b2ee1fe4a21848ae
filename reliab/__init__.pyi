from .app.api.assessment import assess as assess, compare as compare
from .app.api.design import design_test as design_test, write_explorer as write_explorer
from .app.api.diagnosis import report_diagnosis as report_diagnosis
from .app.api.monitor import export_monitor as export_monitor, follow_test as follow_test
from .app.api.records import calibrate as calibrate, check_records as check_records, record as record
from .app.api.rigs import (
    add_to_rig as add_to_rig,
    export_rig as export_rig,
    list_rig as list_rig,
    predict_rig as predict_rig,
    remove_from_rig as remove_from_rig,
    report_rig as report_rig,
    show_rig_test as show_rig_test,
)
from .app.api.simulation import (
    check_motions as check_motions,
    import_motions as import_motions,
    list_motions as list_motions,
    simulate as simulate,
    synthesize_motions as synthesize_motions,
)
from .app.api.sources import ellipses as ellipses
from .app.api.studies import (
    copy_samples as copy_samples,
    describe_installation as describe_installation,
    fetch_dataset as fetch_dataset,
    list_studies as list_studies,
    run_study as run_study,
)
from .app.api.validation import (
    calibrate_probabilities as calibrate_probabilities,
    validate_criteria as validate_criteria,
)
from .core.errors import InputError as InputError
from .criterion.derivation import (
    derive_criterion as derive_criterion,
    published_criterion as published_criterion,
)
from .criterion.ellipse_reading import read_ellipses as read_ellipses
from .discrepancy.campaign.reading import read_campaign as read_campaign
from .discrepancy.diagnose import diagnose as diagnose
from .motions.loading import load_motions as load_motions
from .recordings.reading import read_recording as read_recording
from .structures.structure import Structure as Structure
from .study.running import write_report as write_report
from .sweep.results import open_results as open_results
from .validation.judge import cross_validate as cross_validate
from .version import __version__ as __version__
