"""Which motions criteria are learned from, and which they are judged on."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

from reliab.cli.ellipse_source import EllipseSource
from reliab.cli.validate.judged_motions import DEFAULT_SCHEME, REAL
from reliab.errors import InputError
from reliab.motions import load_motions
from reliab.sweep import share_of
from reliab.validation import earthquakes_among
from reliab.validation.cross_validation import Fold, folds_of, from_another, leave_structures_out, transfer


@dataclass(frozen=True, kw_only=True)
class Division:
    """A division of motions into those that are learned from and those that are judged."""

    folds: list[Fold]  # The pairs of both
    name: str  # What the division is called
    learn_from: xr.Dataset | None = None  # Ellipses of another suite that is learned from
    recognised: int = 0  # Motions whose earthquake that suite holds too

    @classmethod
    def of(
        cls,
        dataset: xr.Dataset,
        source: EllipseSource,
        *,
        scheme: str | None,
        leave_out: str | None,
        learn: list[str] | None,
        judge: list[str] | None,
    ) -> "Division":
        """Divide motions as options ask for.

        Returns by a scheme of earthquakes, by sets, or with the shipped suite to learn from.
        """
        if learn == [REAL]:
            division = _from_shipped_suite(dataset, source, judge)
        elif learn or judge:
            division = _by_sets(dataset, source, learn, judge)
        else:
            name = scheme or DEFAULT_SCHEME
            division = cls(folds=folds_of(name, dataset["event"].values), name=name)
        return division if leave_out is None else division._without(leave_out, dataset)

    def _without(self, name: str, dataset: xr.Dataset) -> "Division":
        """Leave out each frequency or damping ratio in turn, too."""
        if name not in {"f", "xi"}:
            raise InputError("What is left out is f or xi", value=name, remedy="Choose one of these")
        values = dataset[name].values.tolist()
        return Division(
            folds=list(leave_structures_out(self.folds, name, values)),
            name=f"{self.name}, each {name} left out",
            learn_from=self.learn_from,
            recognised=self.recognised,
        )


def _from_shipped_suite(dataset: xr.Dataset, source: EllipseSource, judge: list[str] | None) -> Division:
    """Learn from the shipped suite, without the earthquake of the motion that is judged."""
    if judge:
        raise InputError(
            f"--learn {REAL} judges all motions that are given",
            value=f"--judge {' '.join(judge)}",
            remedy="Leave --judge out, or choose among the motions with --sets",
        )
    shipped_suite = EllipseSource(
        ellipses=Path(REAL),
        f=dataset["f"].values.tolist(),
        xi=dataset["xi"].values.tolist(),
        threshold=source.threshold,
        metric=source.metric,
        window=str(dataset.attrs["window"]),
        alpha=[share_of(dataset)],
    )
    learn_from = shipped_suite.dataset()
    events, checksums = (dataset[name].values.tolist() for name in ("event", "checksum"))
    among = earthquakes_among(events, checksums, learn_from)
    return Division(
        folds=list(from_another(among, learn_from["event"].values)),
        name=f"learned from {REAL}",
        learn_from=learn_from,
        recognised=sum(name is not None for name in among),
    )


def _by_sets(
    dataset: xr.Dataset, source: EllipseSource, learn: list[str] | None, judge: list[str] | None
) -> Division:
    """Learn from sets of a catalogue and judge others of its sets."""
    if not (learn and judge and source.motions):
        raise InputError(
            "To judge sets by others, --motions, --learn and --judge are needed",
            value="only some of them",
            remedy=f"Give all three, for example --learn far_field --judge near_field, or --learn {REAL}",
        )
    sets = np.array(load_motions(*source.motions, sets=source.sets).set_names)
    folds = transfer(sets, dataset["event"].values, learned=learn, judged=judge)
    name = f"learned from {', '.join(learn)}, judged on {', '.join(judge)}"
    return Division(folds=list(folds), name=name)
