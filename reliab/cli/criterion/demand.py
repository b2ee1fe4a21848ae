"""The options of one call of `reliab criterion`."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.cli.ellipse_source import SourceOptions, check_thresholds
from reliab.cli.options import ONE_HERTZ, TWO_PERCENT
from reliab.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True)
class Demand(SourceOptions):
    """The options of `reliab criterion`, by their names; see `reliab.cli.criterion.options`."""

    threshold: list[float] | None
    confidence: list[float] | None
    model: Path | None
    structure: Path | None
    method: str | None
    assurance: float | None
    distribution: str | None
    joint: bool | None
    law: str
    steps: int | None
    chains: Path | None
    compare: bool
    figures: Path | None
    out: Path | None
    json_target: str | None

    def __post_init__(self) -> None:
        check_thresholds(self.threshold)
        if self.figures is not None and self.figures.exists() and not self.figures.is_dir():
            raise InputError("Figures go into a folder", value=self.figures, remedy="Name another folder")

    @property
    def has_source(self) -> bool:
        """Whether a source of ellipses is given."""
        return any((self.motions, self.results, self.ellipses))

    @property
    def settings(self) -> dict[str, object]:
        """Settings of the method by their names, None where they are not given."""
        return {"assurance": self.assurance, "distribution": self.distribution, "steps": self.steps}

    def dataset(self) -> "xr.Dataset":
        """Trace or look up the ellipses; of stored ones all, where a law is fitted to them."""
        chosen = self.law == "table" or bool(self.motions)
        source = self.ellipse_source(
            f=self.f if chosen else None,
            xi=self.xi if chosen else None,
            threshold=self.threshold,
            model=self.model,
            structure=self.structure,
        )
        dataset = source.dataset()
        full = (dataset["a"] == 0.0) & (dataset["b"] == 0.0)
        if full.any():
            motions = full.any([name for name in full.dims if name != "motion"])
            raise InputError(
                "The effects of the model must leave room for errors of the actuator",
                value=f"none under {int(motions.sum())} of {motions.size} motions, even for a perfect "
                "actuator",
                remedy="Remove or compensate the effects, or allow a larger error by --threshold",
            )
        return dataset

    def structures(self, dataset: "xr.Dataset | None") -> list[tuple[float, float]]:
        """Return the structures that are asked for, or all that the ellipses are of."""
        all_f = [ONE_HERTZ] if dataset is None else dataset["f"].values.tolist()
        all_xi = [TWO_PERCENT] if dataset is None else dataset["xi"].values.tolist()
        return [(f, xi) for f in self.f or all_f for xi in self.xi or all_xi]
