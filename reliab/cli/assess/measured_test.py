"""`reliab assess TEST`: the verdict on a test."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.assess.answer import show_assessment
from reliab.cli.assess.demand import Demand, unused
from reliab.cli.assess.filed_report import checksums, file_report
from reliab.cli.assess.judgement import Judge, Judgement
from reliab.cli.options import FIVE_PERCENT, TWO_PERCENT
from reliab.errors import InputError
from reliab.shipped import or_shipped
from reliab.stated_value import StatedValue

if TYPE_CHECKING:
    from reliab.criterion import Criterion
    from reliab.loop.hybrid_test.model_file import UpdatedModel
    from reliab.motions import Motion
    from reliab.validation.assessment import Assessment, Recording

_NINETY_FIVE = 0.95
_SAME = 0.01
"""Relative difference up to which a stated structure is that of a model."""


def judge_of_tests(demand: Demand) -> Judge:
    """Read what the tests share, and return what judges one of them.

    Parameters
    ----------
    demand : Demand
        What is asked.

    Returns
    -------
    callable
        Takes the file of a test and returns its `Judgement`.

    Raises
    ------
    InputError
        If a shared file cannot be read.
    """
    model = None if demand.model is None else _read_model(demand.model)
    motion = None if demand.motion is None else _read_motion(demand.motion)
    criterion = demand.own_criterion

    def judge(test: Path) -> Judgement:
        assessment = _assess(demand, demand.read_recording(test), model, motion, criterion)
        return Judgement(
            content=assessment.to_dict(),
            show=lambda: show_assessment(assessment),
            write_report=lambda: _write_report(assessment, demand, test),
        )

    return judge


def _assess(
    demand: Demand,
    recording: "Recording",
    model: "UpdatedModel | None",
    motion: "Motion | None",
    criterion: "Criterion | None",
) -> "Assessment":
    from reliab.loop.structure import Structure
    from reliab.validation.assessment import assess

    stated, assumed = _stated(demand, recording, model)
    return assess(
        recording,
        Structure(
            frequency=stated["f"].value,
            damping_ratio=stated["xi"].value,
            experimental_fraction=stated["alpha"].value,
        ),
        stated=stated,
        motion=motion,
        criterion=criterion,
        threshold=FIVE_PERCENT if demand.threshold is None else demand.threshold,
        confidence=demand.confidence[0] if demand.confidence else _NINETY_FIVE,
        metric=demand.metric or "rms",
        model=model,
        assumed=assumed,
    )


def _stated(
    demand: Demand, recording: "Recording", model: "UpdatedModel | None"
) -> tuple[Mapping[str, StatedValue], tuple[str, ...]]:
    """Take what options state, else the file's header; say what had to be assumed."""
    options = {
        "f": demand.f[0] if demand.f else None,
        "xi": demand.xi,
        "alpha": demand.alpha,
        "scale": demand.scale,
        "feedback_lag": demand.feedback_lag,
        "mass": demand.mass,
    }
    if demand.mass is not None and (recording.ground is None or recording.force is None):
        raise unused("mass", "without columns of ground acceleration and force")
    stated = {
        **recording.stated,
        **_of_model(model),
        **{name: value for name, value in options.items() if value is not None},
    }
    if "f" not in stated:
        raise InputError(
            "The natural frequency of the structure must be stated",
            value="no --f",
            remedy="Give it in hertz, --f 1 or --f 1±0.01; the verdict rests on it",
            where=recording.name,
        )
    for name, value in _of_model(model).items():
        if abs(stated[name].value / value.value - 1.0) > _SAME:
            raise InputError(
                "The structure must be that of the model",
                value=f"{name} = {stated[name]} against {value}",
                remedy=f"Leave --{name} out, or calibrate the model for this structure",
                where=recording.name,
            )
    assumed = []
    if "xi" not in stated:
        assumed.append(
            "No damping ratio was stated (--xi); 0.02 was assumed. The verdict stands only if each of seven "
            "ratios from 0.005 to 0.1 gives the same."
        )
    defaults = {"xi": StatedValue(TWO_PERCENT), "alpha": StatedValue(1.0), "scale": StatedValue(1.0)}
    return {**defaults, "feedback_lag": StatedValue(0.0), **stated}, tuple(assumed)


def _of_model(model: "UpdatedModel | None") -> dict[str, StatedValue]:
    """Take what a model states of its structure."""
    if model is None or model.test.structure is None:
        return {}
    structure = model.test.structure
    return {
        "f": StatedValue(structure.frequency),
        "xi": StatedValue(structure.damping_ratio),
        "alpha": StatedValue(structure.experimental_fraction),
    }


def _read_model(path: Path) -> "UpdatedModel":
    from reliab.loop.hybrid_test.model_file import read_model

    return read_model(path)


def _read_motion(path: Path) -> "Motion":
    from reliab.motions import read_motion

    return read_motion(path)


def _write_report(assessment: "Assessment", demand: Demand, test: Path) -> None:
    """Write the report, if it is asked for."""
    if demand.report is not None:
        from reliab.report.kinds.assessment import assessment_report

        files = checksums({"file": or_shipped(test, "datasets", "test.csv")})
        file_report(assessment_report(assessment, provenance=files), demand.report, demand.setting)
