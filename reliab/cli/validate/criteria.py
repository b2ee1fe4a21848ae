"""`reliab validate`: criteria judged on earthquakes that they were not learned from."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from reliab.cli.options import FIVE_PERCENT
from reliab.cli.output import progress_bar, write_json
from reliab.cli.validate.answer import answer, show
from reliab.cli.validate.division import Division
from reliab.cli.validate.judged_motions import JudgedMotions
from reliab.errors import InputError

if TYPE_CHECKING:
    from reliab.criterion.laws import Law
    from reliab.validation.cross_validation import Candidate

_CONFIDENCES = (0.50, 0.60, 0.70, 0.80, 0.90, 0.95, 0.99)


@dataclass(frozen=True, kw_only=True)
class Criteria(JudgedMotions):
    """Options that choose the criteria to judge, and from which motions they are learned."""

    leave_out: str | None
    learn: list[str] | None
    judge: list[str] | None
    method: list[str] | None
    joint: bool | None
    law: list[str] | None
    confidence: list[float] | None

    def run(self) -> None:
        """Judge the criteria; write and print how often they hold."""
        from reliab.validation.cross_validation import cross_validate

        if self.scheme is not None and (self.learn is not None or self.judge is not None):
            raise InputError(
                "--scheme has no effect here: --learn and --judge divide the motions",
                value=self.scheme,
                remedy="Leave it out",
            )
        candidates = self._candidates()
        dataset = self.dataset()
        truth = self.truth(dataset)
        division = Division.of(
            dataset,
            self.source,
            scheme=self.scheme,
            leave_out=self.leave_out,
            learn=self.learn,
            judge=self.judge,
        )
        with progress_bar("Cross-validating") as progress:
            validation = cross_validate(
                dataset,
                division.folds,
                candidates,
                scheme=division.name,
                confidences=self._confidences,
                threshold=self.error,
                metric=self.metric,
                truth=truth,
                trials=self.tests_per_structure,
                learn_from=division.learn_from,
                progress=progress,
            )
        content = answer(validation, dataset, division.recognised)
        if not write_json(content, self.json_target):
            show(content)

    @property
    def _confidences(self) -> list[float]:
        """Stated shares of the motions, without repetitions."""
        return list(dict.fromkeys(self.confidence or _CONFIDENCES))

    def _candidates(self) -> "list[Candidate]":
        """Make the criteria that are judged, of every law and method that is asked for."""
        from reliab.criterion.laws import FITTED, OF_MANY_MOTIONS, known
        from reliab.criterion.methods import RECOMMENDED, method_of
        from reliab.validation.cross_validation import Derived

        has_printed = (self.error, self.metric) == (FIVE_PERCENT, "rms")
        laws = self.law or ["table", *(("guo_2017_15", "guo_2017_18") if has_printed else ())]
        candidates: list[Candidate] = []
        for name in laws:
            if name in OF_MANY_MOTIONS:
                candidates.append(self._printed(name, OF_MANY_MOTIONS[name]))
                continue
            fitted = known(FITTED, name)
            for method in self.method or [RECOMMENDED]:
                label = method if name == "table" else f"{method}, {name}"
                candidates.append(Derived(name=label, method=method_of(method), joint=self.joint, law=fitted))
        idle = "--method" if self.method else "--joint/--each" if self.joint is not None else ""
        if idle and not any(isinstance(candidate, Derived) for candidate in candidates):
            raise InputError(
                f"{idle} has no effect on laws that are printed", value=", ".join(laws), remedy="Leave it out"
            )
        return candidates

    def _printed(self, name: str, law: "Law") -> "Candidate":
        """Take a printed law, which states one confidence for one error."""
        from reliab.validation.cross_validation import Printed

        law.validity.require_error(self.error, self.metric)
        candidate = Printed(name=name, law=law)
        if self.law and not any(candidate.promises(confidence) for confidence in self._confidences):
            raise InputError(
                f"The law {name} states {candidate.confidence:.0%}",
                value=", ".join(f"{confidence:g}" for confidence in self._confidences),
                remedy=f"Ask for --confidence {candidate.confidence:g}, or leave the law out",
            )
        return candidate
