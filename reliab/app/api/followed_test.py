"""A test while it runs: its error, its alarms, and its verdict at the end, message by message."""

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from reliab.app.api.arguments import parse_filters, require_sound, structure_of
from reliab.assessment.budget.sizes import Equipment, limit_certainty, tolerances_of_structure
from reliab.assessment.inference.posterior import DRAWS
from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.measured_specimen.force_channel import ForceChannel
from reliab.assessment.monitor import MeasuredMonitor, Monitor
from reliab.assessment.plausibility import RunningSign
from reliab.assessment.rebuild import RebuiltError
from reliab.assessment.rebuilt_error.loop_energy import FALSE_ALARMS
from reliab.assessment.rebuilt_error.running_test import FALSE_ERROR_ALARMS
from reliab.assessment.rebuilt_error.spread import UNKNOWN
from reliab.assessment.verdict import Word, error_in_words, word_of_probability
from reliab.core.encodings import pieces_as_utf8
from reliab.core.files import written_whole
from reliab.core.plain_values import Keys, PlainResult, plain_value
from reliab.core.significant_digits import percent, significant
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import ERROR_NAMES, Metric
from reliab.recordings.followed_rows import (
    rows_about_zero,
    rows_at_equal_steps,
    rows_without_skew,
    step_of_rows,
)
from reliab.recordings.following import Rows
from reliab.recordings.recording import StatedChannels
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.partition import Partition, whole_structure

if TYPE_CHECKING:
    from reliab.assessment.assess import AnyAssessment


AnyMonitor = Monitor | MeasuredMonitor

_MILLISECONDS = 1e-3
_CELLS = re.compile(rb"[^\s,;]+")
_FEWEST_PERIODS = 2.0  # of the structure, from which a reversed sign is told
_ERROR_KEYS = ("rms", "mte", "governing", "degrees_of_freedom")
_NOT_KNOWN = "No error of the whole test is known."
_HEADER_VALUES = (
    "alpha",
    "scale",
    "skew",
)  # what is taken from the file of a test, where no option states it
_GLANCE = 0.1  # s of the test between two looks at the alarms


@dataclass(frozen=True, kw_only=True, eq=False)
class Message(PlainResult):
    """State of a running test at one moment."""

    keys: ClassVar[Keys] = {"**": "content"}

    kind: str  # Why it comes: time has passed, an alarm was raised, the test has ended
    content: Mapping[str, Any]  # The numbers, with stable keys
    monitor: AnyMonitor  # The monitor, which goes on with the test
    alarms: Mapping[str, str]  # Sentences of the alarms that were raised so far, by name
    # At the end, what :func:`reliab.assess` answers of the same rows; None of a test that is too long to be
    # held, or whose file was replaced
    assessment: "AnyAssessment | None" = None


class WholeText:
    """Text of a test as it came, for as long as it is that of one file and the monitor holds all of it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self._pieces: list[bytes] | None = []

    def keep(self, pieces: Iterator[bytes]) -> Iterator[bytes]:
        """Keep the pieces that pass, as UTF-8; an empty one says that another file begins."""
        for piece in pieces_as_utf8(pieces):
            if not piece:
                self.drop()
            elif self._pieces is not None:
                self._pieces.append(piece)
            yield piece

    def drop(self) -> None:
        """Keep nothing any more."""
        self._pieces = None

    def write_to(self, folder: str) -> Path | None:
        """Write the text to a file of its name, up to its last whole line; None where it was not kept."""
        if self._pieces is None:
            return None
        *lines, last = b"".join(self._pieces).split(b"\n")
        if lines and len(_CELLS.findall(last)) == len(_CELLS.findall(lines[-1])):
            lines.append(last)
        path = Path(folder) / self.name
        with written_whole(path) as file:
            file.write_bytes(b"\n".join([*lines, b""]))
        return path


@dataclass(frozen=True, kw_only=True)
class FollowedTest:
    """Follows rows, and says what is known."""

    text: WholeText
    judge: "Callable[[Path], AnyAssessment]"  # Assesses a finished test
    values: dict[str, StatedValue]  # By options, until the first row came
    laboratory: StatedChannels
    model: UpdatedModel | None
    frame: FrameUnderTest | None
    force_channel: ForceChannel | None  # What is stated of a measured specimen's force; None without one
    equipment: Equipment
    threshold: float  # [-]
    metric: Metric
    message_interval: float  # [s]
    alarms: dict[str, str] = field(default_factory=dict)  # Sentences of those that were raised, by name
    sign: RunningSign = field(default_factory=RunningSign)

    def follow(self, rows: Iterator[Rows], rate: float | None) -> Iterator[Message]:
        """Follow the rows of a test to their end.

        `rate` [Hz].
        """
        step, rows = step_of_rows(self._read_header(rows), rate)
        if skew := self._value("skew") * _MILLISECONDS:
            rows = rows_without_skew(rows, skew / step)
        monitor = self._monitor(step)
        message_interval, alarm_interval = (
            max(round(seconds / step), 1) for seconds in (self.message_interval, _GLANCE)
        )
        for part in rows_about_zero(rows_at_equal_steps(rows, step), step):
            begin, size = 0, part.command.shape[-1]
            while begin < size:
                remaining = min(
                    count - monitor.samples % count for count in (message_interval, alarm_interval)
                )
                end = min(begin + remaining, size)
                self._feed(monitor, part, slice(begin, end))
                if not monitor.is_whole:
                    self.text.drop()
                if monitor.samples % alarm_interval == 0 or monitor.samples % message_interval == 0:
                    yield from self._new_alarms(monitor)
                if monitor.samples % message_interval == 0:
                    yield self._update(monitor)
                begin = end
        yield self._end(monitor)

    def _read_header(self, rows: Iterator[Rows]) -> Iterator[Rows]:
        """Take what the file of the test states, where no option does."""
        first = list(islice(rows, 1))
        header = first[0].stated if first else {}
        file_values = self.laboratory.merge_statements(
            {name: header[name] for name in _HEADER_VALUES if name in header}
        )
        self.values.update(
            {**dict.fromkeys(("alpha", "scale"), StatedValue(1.0)), **file_values, **self.values}
        )
        require_sound(self.values)
        return chain(first, rows)

    def _value(self, name: str) -> float:
        """Value of what is stated; zero where it is not."""
        return self.values[name].value if name in self.values else 0.0

    def _monitor(self, step: float) -> AnyMonitor:
        structure, lag = structure_of(self.values), self.values["feedback_lag"].value * _MILLISECONDS
        known = self._prior_knowledge()
        assessed_structure = structure if self.frame is None else self.frame.partition
        if self.force_channel is None:
            return Monitor(
                self.model or assessed_structure,
                step,
                to_interface=None if self.frame is None else self.frame.to_interface,
                feedback_lag=lag,
                known=known,
                metric=self.metric,
            )
        mass = self.values.get("mass")
        return MeasuredMonitor(
            whole_structure(assessed_structure)
            if mass is None
            else Partition.from_structure(structure, mass.value),
            step,
            feedback_lag=lag,
            channel=self.force_channel,
            known=known,
        )

    def _prior_knowledge(self) -> PriorKnowledge:
        """Collect what is uncertain; hysteresis and filters are not taken off here."""
        stated = dict(self.values)
        tolerances = tolerances_of_structure(self.frame, calibrated=self.model is not None)
        if self._value("hysteresis"):
            tolerances["hysteresis"] = stated.pop("hysteresis").value
        filters = parse_filters(f"{name}={text}" for name, text in self.laboratory.filters.items())
        delays = {name: single.delay for name, single in filters.items()}
        difference = delays.get("measured", 0.0) - delays.get("command", 0.0)
        return PriorKnowledge(
            stated=stated,
            equipment=self.equipment,
            tolerances=tolerances,
            left_by_faults={"filter_delay": difference},
        )

    def _feed(self, monitor: AnyMonitor, rows: Rows, part: slice) -> None:
        """Feed a part of some rows, in the scale of the displacement sensor."""
        command, measured = rows.command[..., part], rows.measured[..., part] / self.values["scale"].value
        self.sign.add(command, measured)
        if isinstance(monitor, MeasuredMonitor):
            if rows.force is not None:
                monitor.feed(command, measured, rows.force[part])
            return
        if self.frame is not None and self.frame.has_several:
            order = self.frame.order_of_channels(rows.actuators, "the test")
            command, measured = (
                self.frame.straighten(np.atleast_2d(rows_of)[order]) for rows_of in (command, measured)
            )
        monitor.feed(command, measured, None if rows.ground is None else rows.ground[part])

    def _new_alarms(self, monitor: AnyMonitor) -> Iterator[Message]:
        """Raise the alarms that are due, at once; of reversed displacements none but that."""
        if self._is_reversed(monitor):
            yield from self._alarm(
                "sign",
                monitor,
                "the measured displacement has the opposite sign of the command, so that no error shown is "
                "right: reverse the sign of one channel",
            )
            return
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
                f"the error is above twice {percent(self.threshold)}; "
                + (
                    f"at most {percent(FALSE_ERROR_ALARMS)} of simulated tests that end below "
                    f"that threshold raised this alarm"
                    if self.force_channel is None
                    else "how often this alarm is false was not measured for learned specimens"
                ),
            )

    def _is_reversed(self, monitor: AnyMonitor) -> bool:
        frequency = float(monitor.structure.natural_frequencies[0])
        periods = (monitor.samples - 1) * monitor.time_step * frequency
        return monitor.moves and periods >= _FEWEST_PERIODS and self.sign.is_reversed(frequency)

    def _alarm(self, name: str, monitor: AnyMonitor, sentence: str) -> Iterator[Message]:
        if name not in self.alarms:
            self.alarms[name] = f"Alarm at {monitor.now.time:.2f} s: {sentence}"
            yield self._message(monitor, "alarm")

    def _update(self, monitor: AnyMonitor) -> Message:
        request = monitor.ask() if monitor.due and "sign" not in self.alarms else None
        if request is None or monitor.result is None:
            return self._message(monitor, "update")
        return self._message(monitor, "update", error=self._intervals(request, monitor))

    def _end(self, monitor: AnyMonitor) -> Message:
        """Judge the whole test: as it is assessed where it was kept, else by the running intervals."""
        with TemporaryDirectory() as folder:
            file = self.text.write_to(folder) if monitor.moves else None
            assessment = None if file is None else self.judge(file)
        if assessment is not None and isinstance(monitor, MeasuredMonitor):
            return self._report_assessment(monitor, assessment)
        request = monitor.ask(draws=DRAWS) if isinstance(monitor, Monitor) else monitor.ask(at_end=True)
        if assessment is not None:
            return self._report_assessment(monitor, assessment)
        if monitor.result is None:
            return self._message(monitor, "end", **self._describe_verdict(Word.UNDECIDED, [_NOT_KNOWN], []))
        error, size = self._intervals(request, monitor), monitor.result.estimate(self.metric)
        reason = error_in_words(ERROR_NAMES[self.metric], size, self.threshold, error["probability"])
        verdict = self._describe_verdict(word_of_probability(error["probability"]), [f"{reason}."], [])
        return self._message(monitor, "end", error=error, **verdict)

    def _report_assessment(self, monitor: AnyMonitor, assessment: "AnyAssessment") -> Message:
        """Tell the end of a test by its assessment."""
        content, now = assessment.to_dict(), monitor.now
        error = {
            **{key: content["error"][key] for key in _ERROR_KEYS if key in content["error"]},
            "probability": assessment.probability,
            "until_s": now.time,
            "metric": str(self.metric),
            "threshold": self.threshold,
        }
        verdict = self._describe_verdict(
            Word(content["verdict"]), content["reasons"], content["would_decide"]
        )
        specimen = assessment.error.specimen
        if specimen is not None:
            verdict["specimen"] = {
                "learning": not specimen.learned,
                "held_out": specimen.held_out,
                "until_s": now.time,
            }
            verdict |= {metric: error[metric]["value"] for metric in Metric}
            verdict["error_m"] = assessment.error.displacements[0].error[-1].item()
        return replace(self._message(monitor, "end", error=error, **verdict), assessment=assessment)

    def _describe_verdict(self, word: Word, reasons: list[str], steps: list[str]) -> dict[str, Any]:
        """Put a verdict into plain values."""
        exceeds = None if word is Word.UNDECIDED else word is Word.NOT_RELIABLE
        return {
            "verdict": str(word),
            "reliable": word is Word.RELIABLE,
            "reasons": reasons,
            "would_decide": steps,
            "above_threshold": exceeds,
        }

    def _message(self, monitor: AnyMonitor, kind: str, **additions: Any) -> Message:  # noqa: ANN401 - of JSON
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
                "error": FALSE_ERROR_ALARMS if self.force_channel is None else None,
            },
            **_values_of_monitor(monitor),
            **additions,
        }
        return Message(kind=kind, content=content, monitor=monitor, alarms=self.alarms)

    def _intervals(self, request: RebuiltError | None, monitor: AnyMonitor) -> dict[str, Any]:
        """Give intervals of the error that was asked for, of several actuators those of each displacement."""
        displacements: dict[str, Any] = {}
        assumed = request is not None and request.inferred.assumed
        if request is not None and len(request.displacements) > 1:
            governing = request.governing(self.metric)
            displacements = {
                "governing": None if governing is None else governing.name,
                "degrees_of_freedom": {
                    degree.name: {
                        "judged": degree.judged,
                        **({} if degree.judged else {"why_not": degree.refusal_reason}),
                        **self._errors(degree if degree.judged else None, assumed=assumed),
                    }
                    for degree in request.displacements
                },
            }
        return {
            **self._errors(monitor.result, assumed=assumed),
            "until_s": monitor.now.time,
            "metric": str(self.metric),
            "threshold": self.threshold,
            **displacements,
        }

    def _errors(self, error: Any, *, assumed: bool) -> dict[str, Any]:  # noqa: ANN401 - of any kind of test
        """RMS^R and MTE^R with their intervals, and the probability of staying below the threshold.

        `assumed`: whether sizes of what is uncertain are those of ordinary equipment.
        """
        if error is None:
            return {**dict.fromkeys(Metric, plain_value(UNKNOWN)), "probability": None}
        probability = limit_certainty(error.probability(self.threshold, self.metric), assumed=assumed)
        return {
            **{metric: plain_value(error.estimate(metric)) for metric in Metric},
            "probability": probability,
        }


def _values_of_monitor(monitor: AnyMonitor) -> dict[str, Any]:
    """Give errors of several displacements so far, or how far a measured specimen is learned."""
    if isinstance(monitor, Monitor) and len(monitor.displacements) > 1:
        errors = {
            name: {"error_m": now.error, "rms": now.rms, "mte": now.mte, "judged": name in monitor.judged}
            for name, now in monitor.displacements.items()
        }
        return {"governing": monitor.governing, "degrees_of_freedom": errors}
    if isinstance(monitor, MeasuredMonitor):
        held_out = None if monitor.specimen is None else monitor.specimen.held_out
        state = {
            "learning": monitor.now.rms is None,
            "held_out": held_out,
            "until_s": monitor.learning_time,
        }
        return {"specimen": state}
    return {}
