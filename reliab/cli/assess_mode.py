"""`reliab assess TEST`: what was asked, checked, and the verdict on a test."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from reliab.cli.assess_answer import show_assessment
from reliab.cli.options import FIVE_PERCENT, TWO_PERCENT
from reliab.cli.output import write_json
from reliab.errors import InputError
from reliab.stated_value import StatedValue

if TYPE_CHECKING:
    from reliab.criterion import Criterion
    from reliab.loop.hybrid_test.model_file import UpdatedModel
    from reliab.motions import Motion
    from reliab.validation.assessment import Assessment, Recording

_NINETY_FIVE = 0.95
_SAME = 0.01
"""Relative difference up to which a stated structure is that of a model."""


_ONLY_FOR_TESTS = (
    *(
        "test",
        "alpha",
        "scale",
        "feedback_lag",
        "mass",
        "motion",
        "window",
        "model",
        "structure",
        "command",
        "measured",
        "time",
    ),
    *("rate", "units", "time_units", "delimiter", "report", "date", "check"),
)
_ONLY_FOR_DESIGN = ("figure",)
_QUANTITIES = ("f", "xi", "alpha", "scale", "feedback_lag", "mass")
_NEEDS = {"window": "motion", "date": "report"}


@dataclass(frozen=True, kw_only=True)
class Demand:
    """The options of `reliab assess`, by their names; see `reliab.cli.assess`."""

    test: Path | None
    f: list[StatedValue] | None
    xi: StatedValue | None
    alpha: StatedValue | None
    scale: StatedValue | None
    feedback_lag: StatedValue | None
    mass: StatedValue | None
    motion: Path | None
    window: str | None
    criterion: Path | None
    model: Path | None
    structure: Path | None
    threshold: float | None
    confidence: list[float] | None
    metric: str | None
    command: str | None
    measured: str | None
    time: str | None
    rate: float | None
    units: str | None
    time_units: str | None
    delimiter: str | None
    design: bool
    figure: Path | None
    report: Path | None
    date: datetime | None
    check: bool
    json_target: str | None

    @classmethod
    def read(cls, context: typer.Context) -> "Demand":
        """Take the options of a call, and refuse those that would not be used.

        Raises
        ------
        InputError
            If an option has no meaning beside the others.
        """
        given = [
            name
            for name in context.params
            if (source := context.get_parameter_source(name)) is not None and source.name == "COMMANDLINE"
        ]
        values = {field.name: context.params[field.name] for field in fields(cls)}
        for name in _QUANTITIES:
            values[name] = _parsed(values[name], name)
        demand = cls(**values)
        design = demand.design
        for name in given:
            if name in (_ONLY_FOR_TESTS if design else _ONLY_FOR_DESIGN):
                raise _unused(name, "beside --design" if design else "without --design")
            if name in _NEEDS and _NEEDS[name] not in given:
                raise _unused(name, f"without --{_NEEDS[name]}")
            if name in ("threshold", "confidence", "metric") and demand.criterion is not None:
                raise _unused(name, "beside --criterion, which brings its own")
        if demand.f and len(demand.f) > 1 and not design:
            raise InputError("A test has one --f", value=len(demand.f), remedy="Give several with --design")
        if demand.confidence and len(demand.confidence) > 1 and not design:
            raise InputError(
                "A test has one --confidence",
                value=demand.confidence,
                remedy="Give several with --design only",
            )
        return demand

    def read_criterion(self) -> "Criterion | None":
        """Criterion of one's own, if a file of it is given."""
        if self.criterion is None:
            return None
        from reliab.criterion import Criterion

        try:
            text = self.criterion.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(
                "The criterion's file must be readable",
                value=getattr(error, "strerror", None) or "no text",
                remedy="Write one with `reliab criterion --out`",
                where=str(self.criterion),
            ) from error
        return Criterion.from_json(text)


def _parsed(text: Any, name: str) -> Any:  # noqa: ANN401 - one text or several
    """Read what an option states; several where it may be repeated."""
    if text is None or text == []:
        return None
    if isinstance(text, str):
        return StatedValue.parse(text, f"value of --{name.replace('_', '-')}")
    return [_parsed(item, name) for item in text]


def _unused(name: str, why: str) -> InputError:
    spoken = "A test's file" if name == "test" else f"--{name.replace('_', '-')}"
    return InputError(f"{spoken} has no meaning {why}", remedy="Leave it out")


def judge_test(demand: Demand) -> bool:
    """Judge a test; write and print what is found.

    Parameters
    ----------
    demand : Demand
        What is asked.

    Returns
    -------
    bool
        Whether the test is reliable.
    """
    from reliab.indices.window import Window
    from reliab.loop.structure import Structure
    from reliab.validation.assessment import assess

    recording = read_recording_of(demand)
    model = None if demand.model is None else _read_model(demand.model)
    stated, assumed = _stated(demand, recording, model)
    assessment = assess(
        recording,
        Structure(
            frequency=stated["f"].value,
            damping_ratio=stated["xi"].value,
            experimental_fraction=stated["alpha"].value,
        ),
        stated=stated,
        motion=None if demand.motion is None else _read_motion(demand.motion),
        criterion=demand.read_criterion(),
        threshold=FIVE_PERCENT if demand.threshold is None else demand.threshold,
        confidence=demand.confidence[0] if demand.confidence else _NINETY_FIVE,
        metric=demand.metric or "rms",
        error_window=None if demand.window is None else Window.parse(demand.window),
        model=model,
        assumed=assumed,
    )
    printed = write_json(assessment.to_dict(), demand.json_target)
    if not printed:
        show_assessment(assessment)
    if demand.report is not None and demand.test is not None:
        _write_report(assessment, demand.test, demand.report, demand.date)
    return assessment.reliable


def read_recording_of(demand: Demand) -> "Recording":
    """Read the test that options name."""
    if demand.test is None:
        raise InputError(
            "A test's file is needed", value="none", remedy="Name it, or ask what is tolerable with --design"
        )
    from reliab.validation.assessment import read_recording

    return read_recording(
        demand.test,
        command=demand.command,
        measured=demand.measured,
        time=demand.time,
        rate_hz=demand.rate,
        units=demand.units,
        time_units=demand.time_units,
        delimiter=demand.delimiter,
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
        raise _unused("mass", "without columns of ground acceleration and force")
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
            "No damping ratio was stated (--xi); 0.02 was assumed. The verdict stands only if every ratio "
            "from 0.005 to 0.1 gives the same."
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


def _write_report(assessment: "Assessment", test: Path, report: Path, date: datetime | None) -> None:
    import hashlib

    from reliab.report import write_pdf
    from reliab.report.kinds.assessment import assessment_report

    provenance: dict[str, Any] = {
        "file": test.name,
        "file, SHA-256": hashlib.sha256(test.read_bytes()).hexdigest(),
    }
    write_pdf(
        assessment_report(assessment, provenance=provenance),
        report,
        date=(date or datetime.now(tz=UTC)).date(),
    )
