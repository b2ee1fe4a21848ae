"""Studies that put criteria to the test: held-out earthquakes, rigs beyond the model, the paper's cases."""

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Final

import pandas as pd

from reliab.criterion.provenance import records_checksum
from reliab.loop.structure import Structure
from reliab.motions import Motion, MotionSuite, load_motions
from reliab.report import Document
from reliab.study.description import Study
from reliab.study.kinds.kind import Kind
from reliab.study.stages import Stage
from reliab.study.steps import (
    CASES,
    CRITERIA,
    ELLIPSES,
    Material,
    Show,
    criteria_of,
    derivation,
    judgement,
    opened,
    paper_cases,
    simulation,
    tracing,
    validation_of,
)
from reliab.sweep import open_ellipses

BEYOND: Final = "beyond_the_model.csv"

_MOTIONS_BEYOND = 20
_RIG_DELAY = 0.8  # of the delay that the criterion tolerates


class ValidationStudy(Kind):
    """Whether criteria keep their promise."""

    name = "validation"

    @staticmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Derive and judge; then leave the model's comfort; then the paper's cases where they can be run."""
        held_out = _held_out(material.study)
        cases = [] if held_out is None else [paper_cases(material, held_out)]
        return (
            *simulation(material, show),
            tracing(material, show),
            derivation(material.study),
            judgement(material, show),
            _beyond(material, show),
            *cases,
        )

    @staticmethod
    def report(study: Study, folder: Path) -> Document:
        """Report containment, false-safe rate and accepted share of every scheme, and what lies beyond."""
        from reliab.report.kinds.rates import rates_table
        from reliab.report.kinds.validation import validation_report
        from reliab.validation.generalisation import tabulate

        judged = {scheme: validation_of(study, folder, scheme) for scheme in study.validation.schemes}
        return validation_report(
            title=study.title,
            rates={scheme.replace("_", " "): rates_table(found) for scheme, found in judged.items()},
            confidence=study.criterion.confidences[0],
            experimental_fraction=study.structures.experimental_fraction,
            window=study.errors.window,
            verdicts=tabulate(judged[study.validation.schemes[0]]),
            beyond=pd.read_csv(folder / BEYOND),
            cases=opened(folder / CASES) if _held_out(study) else None,
            provenance={
                **study.provenance,
                "records, SHA-256": records_checksum(open_ellipses(folder / ELLIPSES)),
            },
            purpose=study.purpose,
        )


def _held_out(study: Study) -> str | None:
    """Return the motion of the paper's cases, where there are records that may hold it."""
    return study.validation.held_out if study.motions.sources else None


def _beyond(material: Material, show: Show) -> Stage:
    """Try actuators that are no constant gain and delay."""
    study = material.study
    # Without records the rigs are tried under the suite that is built in.
    suite = material.motions if study.motions.sources else load_motions("synthetic")
    structure = Structure(frequency=study.structures.f[0], damping_ratio=study.structures.xi[0])

    def work(folder: Path) -> None:
        from reliab.validation.beyond_the_model import rigs_of_delay, try_rigs

        criterion = criteria_of(folder)[0]
        _, b = criterion.limits(structure.frequency, structure.damping_ratio)
        rigs = rigs_of_delay(_RIG_DELAY * 1e-3 * float(b) ** 0.5)
        with show("Trying other rigs") as progress:
            found = try_rigs(
                _spread(suite), [structure], rigs, criterion, count=_MOTIONS_BEYOND, progress=progress
            )
        found.to_csv(folder / BEYOND, index=False)

    inputs = {"motions": [motion.checksum for motion in _spread(suite)], "structure": repr(structure)}
    return Stage(name="beyond the model", inputs=inputs, reads=(CRITERIA,), writes=(BEYOND,), work=work)


def _spread(suite: MotionSuite) -> list[Motion]:
    """Take some of the motions, spread over the suite."""
    return list(islice(suite, 0, None, max(1, len(suite) // _MOTIONS_BEYOND)))[:_MOTIONS_BEYOND]
