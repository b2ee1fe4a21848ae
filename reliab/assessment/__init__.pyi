from .assess import assess as assess
from .assessment import Assessment as Assessment
from .budget import (
    CHANNELS as CHANNELS,
    BudgetItem as BudgetItem,
    Equipment as Equipment,
    corrected as corrected,
    ordinary_equipment as ordinary_equipment,
    read_equipment as read_equipment,
    stated_of_filters as stated_of_filters,
)
from .comparison import Comparison as Comparison, rank_tests as rank_tests
from .corrected_response import corrected_response as corrected_response
from .default_criterion import (
    default_criterion as default_criterion,
    ellipses_of_motions as ellipses_of_motions,
    typical_ellipse as typical_ellipse,
)
from .design import (
    CONFIDENCES as CONFIDENCES,
    Tolerance as Tolerance,
    boundaries_of_motions as boundaries_of_motions,
    chart_frequencies as chart_frequencies,
    tolerable_errors as tolerable_errors,
    tolerable_sides as tolerable_sides,
)
from .error_of_test import (
    CANCELLING as CANCELLING,
    PART_NAMES as PART_NAMES,
    ErrorOfTest as ErrorOfTest,
    part_in_words as part_in_words,
)
from .error_with_threshold import ErrorOfSeveral as ErrorOfSeveral, ErrorWithThreshold as ErrorWithThreshold
from .faults import plain_faults as plain_faults
from .frame_assessment import (
    CoupledAssessment as CoupledAssessment,
    FrameAssessment as FrameAssessment,
    JudgedFrame as JudgedFrame,
    ModeOfTest as ModeOfTest,
)
from .frame_responses import ResponseErrors as ResponseErrors
from .frame_test import (
    assess_frame as assess_frame,
    require_answerable as require_answerable,
    require_linear_interface as require_linear_interface,
)
from .measured_specimen import ForceChannel as ForceChannel
from .placement import carried_limits as carried_limits
from .plain_error import plain_errors as plain_errors
from .plausibility import RunningSign as RunningSign, require_plausible as require_plausible
from .recorded_force import (
    doubts_of_force as doubts_of_force,
    doubts_of_sign as doubts_of_sign,
    require_restoring_force as require_restoring_force,
    unit_like as unit_like,
)
from .recorded_ground import doubts_of_ground as doubts_of_ground
from .several import Assessments as Assessments, verdict_table as verdict_table
from .tracking_index import LEVEL as LEVEL, Windows as Windows, white_noise_share as white_noise_share
from .verdict import (
    ERROR_NAMES as ERROR_NAMES,
    Word as Word,
    error_in_words as error_in_words,
    next_steps as next_steps,
    probability_text as probability_text,
    word_of_probability as word_of_probability,
)
