"""`reliab.follow_test`: the error of a test while it runs, message by message, and its verdict at the end."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from reliab.app.api.arguments import (
    Quantity,
    known_equipment,
    require_known_specimen,
    require_sound,
    stated_threshold,
    stated_values,
    unused,
)
from reliab.app.api.assessment import Stated, assess
from reliab.app.api.followed_test import FollowedTest, Message, WholeText
from reliab.assessment.budget.sizes import Equipment
from reliab.assessment.frame_test import require_linear_interface
from reliab.assessment.measured_specimen.force_channel import ForceChannel
from reliab.core.errors import InputError
from reliab.core.physical_range import require_physical
from reliab.core.shipped import or_shipped
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.recordings.following import chunks_of_text, rows_as_written
from reliab.recordings.reading import stated_by_options
from reliab.recordings.recording import Part
from reliab.simulation.frames.frame_file import FrameUnderTest, read_structure
from reliab.simulation.frames.governing_mode import governing_mode
from reliab.simulation.hybrid_test.model_file import UpdatedModel, read_model
from reliab.structures.structure import Structure

_NO_LAG = (0.0, "0")
_WHOLE = (1.0, "1")  # shares of the stiffness that nobody has stated


def follow_test(
    source: str | Path,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity = 1.0,
    model: str | Path | UpdatedModel | None = None,
    structure: str | Path | FrameUnderTest | None = None,
    specimen: str | None = None,
    mass: Quantity | None = None,
    force_channel: Iterable[str] | None = None,
    scale: Quantity | None = None,
    feedback_lag: Quantity = 0.0,
    equipment: str | Path | Equipment | None = None,
    exact: bool = False,
    threshold: float = 0.05,
    metric: str = "rms",
    command: str | None = None,
    measured: str | None = None,
    time: str | None = None,
    rate: float | None = None,
    units: str | None = None,
    channels: str | Path | None = None,
    every: float = 0.5,
    wait: float = 10.0,
    start_within: float = 600.0,
    say: Callable[[str], None] = lambda _sentence: None,
) -> Iterator[Message]:
    """Follow the error of a test while its file is written.

    Parameters
    ----------
    source : str or pathlib.Path
        CSV file that is or will be written to, "-" for standard input, or "sample_test".
    f, xi, alpha : float, str or StatedValue
        Natural frequency [Hz], damping ratio [-], both needed, and share of the stiffness in the laboratory
        [-], each with a standard deviation where it is not certain: "1±0.01".
    model : str, pathlib.Path or UpdatedModel, optional
        Model of the test, in place of `f`, `xi` and `alpha`, which says what a nonlinear specimen does.
    structure : str, pathlib.Path or FrameUnderTest, optional
        Frame with a linear specimen that one actuator drives or several, in place of `f`, `xi` and `alpha`;
        with the tolerances that its file states. With several actuators the columns are command_1,
        measured_1, command_2, …, messages hold each interface displacement besides the governing one, and the
        test is held whole.
    specimen : {"linear", "measured"}, optional
        How the specimen is known, linear by default; measured: learned from its recorded force as
        `reliab.assess` does it, anew whenever the test has grown by a fourth. Until held-out parts of the
        force are predicted to 10 %, no error is stated.
    mass : float, str or StatedValue, optional
        Mass of the structure [kg], which a measured specimen of one mass needs.
    force_channel : iterable of str, optional
        What the recorded force of a measured specimen contains besides that of the specimen, as for
        `reliab.assess`.
    scale, feedback_lag : float, str or StatedValue, optional
        Scale of the displacement sensor [-], by default as calibrated, else 1; time by which the force is
        fed back late [ms].
    equipment, exact
        What is not known where nothing is stated, or that nothing is, as for `reliab.assess`. Without a model
        the specimen is taken as linear.
    threshold : float, optional
        Largest error of a good test [-].
    metric : {"rms", "mte"}, optional
        Error of the whole test.
    command, measured, time : str, optional
        Names of the columns, where they are not recognised.
    rate : float, optional
        Sampling rate [Hz]; by default read from the times.
    units : str, optional
        Unit of both displacements.
    channels : str or pathlib.Path, optional
        File `channels.toml` in which a laboratory states its channels. Skew, scale and hysteresis of its
        table `calibration` are taken off as `assess` does, but hysteresis and `filters` only widen the
        interval.
        Options go before skew, scale and share in the header of the test, and these before this file.
    every : float, optional
        Time of the test between two updates [s].
    wait, start_within : float, optional
        Time without new rows after which the test counts as finished, and time within which the file must
        have its first row [s].
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

    Examples
    --------
    >>> *_, end = follow_test("sample_test", f=1, xi=0.02, wait=0.1)
    >>> end.kind, end.to_dict()["verdict"]
    ('end', 'reliable')
    """
    force_channel = None if force_channel is None else list(force_channel)
    as_assessed = _for_assess(locals())
    _require_clock(rate, every=every, wait=wait, start_within=start_within)
    columns = {Part.COMMAND: command, Part.MEASURED: measured, Part.TIME: time}
    path = str(source) if str(source) == "-" else str(or_shipped(Path(source), "datasets", "test.csv"))
    laboratory = stated_by_options(channels, columns, units, rate)
    updated = None if model is None else model_of(model, f=f, xi=xi, alpha=alpha, feedback_lag=feedback_lag)
    frame = None
    if structure is not None:
        refuse_beside("structure", f=f, xi=xi, alpha=alpha, model=model)
        frame = frame_of(structure, measured=require_known_specimen(specimen))
    of_force = _channel_of_force(specimen, mass, force_channel, updated, frame)
    mode = _mode(updated, frame)
    if mode is not None:
        f, xi, alpha = mode.frequency, mode.damping_ratio, mode.experimental_fraction
    of_test = _stated(f=f, xi=xi, alpha=alpha, scale=scale, feedback_lag=feedback_lag, mass=mass)
    if mode is None and alpha in _WHOLE:
        del of_test["alpha"]
    text = WholeText("standard input" if path == "-" else Path(path).name)
    rows = rows_as_written(
        text.kept(chunks_of_text(path, wait, start_within, say)),
        name=text.name,
        stated=laboratory.stated,
        also=() if of_force is None else (Part.FORCE,),
        several=frame is not None and frame.several,
    )
    watch = FollowedTest(
        text=text,
        judge=lambda file: assess(file, structure, **as_assessed),
        stated=of_test,
        laboratory=laboratory,
        model=updated,
        frame=frame,
        of_force=of_force,
        equipment=known_equipment(equipment, exact=exact),
        threshold=stated_threshold(threshold),
        metric=Metric.parse(metric),
        every=every,
    )
    return watch.follow(rows, laboratory.rate_hz)


def _require_clock(rate: float | None, **seconds: float) -> None:
    """Refuse a rate or a time that no test has."""
    if rate is not None:
        require_physical("sampling rate", rate, called="value of `rate`")
    for name, value in seconds.items():
        require_physical("number", value, called=f"value of `{name}`", remedy="Give it in seconds")


def _for_assess(arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Take the arguments of `assess` among those of a test that is followed, as far as they are stated."""
    unstated = {"alpha": _WHOLE, "feedback_lag": _NO_LAG}
    return {
        name: value
        for name, value in arguments.items()
        if name in Stated.__annotations__ and value is not None and value not in unstated.get(name, ())
    }


def model_of(
    model: str | Path | UpdatedModel,
    *,
    f: Quantity | None,
    xi: Quantity | None,
    alpha: Quantity,
    feedback_lag: Quantity,
) -> UpdatedModel:
    """Read the model of a test that is followed, beside which its structure must not be stated again."""
    stated = {
        "f": f is not None,
        "xi": xi is not None,
        "alpha": alpha not in _WHOLE,
        "feedback_lag": feedback_lag not in _NO_LAG,
    }
    for name, is_stated in stated.items():
        if is_stated:
            raise unused(
                name, "together with `model`, which states it, and whose force is fed back without delay"
            )
    return read_model(model) if isinstance(model, str | Path) else model


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
            raise unused("mass", "together with `structure`, which describes the test")
        return ForceChannel.parse(force_channel or ())
    for name, value in {"mass": mass, "force_channel": force_channel}.items():
        if value is not None:
            raise unused(name, "unless the `specimen` is measured")
    return None


def frame_of(structure: str | Path | FrameUnderTest, *, measured: bool = False) -> FrameUnderTest:
    """Read the frame of a test that is followed.

    `measured`: whether its specimen is learned from its force.
    """
    frame = read_structure(structure) if isinstance(structure, str | Path) else structure
    if frame.several:
        if measured:
            raise unused(
                "specimen", "together with a `structure` with several actuators, whose specimen is linear"
            )
        return frame
    require_linear_interface(frame, measured=measured)
    return frame


def refuse_beside(name: str, **others: object) -> None:
    """Refuse what a frame or a model states itself."""
    for other, value in others.items():
        if value is not None and not (other == "alpha" and value in _WHOLE):
            raise unused(other, f"together with `{name}`, which describes the test")


def _mode(model: UpdatedModel | None, frame: FrameUnderTest | None) -> Structure | None:
    """Structure whose frequency, damping and share stand for those of a model or a frame."""
    if frame is not None:
        return frame.partition.lowest_mode if frame.several else governing_mode(frame.partition)
    return None if model is None else model.test.structure


def _stated(**quantities: Quantity | None) -> dict[str, StatedValue]:
    """Read what is stated of structure, sensor and feedback, which must be complete."""
    for name, what, remedy in (
        ("f", "natural frequency", "Give it in hertz"),
        ("xi", "damping ratio", "Give 0.02 for 2 %, or 0.02±0.002"),
    ):
        if quantities[name] is None:
            raise InputError(f"A test needs `{name}`, the structure's {what}", remedy=remedy)
    stated = stated_values(**quantities)
    require_sound(stated)
    return stated
