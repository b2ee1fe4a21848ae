"""`reliab.follow_test`: the error of a test while it runs, message by message, and its verdict at the end."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, Unpack

from reliab.app import questions
from reliab.app.api.arguments import (
    parse_stated_values,
    parse_threshold,
    read_equipment,
    refuse_unused,
    require_known_specimen,
    require_sound,
)
from reliab.app.api.assessment import assess
from reliab.app.api.channels import Channels
from reliab.app.api.followed_test import FollowedTest, Message, WholeText
from reliab.app.declaration import Quantity, asks
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
from reliab.simulation.hybrid_test.model_file import UpdatedModel, read_model
from reliab.structures.structure import Structure

_USUAL = {"alpha": 1.0, "feedback_lag": 0.0}


@asks(questions.FollowedTest)
def follow_test(
    source: str | Path,
    *,
    say: Callable[[str], None] = lambda _sentence: None,
    **request: Unpack[questions.FollowedTest],
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
    model, structure, specimen = request["model"], request["structure"], request["specimen"]
    force_channel = None if request["force_channel"] is None else list(request["force_channel"])
    _require_clock(request["rate"], **{name: request[name] for name in ("every", "wait", "start_within")})
    path = str(source) if str(source) == "-" else str(or_shipped(Path(source), "datasets", "test.csv"))
    laboratory = Channels.from_question(request).laboratory()
    updated = None if model is None else model_of(model, request)
    frame = None
    if structure is not None:
        refuse_beside("structure", request, "f", "xi", "alpha", "model")
        frame = frame_of(structure, measured=require_known_specimen(specimen))
    of_force = _channel_of_force(specimen, request["mass"], force_channel, updated, frame)
    of_test = _collect_stated_values(request, _mode(updated, frame))
    text = WholeText("standard input" if path == "-" else Path(path).name)
    rows = rows_as_written(
        text.kept(chunks_of_text(path, request["wait"], request["start_within"], say)),
        name=text.name,
        declarations=laboratory.declarations,
        also=() if of_force is None else (Part.FORCE,),
        has_several=frame is not None and frame.has_several,
    )
    as_assessed = questions.only_those_of(questions.StatedOfTest, {**request, "force_channel": force_channel})
    watch = FollowedTest(
        text=text,
        judge=lambda file: assess(file, structure, **as_assessed),
        stated=of_test,
        laboratory=laboratory,
        model=updated,
        frame=frame,
        of_force=of_force,
        equipment=read_equipment(request["equipment"], exact=request["exact"]),
        threshold=parse_threshold(request["threshold"]),
        metric=Metric.parse(request["metric"] or Metric.RMS),
        every=request["every"],
    )
    return watch.follow(rows, laboratory.rate_hz)


def _require_clock(rate: float | None, **seconds: float) -> None:
    """Refuse a rate or a time that no test has."""
    if rate is not None:
        require_physical("sampling rate", rate, label="value of `rate`")
    for name, value in seconds.items():
        require_physical("number", value, label=f"value of `{name}`", remedy="Give it in seconds")


def model_of(model: str | Path | UpdatedModel, request: questions.Followed) -> UpdatedModel:
    """Read the model of a test that is followed, beside which its structure must not be stated again."""
    stated: Mapping[str, Any] = {**request}
    for name in ("f", "xi", "alpha", "feedback_lag"):
        if stated[name] is not None and not _is_usual(name, stated[name]):
            raise refuse_unused(
                name, "together with `model`, which states it, and whose force is fed back without delay"
            )
    return read_model(model) if isinstance(model, str | Path) else model


def _is_usual(name: str, value: Any) -> bool:  # noqa: ANN401 - of many types
    """Tell whether a value is the one that holds if nothing is stated."""
    return name in _USUAL and value in (_USUAL[name], f"{_USUAL[name]:g}")


def _channel_of_force(
    specimen: str | None,
    mass: Quantity | None,
    force_channel: Iterable[str] | None,
    model: UpdatedModel | None,
    frame: FrameUnderTest | None,
) -> ForceChannel | None:
    """Read what is stated of the force of a measured specimen; None where the specimen is not measured."""
    if require_known_specimen(specimen, beside_model=model is not None):
        if mass is None and frame is None:
            raise InputError(
                "A measured specimen needs the `mass` of the structure", remedy="State it in kilograms"
            )
        if mass is not None and frame is not None:
            raise refuse_unused("mass", "together with `structure`, which describes the test")
        return ForceChannel.parse(force_channel or ())
    for name, value in {"mass": mass, "force_channel": force_channel}.items():
        if value is not None:
            raise refuse_unused(name, "unless the `specimen` is measured")
    return None


def frame_of(structure: str | Path | FrameUnderTest, *, measured: bool = False) -> FrameUnderTest:
    """Read the frame of a test that is followed.

    `measured`: whether its specimen is learned from its force.
    """
    frame = read_structure(structure) if isinstance(structure, str | Path) else structure
    if frame.has_several:
        if measured:
            raise refuse_unused(
                "specimen", "together with a `structure` with several actuators, whose specimen is linear"
            )
        return frame
    require_linear_interface(frame, measured_specimen=measured)
    return frame


def refuse_beside(name: str, request: questions.Followed, *others: str) -> None:
    """Refuse what a frame or a model states itself."""
    stated: Mapping[str, Any] = {**request}
    for other in others:
        if stated[other] is not None and not _is_usual(other, stated[other]):
            raise refuse_unused(other, f"together with `{name}`, which describes the test")


def _mode(model: UpdatedModel | None, frame: FrameUnderTest | None) -> Structure | None:
    """Structure whose frequency, damping and share stand for those of a model or a frame."""
    if frame is not None:
        return frame.governing_mode
    return None if model is None else model.test.structure


def _collect_stated_values(request: questions.FollowedTest, mode: Structure | None) -> dict[str, StatedValue]:
    """Read what is stated of structure, sensor and feedback, which must be complete.

    `mode` stands for the structure of a model or a frame.
    """
    of_structure: dict[str, Quantity | None] = {name: request[name] for name in ("f", "xi", "alpha")}
    if mode is not None:
        of_structure = {
            "f": mode.frequency,
            "xi": mode.damping_ratio,
            "alpha": mode.experimental_fraction,
        }
    for name, what, remedy in (
        ("f", "natural frequency", "Give it in hertz"),
        ("xi", "damping ratio", "Give 0.02 for 2 %, or 0.02±0.002"),
    ):
        if of_structure[name] is None:
            raise InputError(f"A test needs `{name}`, the structure's {what}", remedy=remedy)
    lag = 0.0 if request["feedback_lag"] is None else request["feedback_lag"]
    stated = parse_stated_values(
        **of_structure, scale=request["scale"], feedback_lag=lag, mass=request["mass"]
    )
    require_sound(stated)
    return stated
