"""`reliab.follow_test` and `export_monitor`: the error of a test while it runs, here or in the loop."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

from reliab.app import questions
from reliab.app.api.arguments import (
    STATED_BY_MODEL,
    STRUCTURE_NAMES,
    choose_equipment,
    parse_threshold,
    refuse_stated,
    refuse_unused,
    require_known_specimen,
    require_sound,
    stated_quantities,
    structure_of,
    values_of_structure,
)
from reliab.app.api.assessment import assess
from reliab.app.api.channels import FileReading, find_test
from reliab.app.api.followed_test import FollowedTest, Message, WholeText
from reliab.app.declaration import asks
from reliab.assessment.frame_test import require_linear_interface
from reliab.assessment.measured_specimen.force_channel import ForceChannel
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, written_whole
from reliab.core.plain_values import PlainResult
from reliab.core.stated_value import StatedValue, require_physical
from reliab.core.vocabulary import Metric
from reliab.in_loop.fmu import pack_fmu
from reliab.in_loop.sources import LoopMonitor, monitor_sources
from reliab.recordings.following import chunks_of_text, rows_as_written
from reliab.recordings.recording import Part
from reliab.simulation.frames.frame_file import FrameUnderTest, read_structure
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.partition import Partition
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
    question: dict[str, Any] = {**request}
    if request["rate"] is not None:
        require_physical("sampling rate", request["rate"], label="value of `rate`")
    for name in ("every", "wait", "start_within"):
        require_physical("number", question[name], label=f"value of `{name}`", remedy="Give it in seconds")
    path = str(source) if str(source) == "-" else str(find_test(source))
    laboratory = FileReading.from_question(request).laboratory()
    model, frame = read_followed_model(question), read_followed_frame(question)
    channel = _parse_force_channel(question)
    mode = None if model is None else model.test.structure
    values = _collect_stated_values(question, mode if frame is None else frame.governing_mode)
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


def read_followed_model(question: Mapping[str, Any]) -> UpdatedModel | None:
    """Read the model of a test that is followed, beside which its structure must not be stated again."""
    model: UpdatedModel | None = question["model"]
    if model is None:
        return None
    reason = "together with `model`, which states it, and whose force is fed back without delay"
    refuse_stated(question, *STATED_BY_MODEL, reason=reason, defaults=_DEFAULTS)
    return model


def read_followed_frame(question: Mapping[str, Any]) -> FrameUnderTest | None:
    """Read the frame of a test that is followed, whose specimen may be learned from its force."""
    structure = question["structure"]
    if structure is None:
        return None
    reason = "together with `structure`, which describes the test"
    refuse_stated(question, *STRUCTURE_NAMES, "model", reason=reason, defaults=_DEFAULTS)
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
    return question["force_channel"] or ForceChannel()


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


_MILLISECONDS = 1e-3
_FMUS = {"fmu": 2, "fmu3": 3}
"""Version of FMI by the kind that is asked for."""
_LONGEST_LAG = 1000.0  # ms


@dataclass(frozen=True, kw_only=True)
class WrittenMonitor(PlainResult):
    """A monitor that was written."""

    path: Path
    files: tuple[str, ...]
    degrees_of_freedom: int


@asks(questions.LoopMonitorQuestion)
def export_monitor(
    export: tuple[str, str | Path], **request: Unpack[questions.LoopMonitorQuestion]
) -> WrittenMonitor:
    """Write the running error for the loop of a test, as C or as an FMU.

    Standard deviations are not used. The alarm of the error is raised above twice the threshold. A frame must
    have a linear specimen; effects of a model whose step cannot be written in C are refused by name.

    Parameters
    ----------
    export : tuple of str and path
        "c" and a folder, or "fmu" (FMI 2.0) or "fmu3" (FMI 3.0) and a file.

    Raises
    ------
    InputError
        If something is not stated or not allowed, or nothing can be written there.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     export_monitor(("c", folder), f=1, xi=0.02, rate=1024).degrees_of_freedom
    1
    """
    kind, place = export[0], Path(export[1])
    if kind != "c" and kind not in _FMUS:
        raise InputError(
            "Unknown kind of `export`",
            value=kind,
            remedy="Name c, fmu or fmu3, and the folder or file to write",
        )
    monitor = _monitor(request)
    if kind in _FMUS:
        content = {place: pack_fmu(monitor, _FMUS[kind])}
    else:
        content = {place / name: text.encode() for name, text in monitor_sources(monitor).items()}
    _write(content)
    names = tuple(sorted(path.name for path in content))
    return WrittenMonitor(path=place, files=names, degrees_of_freedom=monitor.degrees_of_freedom)


def _monitor(request: questions.LoopMonitorQuestion) -> LoopMonitor:
    """Read what the monitor is made for."""
    rate = request["rate"]
    if rate is None:
        raise InputError("The monitor needs `rate`, the rate of the loop", remedy="Give it in hertz")
    threshold = parse_threshold(request["threshold"])
    require_physical("sampling rate", rate, label="value of `rate`")
    values = {
        "scale": StatedValue(1.0),
        "feedback_lag": StatedValue(0.0),
        **stated_quantities(request),
    }
    require_sound(values)
    lag = values["feedback_lag"].value
    if not 0.0 <= lag <= _LONGEST_LAG:
        raise InputError(
            f"`feedback_lag` must be 0 to {_LONGEST_LAG:g} ms",
            value=f"{lag:g} ms",
            remedy="State it in milliseconds",
        )
    structure, interface_matrix = _structure(request)
    return LoopMonitor(
        structure=structure,
        to_interface=interface_matrix,
        time_step=1.0 / rate,
        feedback_lag=lag * _MILLISECONDS,
        sensor_scale=values["scale"].value,
        threshold=threshold,
        metric=Metric.parse(request["metric"] or Metric.RMS),
    )


def _structure(request: questions.LoopMonitorQuestion) -> tuple[Partition | HybridTest, Array | None]:
    """Return the structure, and interface displacements per unit of each channel of several."""
    frame, question = request["structure"], {**request}
    if frame is not None and request["model"] is not None:
        raise InputError(
            "A monitor in a loop needs either a `structure` or a `model`", remedy="Leave one out"
        )
    if frame is not None:
        reason = "together with `structure`, which describes the test"
        refuse_stated(question, *STRUCTURE_NAMES, reason=reason, defaults={"alpha": 1.0})
        return _partition_of_frame(read_structure(frame), str(frame))
    if (model := read_followed_model(question)) is not None:
        return model.test, None
    for name in ("f", "xi"):
        if question[name] is None:
            raise InputError(
                f"A monitor in a loop needs `{name}`, or the `structure` of a frame, or a `model`",
                remedy="State one of them",
            )
    return Partition.from_structure(structure_of(stated_quantities(question))), None


def _partition_of_frame(frame: FrameUnderTest, source: str) -> tuple[Partition, Array | None]:
    """Return the structure of a frame with a linear specimen."""
    if frame.has_several:
        if frame.geometry is not None and not frame.channels_at_interface:
            raise InputError(
                "A monitor in a loop needs the kinematics of the actuators as a matrix",
                value="[kinematics.geometry]",
                remedy=f"Give matrix = {frame.kinematics.round(6).tolist()} if rotations are small, or take "
                'channels at the "interface"',
                where=source,
            )
        return frame.partition, frame.to_interface
    if frame.output is not None:
        raise InputError(
            "A monitor in a loop computes the error of the measured interface displacement",
            value=frame.error_of,
            remedy='Leave [error] out, or give of = "interface"',
            where=source,
        )
    if frame.partition.effects:
        raise InputError(
            "A monitor in a loop of a frame is made for a linear specimen",
            value=", ".join(effect.name for effect in frame.partition.effects),
            remedy="Leave [[specimen.effects]] out if the specimen is nearly linear",
            where=source,
        )
    return frame.partition, None


def _write(content: dict[Path, bytes]) -> None:
    for path, data in content.items():
        with refuse_unwritable("Cannot write the folder or file of a monitor", where=path):
            path.parent.mkdir(parents=True, exist_ok=True)
            with written_whole(path) as temporary:
                temporary.write_bytes(data)
