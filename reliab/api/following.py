"""`reliab.follow_test`: the error of a test while it runs, message by message."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from pathlib import Path
from typing import Any

import numpy as np

from reliab.api.arguments import (
    Quantity,
    known_equipment,
    require_known_specimen,
    require_positive,
    stated_filters,
    stated_values,
    unused,
)
from reliab.api.followed_errors import degrees_so_far, errors_with_intervals
from reliab.assessment import require_linear_interface
from reliab.assessment.budget import (
    Equipment,
    Size,
    sizes_of_structure,
    sizes_of_unknown,
    tolerances_of,
)
from reliab.assessment.coupled_error import CoupledMonitor
from reliab.assessment.measured_specimen import ForceChannel, MeasuredMonitor, StatedForce
from reliab.assessment.rebuilt_error import DRAWS, FALSE_ALARMS, FALSE_ERROR_ALARMS, Monitor
from reliab.errors import InputError
from reliab.recordings import (
    Part,
    Rows,
    StatedChannels,
    chunks_of_text,
    rows_about_zero,
    rows_as_written,
    rows_at_equal_steps,
    rows_without_skew,
    stated_by_options,
    step_of_rows,
)
from reliab.shipped import or_shipped
from reliab.significant import percent, significant
from reliab.simulation.frames import FrameUnderTest, governing_mode, read_structure
from reliab.simulation.hybrid_test import UpdatedModel, read_model
from reliab.stated_value import StatedValue
from reliab.structures import Partition, Structure, whole_structure
from reliab.vocabulary import Metric

AnyMonitor = Monitor | MeasuredMonitor | CoupledMonitor

_MILLISECONDS = 1e-3
_WHOLE = (1.0, "1")  # shares of the stiffness that nobody has stated
_BY_HEADER = ("alpha", "scale", "skew")  # what is taken from the file of a test, where no option states it
_GLANCE = 0.1  # s of the test between two looks at the alarms


@dataclass(frozen=True, kw_only=True, eq=False)
class Message:
    """State of a running test at one moment.

    Attributes
    ----------
    kind : {"update", "alarm", "end"}
        Why it comes: time has passed, an alarm was raised, the test has ended.
    content : dict
        The numbers, with stable keys.
    monitor : Monitor, MeasuredMonitor or CoupledMonitor
        The monitor, which goes on with the test.
    alarms : dict of str to str
        Sentences of the alarms that were raised so far, by name.
    """

    kind: str
    content: Mapping[str, Any]
    monitor: AnyMonitor
    alarms: Mapping[str, str]

    def to_dict(self) -> dict[str, Any]:
        """Plain numbers with stable keys."""
        return dict(self.content)


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
        Updates and alarms as they come; the last message is the end, whose `above_threshold` says whether the
        error of the whole test is too large.

    Raises
    ------
    InputError
        If something is not stated or not allowed, or the rows cannot be followed.

    Examples
    --------
    >>> *_, end = follow_test("sample_test", f=1, xi=0.02, wait=0.1)
    >>> end.kind, end.to_dict()["above_threshold"]
    ('end', False)
    """
    positive = {"threshold": threshold, "every": every, "wait": wait, "start_within": start_within}
    for name, number in (positive if rate is None else {**positive, "rate": rate}).items():
        if not 0.0 < number < float("inf"):
            raise InputError(f"`{name}` must be positive", value=number)
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
    rows = rows_as_written(
        chunks_of_text(path, wait, start_within, say),
        name="standard input" if path == "-" else Path(path).name,
        stated=laboratory.stated,
        also=() if of_force is None else (Part.FORCE,),
        several=frame is not None and frame.several,
    )
    watch = _Watch(
        stated=of_test,
        laboratory=laboratory,
        model=updated,
        frame=frame,
        of_force=of_force,
        equipment=known_equipment(equipment, exact=exact),
        threshold=threshold,
        metric=Metric.parse(metric),
        every=every,
    )
    return watch.follow(rows, laboratory.rate_hz)


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
        "feedback_lag": feedback_lag not in (0.0, "0"),
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
    require_positive(stated)
    return stated


@dataclass(frozen=True, kw_only=True)
class _Watch:
    """Follows rows, and says what is known."""

    stated: dict[str, StatedValue]  # By options, until the first row came
    laboratory: StatedChannels
    model: UpdatedModel | None
    frame: FrameUnderTest | None
    of_force: ForceChannel | None  # What is stated of a measured specimen's force; None without one
    equipment: Equipment | None
    threshold: float  # [-]
    metric: Metric
    every: float  # [s]
    sizes: dict[str, Size] = field(default_factory=dict)  # Of what is not known
    alarms: dict[str, str] = field(default_factory=dict)  # Sentences of those that were raised, by name

    def follow(self, rows: Iterator[Rows], rate: float | None) -> Iterator[Message]:
        """Follow the rows of a test to their end.

        `rate` [Hz].
        """
        step, rows = step_of_rows(self._with_header(rows), rate)
        if skew := self._value("skew") * _MILLISECONDS:
            rows = rows_without_skew(rows, skew / step)
        monitor = self._monitor(step)
        between, glance = (max(round(seconds / step), 1) for seconds in (self.every, _GLANCE))
        for part in rows_about_zero(rows_at_equal_steps(rows, step), step):
            begin, size = 0, part.command.shape[-1]
            while begin < size:
                to_next = min(count - monitor.samples % count for count in (between, glance))
                end = min(begin + to_next, size)
                self._feed(monitor, part, slice(begin, end))
                if monitor.samples % glance == 0 or monitor.samples % between == 0:
                    yield from self._new_alarms(monitor)
                if monitor.samples % between == 0:
                    yield self._update(monitor)
                begin = end
        yield self._end(monitor)

    def _with_header(self, rows: Iterator[Rows]) -> Iterator[Rows]:
        """Take what the file of the test states, where no option does."""
        first = list(islice(rows, 1))
        header = first[0].stated if first else {}
        of_file = self.laboratory.beside({name: header[name] for name in _BY_HEADER if name in header})
        self.stated.update({**dict.fromkeys(("alpha", "scale"), StatedValue(1.0)), **of_file, **self.stated})
        require_positive(self.stated)
        return chain(first, rows)

    def _value(self, name: str) -> float:
        """Value of what is stated; zero where it is not."""
        return self.stated[name].value if name in self.stated else 0.0

    def _monitor(self, step: float) -> AnyMonitor:
        f, xi, alpha, lag = (self.stated[name].value for name in ("f", "xi", "alpha", "feedback_lag"))
        structure = Structure(frequency=f, damping_ratio=xi, experimental_fraction=alpha)
        calibrated = self.model is not None
        self.sizes.update(
            sizes_of_unknown(self.stated, structure, self.equipment, step, calibrated=calibrated)
        )
        if self.frame is not None:
            self.sizes.update(sizes_of_structure(self.frame))
        tolerances = tolerances_of(self.sizes)
        if self._value("hysteresis"):  # which is not taken off here, nor are filters
            tolerances = replace(tolerances, lagging_hysteresis=self._value("hysteresis"))
        if filters := stated_filters(f"{name}={text}" for name, text in self.laboratory.filters.items()):
            apart = filters["measured"].delay if "measured" in filters else 0.0
            apart -= filters["command"].delay if "command" in filters else 0.0
            tolerances = replace(tolerances, filter_delay=float(np.hypot(tolerances.filter_delay, apart)))
        followed = structure if self.frame is None else self.frame.partition
        lag *= _MILLISECONDS
        if self.frame is not None and self.frame.several:
            return CoupledMonitor(
                self.frame.partition,
                step,
                to_interface=self.frame.to_interface,
                feedback_lag=lag,
                tolerances=tolerances,
                metric=self.metric,
            )
        if self.of_force is None:
            return Monitor(self.model or followed, step, feedback_lag=lag, tolerances=tolerances)
        mass = self.stated.get("mass")
        return MeasuredMonitor(
            whole_structure(followed) if mass is None else Partition.of_structure(structure, mass.value),
            step,
            StatedForce(
                mass_deviation=0.0 if mass is None else mass.deviation / mass.value,
                feedback_lag=lag,
                channel=self.of_force,
                tolerances=tolerances,
            ),
        )

    def _feed(self, monitor: AnyMonitor, rows: Rows, part: slice) -> None:
        """Feed a part of some rows, in the scale of the displacement sensor."""
        command, measured = rows.command[..., part], rows.measured[..., part] / self.stated["scale"].value
        if isinstance(monitor, MeasuredMonitor):
            if rows.force is not None:
                monitor.feed(command, measured, rows.force[part])
            return
        if self.frame is not None and self.frame.several:
            order = self.frame.order_of_channels(rows.actuators, "the test")
            command, measured = (
                self.frame.straightened(np.atleast_2d(rows_of)[order]) for rows_of in (command, measured)
            )
        monitor.feed(command, measured)

    def _new_alarms(self, monitor: AnyMonitor) -> Iterator[Message]:
        """Raise the alarms that are due, at once."""
        if monitor.gains_energy_since is not None:
            yield from self._alarm(
                "unstable",
                monitor,
                f"the loop gains energy in its mode of {significant(monitor.gaining_frequency or 0.0)} Hz "
                f"and may diverge; at most {percent(FALSE_ALARMS)} of simulated stable tests raised this "
                "alarm",
            )
        if monitor.exceeds(self.threshold, self.metric):
            yield from self._alarm(
                "error",
                monitor,
                f"the error is above twice {percent(self.threshold, decimals=2)}; "
                + (
                    f"at most {percent(FALSE_ERROR_ALARMS)} of simulated tests that end below "
                    f"that threshold raised this alarm"
                    if self.of_force is None
                    else "how often this alarm is false was not measured for learned specimens"
                ),
            )

    def _alarm(self, name: str, monitor: AnyMonitor, sentence: str) -> Iterator[Message]:
        if name not in self.alarms:
            self.alarms[name] = f"Alarm at {monitor.now.time:.2f} s: {sentence}"
            yield self._message(monitor, "alarm")

    def _update(self, monitor: AnyMonitor) -> Message:
        asked = monitor.ask() if monitor.due else None
        if asked is None or monitor.result is None:
            return self._message(monitor, "update")
        return self._message(monitor, "update", error=self._intervals(asked, monitor))

    def _end(self, monitor: AnyMonitor) -> Message:
        asked = monitor.ask(draws=DRAWS) if isinstance(monitor, Monitor) else monitor.ask(at_end=True)
        if monitor.result is None:
            return self._message(monitor, "end", above_threshold=None)
        above = monitor.result.estimate(self.metric).value > self.threshold
        return self._message(monitor, "end", error=self._intervals(asked, monitor), above_threshold=above)

    def _message(self, monitor: AnyMonitor, kind: str, **more: Any) -> Message:  # noqa: ANN401 - of JSON
        now = monitor.now
        content = {
            "kind": kind,
            "samples": now.samples,
            "time_s": now.time,
            "error_m": now.error,
            "rms": now.rms,
            "mte": now.mte,
            "net_damping_ratio": None if now.damping is None else now.damping.ratio,
            "net_damping_deviation": None if now.damping is None else now.damping.deviation,
            "near_instability": now.near_instability,
            "alarms": list(self.alarms),
            "false_alarm_rates": {
                "unstable": FALSE_ALARMS,
                "error": FALSE_ERROR_ALARMS if self.of_force is None else None,
            },
            **degrees_so_far(monitor),
            **_learning(monitor),
            **more,
        }
        return Message(kind=kind, content=content, monitor=monitor, alarms=self.alarms)

    def _intervals(self, asked: object, monitor: AnyMonitor) -> dict[str, Any]:
        return errors_with_intervals(asked, monitor, self.sizes, self.threshold, self.metric)


def _learning(monitor: AnyMonitor) -> dict[str, Any]:
    """Say whether a measured specimen is still being learned, and what it misses; nothing of others."""
    if not isinstance(monitor, MeasuredMonitor):
        return {}
    specimen = monitor.specimen
    held_out = None if specimen is None else specimen.held_out
    of_force = {"learning": monitor.now.rms is None, "held_out": held_out, "until_s": monitor.asked_at}
    return {"specimen": of_force}
