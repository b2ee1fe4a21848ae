"""`reliab.follow_test`: the error of a test while it runs, message by message, and its verdict at the end."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Unpack

from reliab.app import questions
from reliab.app.api.arguments import (
    STRUCTURE,
    choose_equipment,
    parse_threshold,
    refuse_stated,
    refuse_unused,
    require_known_specimen,
    require_sound,
    stated_quantities,
    values_of_structure,
)
from reliab.app.api.assessment import assess
from reliab.app.api.channels import FileReading
from reliab.app.api.followed_test import FollowedTest, Message, WholeText
from reliab.app.declaration import asks
from reliab.assessment.frame_test import require_linear_interface
from reliab.assessment.measured_specimen.force_channel import ForceChannel
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.core.shipped import or_shipped
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.recordings.following import chunks_of_text, rows_as_written
from reliab.recordings.recording import Part
from reliab.simulation.frames.frame_file import FrameUnderTest, read_structure
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.structure import Structure

_DEFAULTS = {"alpha": 1.0, "feedback_lag": 0.0}


@asks(questions.MonitorQuestion)
def follow_test(
    source: str | Path,
    *,
    say: Callable[[str], None] = lambda _sentence: None,
    **request: Unpack[questions.MonitorQuestion],
) -> Iterator[Message]:
    """Follow the error of a test while its file is written.

    Parameters
    ----------
    source : str or pathlib.Path
        CSV file that is or will be written to, "-" for standard input, or "sample_test".
    say : callable, optional
        Takes a sentence while a file is awaited that does not exist yet.

    Returns
    -------
    iterator of Message
        Updates and alarms as they come; the last message is the end, with the verdict on the whole test:
        that of :func:`reliab.assess` where the test could be held.

    Raises
    ------
    InputError
        If something is not stated or not allowed, or the rows cannot be followed.

    Notes
    -----
    `f` and `xi` are needed, unless `model` or `structure` describes the test. With several actuators the
    columns are command_1, measured_1, command_2, …, messages hold each interface displacement besides the
    governing one, and the test is held whole. A measured specimen is learned from its force as
    `reliab.assess` does it, anew whenever the test has grown by a fourth; until held-out parts of the force
    are predicted to 10 %, no error is stated. What options state goes before the header of the test, and that
    before the file of `channels`, whose hysteresis and filters only widen the interval.

    Examples
    --------
    >>> *_, end = follow_test("sample_test", f=1, xi=0.02, wait=0.1)
    >>> end.kind, end.to_dict()["verdict"]
    ('end', 'reliable')
    """
    force_channel = None if request["force_channel"] is None else list(request["force_channel"])
    question: dict[str, Any] = {**request, "force_channel": force_channel}
    _require_clock(request["rate"], **{name: question[name] for name in ("every", "wait", "start_within")})
    path = str(source) if str(source) == "-" else str(or_shipped(Path(source), "datasets", "test.csv"))
    laboratory = FileReading.from_question(request).laboratory()
    model, frame = read_followed_model(question), read_followed_frame(question)
    channel = _parse_force_channel(question)
    values = _collect_stated_values(question, _find_mode(model, frame))
    text = WholeText("standard input" if path == "-" else Path(path).name)
    rows = rows_as_written(
        text.keep(chunks_of_text(path, request["wait"], request["start_within"], say)),
        name=text.name,
        declarations=laboratory.declarations,
        also=() if channel is None else (Part.FORCE,),
        has_several=frame is not None and frame.has_several,
    )
    terms = questions.select_stated(questions.AssessmentQuestion, question)
    test = FollowedTest(
        text=text,
        judge=lambda file: assess(file, request["structure"], **terms),
        values=values,
        laboratory=laboratory,
        model=model,
        frame=frame,
        force_channel=channel,
        equipment=choose_equipment(question["equipment"], exact=request["exact"]),
        threshold=parse_threshold(request["threshold"]),
        metric=Metric.parse(request["metric"] or Metric.RMS),
        message_interval=request["every"],
    )
    return test.follow(rows, laboratory.rate_hz)


def _require_clock(rate: float | None, **seconds: float) -> None:
    """Refuse a rate or a time that no test has."""
    if rate is not None:
        require_physical("sampling rate", rate, label="value of `rate`")
    for name, value in seconds.items():
        require_physical("number", value, label=f"value of `{name}`", remedy="Give it in seconds")


def read_followed_model(question: Mapping[str, Any]) -> UpdatedModel | None:
    """Read the model of a test that is followed, beside which its structure must not be stated again."""
    model: UpdatedModel | None = question["model"]
    if model is None:
        return None
    reason = "together with `model`, which states it, and whose force is fed back without delay"
    refuse_stated(question, *STRUCTURE, "feedback_lag", reason=reason, defaults=_DEFAULTS)
    return model


def read_followed_frame(question: Mapping[str, Any]) -> FrameUnderTest | None:
    """Read the frame of a test that is followed, whose specimen may be learned from its force."""
    structure = question["structure"]
    if structure is None:
        return None
    reason = "together with `structure`, which describes the test"
    refuse_stated(question, *STRUCTURE, "model", reason=reason, defaults=_DEFAULTS)
    is_measured = require_known_specimen(question["specimen"])
    frame = read_structure(structure) if isinstance(structure, str | Path) else structure
    if not frame.has_several:
        require_linear_interface(frame, measured_specimen=is_measured)
    elif is_measured:
        raise refuse_unused(
            "specimen", "together with a `structure` with several actuators, whose specimen is linear"
        )
    return frame


def _parse_force_channel(question: Mapping[str, Any]) -> ForceChannel | None:
    """Read what is stated of the force of a measured specimen; None if the specimen is not measured."""
    mass, has_frame = question["mass"], question["structure"] is not None
    if not require_known_specimen(question["specimen"], has_model=question["model"] is not None):
        refuse_stated(question, "mass", "force_channel", reason="unless the `specimen` is measured")
        return None
    if mass is None and not has_frame:
        raise InputError(
            "A measured specimen needs the `mass` of the structure", remedy="State it in kilograms"
        )
    if has_frame:
        refuse_stated(question, "mass", reason="together with `structure`, which describes the test")
    return ForceChannel.parse(question["force_channel"] or ())


def _find_mode(model: UpdatedModel | None, frame: FrameUnderTest | None) -> Structure | None:
    """Structure whose frequency, damping and share stand for those of a model or a frame."""
    if frame is not None:
        return frame.governing_mode
    return None if model is None else model.test.structure


def _collect_stated_values(question: Mapping[str, Any], mode: Structure | None) -> dict[str, StatedValue]:
    """Read what is stated of structure, sensor and feedback, which must be complete.

    `mode` stands for the structure of a model or a frame.
    """
    values = {
        "feedback_lag": StatedValue(0.0),
        **stated_quantities(question),
        **values_of_structure(mode),
    }
    for name, meaning, remedy in (
        ("f", "natural frequency", "Give it in hertz"),
        ("xi", "damping ratio", "Give 0.02 for 2 %, or 0.02±0.002"),
    ):
        if name not in values:
            raise InputError(f"A test needs `{name}`, the structure's {meaning}", remedy=remedy)
    require_sound(values)
    return values
