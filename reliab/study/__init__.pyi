from .description import (
    CriterionStudy as CriterionStudy,
    CriterionTable as CriterionTable,
    MotionsTable as MotionsTable,
    Names as Names,
    RecordsStudy as RecordsStudy,
    SimulatedStudy as SimulatedStudy,
    StructuresTable as StructuresTable,
    Study as Study,
    Table as Table,
    TransferTable as TransferTable,
    ValidationTable as ValidationTable,
)
from .folders import study_module as study_module
from .kind import Kind as Kind
from .material import (
    SYNTHETIC as SYNTHETIC,
    Material as Material,
    Records as Records,
    motion_by_name as motion_by_name,
)
from .reading import open_study as open_study, shipped_studies as shipped_studies
from .running import run_study as run_study, write_report as write_report
from .stages import Stage as Stage, digest as digest, made_with as made_with, read_result as read_result
from .steps import (
    CRITERIA as CRITERIA,
    ELLIPSES as ELLIPSES,
    candidates as candidates,
    derivation as derivation,
    derivation_of as derivation_of,
    judgement as judgement,
    opened as opened,
    refusals_of as refusals_of,
    simulation as simulation,
    tracing as tracing,
    validations_of as validations_of,
)
