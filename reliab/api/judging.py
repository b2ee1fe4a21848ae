"""What a test is judged by: its structure or frame, the error that is asked about, and files."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from reliab.api.arguments import require_positive, unused
from reliab.api.former import Former
from reliab.assessment import Assessment, FrameAssessment, assess_frame
from reliab.assessment.assess import assess as assess_structure
from reliab.criterion import Criterion
from reliab.errors import InputError
from reliab.motions import Motion, read_motion
from reliab.recordings import Recording
from reliab.simulation.frames import FrameUnderTest, read_frame
from reliab.simulation.hybrid_test import UpdatedModel, read_model
from reliab.stated_value import StatedValue
from reliab.structures import Structure
from reliab.vocabulary import Metric

Judge = Callable[[Recording], Assessment | FrameAssessment]
"""Judges a test."""

_OF_THE_STRUCTURE = ("f", "xi", "alpha")
_ASSUMED_DAMPING = StatedValue(0.02)
_ASSUMED = (
    "No damping ratio was stated; 0.02 was assumed. The verdict stands only if each of seven ratios from "
    "0.005 to 0.1 gives the same."
)
_SAME = 0.01
"""Relative difference up to which a stated structure is that of a model."""

_NOT_FOR_FRAMES = {
    "motion": "The index of a frame's test is that of a criterion of the frame: give it as `criterion`",
    "model": "The error of a frame's test is rebuilt for a linear specimen",
    "confidence": "The verdict rests on the test's own error; a criterion brings its confidence with it",
}


@dataclass(frozen=True, kw_only=True)
class Terms:
    """By what a test is judged; see `reliab.assess`."""

    numbers: Mapping[str, StatedValue]
    structure: Structure | FrameUnderTest | str | Path | None
    motion: str | Path | Motion | None
    criterion: str | Path | Criterion | None
    model: str | Path | UpdatedModel | None
    threshold: float | None
    confidence: float | None
    metric: str | None
    former: Former

    def judge(self) -> Judge:
        """Read what tests share, and return what judges one of them."""
        if self.criterion is not None:
            self._refuse(("threshold", "confidence", "metric"), "beside `criterion`, which brings its own")
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
                f"`{name}` has no meaning beside `structure`",
                remedy="Leave it out; the structure says what the test is of",
            )

    @property
    def _threshold(self) -> float:
        return 0.05 if self.threshold is None else float(self.threshold)

    def _own_criterion(self) -> Criterion | None:
        return Criterion.read(self.criterion) if isinstance(self.criterion, str | Path) else self.criterion

    def _judge_of_structures(self, structure: Structure | None) -> Judge:
        model = read_model(self.model) if isinstance(self.model, str | Path) else self.model
        motion = read_motion(self.motion) if isinstance(self.motion, str | Path) else self.motion
        criterion = self._own_criterion()
        numbers = {**({} if structure is None else _exactly(structure)), **self.numbers}

        def judge(recording: Recording) -> Assessment:
            stated = _stated(recording, numbers, {} if model is None else _of_model(model))
            assumed = () if "xi" in stated else (_ASSUMED,)
            complete = {
                "xi": _ASSUMED_DAMPING,
                **dict.fromkeys(("alpha", "scale"), StatedValue(1.0)),
                "feedback_lag": StatedValue(0.0),
                **stated,
            }
            former: Former = {**self.former, "stated": {**complete, **self.former.get("stated", {})}}
            return assess_structure(
                recording,
                Structure(
                    frequency=complete["f"].value,
                    damping_ratio=complete["xi"].value,
                    experimental_fraction=complete["alpha"].value,
                ),
                **former,
                motion=motion,
                criterion=criterion,
                threshold=self._threshold,
                confidence=0.95 if self.confidence is None else float(self.confidence),
                metric=str(self.metric or Metric.RMS),
                model=model,
                assumed=assumed,
            )

        return judge

    def _judge_of_frames(self, structure: FrameUnderTest | str | Path) -> Judge:
        self._refuse_beside_structure("mass")
        for name in self.former:
            raise unused(name, "beside the `structure` of a frame")
        for name, reason in _NOT_FOR_FRAMES.items():
            if getattr(self, name) is not None:
                raise InputError(
                    f"`{name}` has no meaning beside the `structure` of a frame. {reason}",
                    remedy="Leave it out",
                )
        frame = structure if isinstance(structure, FrameUnderTest) else read_frame(structure)
        criterion = self._own_criterion()

        def judge(recording: Recording) -> FrameAssessment:
            stated = {**recording.stated, **self.numbers}
            require_positive(stated)
            return assess_frame(
                recording,
                frame,
                criterion=criterion,
                threshold=self._threshold,
                metric=Metric.parse(self.metric or Metric.RMS),
                feedback_lag=stated.get("feedback_lag"),
                scale=stated.get("scale"),
            )

        return judge


def _exactly(structure: Structure) -> dict[str, StatedValue]:
    return {
        "f": StatedValue(structure.frequency),
        "xi": StatedValue(structure.damping_ratio),
        "alpha": StatedValue(structure.experimental_fraction),
    }


def _of_model(model: UpdatedModel) -> dict[str, StatedValue]:
    return {} if model.test.structure is None else _exactly(model.test.structure)


def _stated(
    recording: Recording, numbers: Mapping[str, StatedValue], of_model: Mapping[str, StatedValue]
) -> dict[str, StatedValue]:
    """Take what is stated, else what the model or the file's header states; check that they agree."""
    if "mass" in numbers and (recording.ground is None or recording.force is None):
        raise unused("mass", "without columns of ground acceleration and force")
    stated = {**recording.stated, **of_model, **numbers}
    require_positive(stated)
    if "f" not in stated:
        raise InputError(
            "The natural frequency of the structure must be stated",
            value="no `f`",
            remedy='Give it in hertz, `f=1` or `f="1±0.01"`; the verdict rests on it',
            where=recording.name,
        )
    for name, value in of_model.items():
        if abs(stated[name].value / value.value - 1.0) > _SAME:
            raise InputError(
                "The structure must be that of the model",
                value=f"{name} = {stated[name]} against {value}",
                remedy=f"Leave `{name}` out, or calibrate the model for this structure",
                where=recording.name,
            )
    return stated
