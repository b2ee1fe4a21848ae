from .arguments import unused as unused
from .assessment import assess as assess
from .assessment_files import (
    document_of_test as document_of_test,
    draw_chart as draw_chart,
    file_report as file_report,
    write_corrected as write_corrected,
    write_tests as write_tests,
)
from .boundaries import ellipses as ellipses
from .comparison import compare as compare, compare_assessments as compare_assessments
from .criteria import derive_criteria as derive_criteria
from .derived_criteria import Criteria as Criteria
from .design import Design as Design, design_test as design_test
from .diagnosis import (
    diagnose_campaign as diagnose_campaign,
    document_of_diagnosis as document_of_diagnosis,
    report_diagnosis as report_diagnosis,
)
from .explorer import write_explorer as write_explorer
from .followed_test import Message as Message
from .following import follow_test as follow_test
from .in_loop import export_monitor as export_monitor
from .installation import (
    copy_samples as copy_samples,
    describe_installation as describe_installation,
    fetch_dataset as fetch_dataset,
)
from .motions import (
    WrittenSuite as WrittenSuite,
    check_motions as check_motions,
    import_motions as import_motions,
    list_motions as list_motions,
    synthesize_motions as synthesize_motions,
)
from .records import (
    Record as Record,
    calibrate as calibrate,
    check_records as check_records,
    record as record,
)
from .rig_answers import (
    compare_rigs as compare_rigs,
    document_of_rig as document_of_rig,
    plan_rig as plan_rig,
    predict_rig as predict_rig,
    report_rig as report_rig,
)
from .rigs import (
    add_to_rig as add_to_rig,
    export_rig as export_rig,
    list_rig as list_rig,
    remove_from_rig as remove_from_rig,
    show_rig_test as show_rig_test,
)
from .simulated_verdicts import (
    judge_paper_cases as judge_paper_cases,
    validate_rebuilt_error as validate_rebuilt_error,
)
from .simulation import simulate as simulate, simulate_suite as simulate_suite
from .studies import list_studies as list_studies, perform_study as perform_study, report_run as report_run
from .tracing import Boundaries as Boundaries, trace_boundaries as trace_boundaries
from .validation import (
    calibrate_probabilities as calibrate_probabilities,
    validate_criteria as validate_criteria,
)
