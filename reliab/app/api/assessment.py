"""`reliab.assess`: the verdict on a test, or on several."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict, Unpack, overload

from reliab.app.api.arguments import (
    LINEAR,
    Quantity,
    exactly_stated,
    known_equipment,
    require_known_specimen,
    require_sound,
    stated_by_model,
    stated_filters,
    stated_of_test,
    stated_threshold,
    stated_values,
    unused,
)
from reliab.app.api.channels import Channels, Judge, Test, assess_each, is_test, name_of_test
from reliab.assessment.assess import assess as assess_structure
from reliab.assessment.assessment import Assessment
from reliab.assessment.budget.corrections import corrected, stated_of_filters
from reliab.assessment.budget.sizes import Equipment
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import Metric
from reliab.criterion.criterion import Criterion
from reliab.signals.filters import LowPass
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.assessment.frame_assessment import CoupledAssessment, FrameAssessment
    from reliab.assessment.measured_specimen.force_channel import ForceChannel
    from reliab.assessment.several import Assessments
    from reliab.motions.motion import Motion
    from reliab.simulation.frames.frame_file import FrameUnderTest
    from reliab.simulation.hybrid_test.model_file import UpdatedModel

_ALL_TESTS = "all"
_OF_THE_STRUCTURE = ("f", "xi", "alpha")
_ASSUMED_DAMPING = StatedValue(0.02)
_ASSUMED = (
    "No damping ratio was stated; 0.02 was assumed. The test is undecided where another from 0.005 to 0.1 "
    "would change the verdict."
)

_NOT_FOR_FRAMES = {
    "model": "The error of a frame's test is rebuilt for a linear specimen",
    "confidence": (
        "The verdict follows from the test's own error; the confidence belongs to the "
        "criterion, which states its own"
    ),
}


class Stated(TypedDict, total=False):
    """Arguments of `assess` that need a name; they are declared here for the checkers of types."""

    f: Quantity | None
    xi: Quantity | None
    alpha: Quantity | None
    scale: Quantity | None
    feedback_lag: Quantity | None
    mass: Quantity | None
    skew: Quantity | None
    command_scale: Quantity | None
    hysteresis: Quantity | None
    resolution: Quantity | None
    filter: Iterable[str] | None
    equipment: str | Path | Equipment | None
    exact: bool
    motion: "str | Path | Motion | None"
    criterion: str | Path | Criterion | None
    model: "str | Path | UpdatedModel | None"
    specimen: str | None
    force_channel: Iterable[str] | None
    threshold: float | None
    confidence: float | None
    metric: str | None
    command: str | None
    measured: str | None
    time: str | None
    rate: float | None
    units: str | None
    time_units: str | None
    delimiter: str | None
    test_name: str | None
    channels: str | Path | None
    progress: Progress


@overload
def assess(  # type: ignore[overload-overlap]  # a text is one file
    test: Test, structure: Structure | None = None, **stated: Unpack[Stated]
) -> Assessment: ...
@overload
def assess(  # type: ignore[overload-overlap]
    test: Test, structure: "FrameUnderTest | str | Path", **stated: Unpack[Stated]
) -> "FrameAssessment": ...  # with several actuators a CoupledAssessment
@overload
def assess(
    test: Iterable[Test],
    structure: "Structure | FrameUnderTest | str | Path | None" = None,
    **stated: Unpack[Stated],
) -> "Assessments": ...


def assess(
    test: "Test | Iterable[Test]",
    structure: "Structure | FrameUnderTest | str | Path | None" = None,
    *,
    f: Quantity | None = None,
    xi: Quantity | None = None,
    alpha: Quantity | None = None,
    scale: Quantity | None = None,
    feedback_lag: Quantity | None = None,
    mass: Quantity | None = None,
    skew: Quantity | None = None,
    command_scale: Quantity | None = None,
    hysteresis: Quantity | None = None,
    resolution: Quantity | None = None,
    filter: Iterable[str] | None = None,  # noqa: A002 - the option's name
    equipment: str | Path | Equipment | None = None,
    exact: bool = False,
    motion: "str | Path | Motion | None" = None,
    criterion: str | Path | Criterion | None = None,
    model: "str | Path | UpdatedModel | None" = None,
    specimen: str | None = None,
    force_channel: Iterable[str] | None = None,
    threshold: float | None = None,
    confidence: float | None = None,
    metric: str | None = None,
    command: str | None = None,
    measured: str | None = None,
    time: str | None = None,
    rate: float | None = None,
    units: str | None = None,
    time_units: str | None = None,
    delimiter: str | None = None,
    test_name: str | None = None,
    channels: str | Path | None = None,
    progress: Progress = silent,
) -> "Assessment | FrameAssessment | CoupledAssessment | Assessments":
    """Judge a test, or several, by the error computed from command and measured displacement.

    Parameters
    ----------
    test : str, pathlib.Path, pandas.DataFrame or Recording, or several of them
        The test, its file, a data frame with a history in each column, or the name of one that ships
        ("sample_test").
    structure : Structure, FrameUnderTest, str or pathlib.Path, optional
        The structure under test, in place of `f`, `xi` and `alpha`; or a frame with its part in the
        laboratory, which one actuator drives or several, or the file of one.
    f, xi, alpha : float, str or StatedValue, optional
        Natural frequency [Hz], damping ratio [-] and share of the stiffness in the laboratory [-], with a
        standard deviation where they are not certain: "1±0.01". By default those of the model, or what the
        file's header states. Without a damping ratio 0.02 is assumed, and the test is undecided where the
        verdict depends on it; without a share it is 1.
    scale, feedback_lag, mass : float, str or StatedValue, optional
        Scale of the displacement sensor [-], 1 by default; time by which the force is fed back late [ms], 0
        by default; mass of the structure [kg], with which the unit of a recorded force is examined, and
        the structure is identified from it too where the ground acceleration is recorded.
    skew, command_scale, hysteresis, resolution : float, str or StatedValue, optional
        Time by which the measured displacement was recorded later than the command [ms], scale of the
        command [-], width of the loop of the displacement sensor over the span of its motion [-], and step of
        its converter [mm]. The recording is corrected for the first three.
    filter : iterable of str, optional
        Low-pass filters before the converters, "measured=200" (second order, 200 Hz) or "command=200/4".
    equipment : str, pathlib.Path or Equipment, optional
        Uncertainties that are assumed where nothing is stated, or their file; by default those of
        ordinary equipment. A number that is stated without its standard deviation is as uncertain as there.
    exact : bool, optional
        Whether everything that is stated without a standard deviation is exact, and so are all channels.
    motion : str, pathlib.Path or Motion, optional
        The test's ground motion, or its file; the index is then compared with the boundary of this motion;
        the errors of a frame's floors and storeys are then relative to their own peaks.
    criterion : str, pathlib.Path or Criterion, optional
        The criterion, or its file as `reliab criterion --out` writes it; by default the one that ships.
    model : str, pathlib.Path or UpdatedModel, optional
        Model of a nonlinear specimen, or its file as `reliab diagnose` writes it.
    specimen : {"linear", "measured"}, optional
        How the specimen is known: linear, with the share `alpha` of the stiffness, or by its recorded force
        only, from which it is learned; that needs `mass`, and f and ξ then say what the computer's part is:
        a damping 2ξωm and a stiffness (1 − α)mω², or the `structure` of a frame with one actuator, of which
        the computer's part is all but the specimen. By default it is taken as linear; where no force
        was recorded, the interval allows for yielding.
    force_channel : iterable of str, optional
        What the recorded force of a measured specimen contains besides that of the specimen, all of which
        was fed back: its lag behind the displacement "lag_ms=2±0.5", the mass between load cell and specimen
        "attached_kg=12±1", and friction in the load path "friction_n=40±20". A constant offset needs no
        statement.
    threshold, confidence : float, optional
        Error of the whole test, 0.05 by default, and share of the population's ground motions, 0.95 by
        default; a criterion states its own.
    metric : {"rms", "mte"}, optional
        Error of the whole test, RMS^R or MTE^R; a criterion states its own.
    command, measured, time : str, optional
        Names of the columns, where they are not recognised.
    rate : float, optional
        Sampling rate [Hz], where the file holds no time.
    units, time_units : str, optional
        Unit of both displacements and of the time, where the file states none.
    delimiter : str, optional
        What separates the columns of a text.
    test_name : str, optional
        Which test, where a file holds several; "all" for all of them.
    channels : str or pathlib.Path, optional
        File `channels.toml` in which a laboratory states its channels, their calibration and filters. What a
        test's own file states of skew and scale takes precedence over it, and options over both.
    progress : callable, optional
        Called after each of several tests.

    Returns
    -------
    Assessment, FrameAssessment, CoupledAssessment or Assessments
        Error of the test with its interval, verdict, index and what to improve first; of several tests those
        by file, with the reasons why some could not be judged.

    Raises
    ------
    InputError
        If a single test, or a file that several share, cannot be read or judged, the structure is stated
        twice, not at all, or not as that of the model, or an argument would have no effect.

    Examples
    --------
    >>> verdict = assess("sample_test", f=1, xi=0.02)
    >>> verdict.reliable, round(verdict.error.rebuilt.rms.value, 3)
    (True, 0.022)
    """
    of_structure = stated_values(f=f, xi=xi, alpha=alpha, mass=mass, feedback_lag=feedback_lag)
    of_channels = stated_values(
        scale=scale, command_scale=command_scale, skew=skew, hysteresis=hysteresis, resolution=resolution
    )
    judge = _Terms(
        numbers={**of_structure, **of_channels},
        filters=stated_filters(filter or ()),
        equipment=equipment,
        exact=exact,
        structure=structure,
        motion=motion,
        criterion=criterion,
        model=model,
        specimen=specimen,
        force_channel=tuple(force_channel or ()),
        threshold=threshold,
        confidence=confidence,
        metric=metric,
    ).judge()
    reading = Channels(
        command=command,
        measured=measured,
        time=time,
        rate=rate,
        units=units,
        time_units=time_units,
        delimiter=delimiter,
        test_name=test_name,
        channels=channels,
    )
    if isinstance(test, str | Path) and test_name == _ALL_TESTS:
        named = ((name, channels, test) for name, channels in reading.of_each_test(test).items())
        return assess_each(named, judge, progress)
    if is_test(test):
        return judge(reading, test)
    several = ((name_of_test(test, place), reading, test) for place, test in enumerate(test))
    return assess_each(several, judge, progress)


@dataclass(frozen=True, kw_only=True)
class _Terms:
    """What a test is judged by; see `reliab.assess`."""

    numbers: Mapping[str, StatedValue]
    filters: Mapping[str, LowPass]
    equipment: str | Path | Equipment | None
    exact: bool
    structure: "Structure | FrameUnderTest | str | Path | None"
    motion: "str | Path | Motion | None"
    criterion: str | Path | Criterion | None
    model: "str | Path | UpdatedModel | None"
    specimen: str | None
    force_channel: tuple[str, ...]
    threshold: float | None
    confidence: float | None
    metric: str | None

    def judge(self) -> Judge:
        """Read what tests share, and return what judges one of them."""
        if self.criterion is not None:
            self._refuse(
                ("threshold", "confidence", "metric"), "together with `criterion`, which states its own"
            )
        if self.structure is not None:
            for name in _OF_THE_STRUCTURE:
                self._refuse_beside_structure(name)
        if self.structure is None or isinstance(self.structure, Structure):
            return self._judge_of_structures(self.structure)
        return self._judge_of_frames(self.structure)

    def _refuse(self, names: tuple[str, ...], why: str) -> None:
        for name in names:
            if getattr(self, name) is not None:
                raise unused(name, why)

    def _refuse_beside_structure(self, name: str) -> None:
        if name in self.numbers:
            raise InputError(
                f"`{name}` has no effect together with `structure`",
                remedy="Leave it out; the structure describes the test",
            )

    def _own_criterion(self) -> Criterion | None:
        return Criterion.read(self.criterion) if isinstance(self.criterion, str | Path) else self.criterion

    def _own_model(self) -> "UpdatedModel | None":
        if not isinstance(self.model, str | Path):
            return self.model
        from reliab.simulation.hybrid_test.model_file import read_model

        return read_model(self.model)

    def _own_motion(self) -> "Motion | None":
        if not isinstance(self.motion, str | Path):
            return self.motion
        from reliab.motions.loading import read_motion

        return read_motion(self.motion)

    def _judge_of_structures(self, structure: Structure | None) -> Judge:
        model, motion, criterion = self._own_model(), self._own_motion(), self._own_criterion()
        measured = self._specimen_is_measured()
        of_force = self._channel_of_force()
        numbers = {**({} if structure is None else exactly_stated(structure)), **self.numbers}
        equipment = known_equipment(self.equipment, exact=self.exact)

        def judge(channels: Channels, test: Test) -> Assessment:
            recording = channels.read(test)
            filters = channels.filters(self.filters, recording.stated)
            of_options = numbers | stated_of_filters(filters)
            stated = stated_of_test(recording, of_options, {} if model is None else stated_by_model(model))
            assumed = () if "xi" in stated else (_ASSUMED,)
            complete = {
                "xi": _ASSUMED_DAMPING,
                **dict.fromkeys(("alpha", "scale"), StatedValue(1.0)),
                "feedback_lag": StatedValue(0.0),
                **stated,
            }
            return assess_structure(
                corrected(recording, complete, filters),
                Structure(
                    frequency=complete["f"].value,
                    damping_ratio=complete["xi"].value,
                    experimental_fraction=complete["alpha"].value,
                ),
                stated=complete,
                equipment=equipment,
                motion=motion,
                criterion=criterion,
                threshold=stated_threshold(self.threshold),
                confidence=0.95 if self.confidence is None else float(self.confidence),
                metric=str(self.metric or Metric.RMS),
                model=model,
                measured_specimen=measured,
                linear_specimen=self.specimen == LINEAR,
                force_channel=of_force,
                assumed=assumed,
            )

        return judge

    def _specimen_is_measured(self) -> bool:
        return require_known_specimen(self.specimen, beside_model=self.model is not None)

    def _channel_of_force(self) -> "ForceChannel | None":
        if self.force_channel and not self._specimen_is_measured():
            raise unused("force_channel", "unless the `specimen` is measured")
        if not self.force_channel:
            return None
        from reliab.assessment.measured_specimen.force_channel import ForceChannel

        return ForceChannel.parse(self.force_channel)

    def _refuse_beside_a_frame(self) -> None:
        for name in ("mass", "resolution"):
            self._refuse_beside_structure(name)
        for name, reason in _NOT_FOR_FRAMES.items():
            if getattr(self, name) is not None:
                raise InputError(
                    f"`{name}` has no effect together with the `structure` of a frame. {reason}",
                    remedy="Leave it out",
                )

    def _judge_of_frames(self, structure: "FrameUnderTest | str | Path") -> Judge:
        from reliab.assessment.frame_test import assess_frame, require_answerable
        from reliab.simulation.frames.frame_file import read_structure

        self._refuse_beside_a_frame()
        measured, of_force = self._specimen_is_measured(), self._channel_of_force()
        frame = read_structure(structure) if isinstance(structure, str | Path) else structure
        require_answerable(
            frame,
            criterion=self.criterion is not None,
            specimen=self.specimen is not None,
            force_channel=of_force is not None,
            measured=measured,
        )
        criterion, equipment = self._own_criterion(), known_equipment(self.equipment, exact=self.exact)
        motion = self._own_motion()

        def judge(channels: Channels, test: Test) -> "FrameAssessment | CoupledAssessment":
            recording = channels.read_several_actuators(test) if frame.several else channels.read(test)
            filters = channels.filters(self.filters, recording.stated)
            stated = {**recording.stated, **self.numbers}
            require_sound(stated)
            return assess_frame(
                corrected(recording, stated, filters),
                frame,
                criterion=criterion,
                threshold=stated_threshold(self.threshold),
                metric=Metric.parse(self.metric or Metric.RMS),
                stated={**stated, **stated_of_filters(filters)},
                equipment=equipment,
                linear_specimen=self.specimen == LINEAR,
                motion=motion,
                measured_specimen=measured,
                force_channel=of_force,
            )

        return judge
