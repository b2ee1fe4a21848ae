"""Motions on which `reliab validate` judges, and where their true errors come from."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from reliab.cli.ellipse_source import EllipseSource, SourceOptions
from reliab.cli.options import FIVE_PERCENT
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr

    from reliab.validation.cross_validation import Truth

DEFAULT_SCHEME: Final = "leave_one_event_out"
"""How earthquakes are divided where nothing is said."""

REAL: Final = "real_suite"
"""The shipped results of 100 real ground motions."""

_TRIALS = 512


@dataclass(frozen=True, kw_only=True)
class JudgedMotions(SourceOptions):
    """The options of motions, structures and errors; see `reliab.cli.validate.options`."""

    threshold: float | None
    scheme: str | None
    trials: int | None
    json_target: str | None

    def __post_init__(self) -> None:
        if self.alpha is not None and len(self.alpha) > 1:
            raise InputError(
                "Criteria are judged at one share of the stiffness",
                value=f"--alpha {' '.join(f'{share:g}' for share in self.alpha)}",
                remedy="Give one, or --rebuilt-error, which compares tests of several",
            )

    @property
    def error(self) -> float:
        """Error up to which a test is good [-]."""
        return FIVE_PERCENT if self.threshold is None else self.threshold

    @property
    def tests_per_structure(self) -> int:
        """How many tests are simulated for each structure."""
        return self.trials or _TRIALS

    @property
    def source(self) -> EllipseSource:
        """Where the ellipses of the motions come from."""
        return self.ellipse_source(threshold=[self.error])

    def dataset(self) -> "xr.Dataset":
        """Trace or look up the ellipses of the motions."""
        from reliab.sweep import at_share

        dataset = at_share(self.source.dataset())
        for name, wanted in (("f", self.f), ("xi", self.xi)):
            held = dataset[name].values.tolist()
            for value in wanted or []:
                if not any(math.isclose(value, stored, rel_tol=1e-9) for stored in held):
                    raise InputError(
                        "Stored boundaries are judged at the structures that they hold",
                        value=f"--{name} {value:g}",
                        remedy=f"Choose among {', '.join(f'{stored:g}' for stored in held)}, "
                        "or give --motions",
                    )
        return dataset

    def truth(self, dataset: "xr.Dataset") -> "Truth":
        """Choose where true errors come from: the loop, stored results, or else ellipses."""
        from reliab.sweep import at_share, share_of
        from reliab.validation.cross_validation import EllipseTruth, SimulatedTruth, StoredTruth

        if self.motions is not None:
            from reliab.indices import Window as Stretch
            from reliab.motions import load_motions

            return SimulatedTruth(
                motions=list(load_motions(*self.motions, sets=self.sets)),
                window=Stretch.parse(str(dataset.attrs["window"])),
                experimental_fraction=share_of(dataset),
            )
        from reliab.sweep import open_results, stored_results

        stored = self.results or (self.ellipses if str(self.ellipses) == REAL else None)
        if stored is None:
            return EllipseTruth(dataset)
        window = str(dataset.attrs.get("window", "record"))
        structures = (dataset[name].values.tolist() for name in ("f", "xi"))
        results = open_results(stored_results(stored, *structures), window=window)
        return StoredTruth(at_share(results, share_of(dataset)))
