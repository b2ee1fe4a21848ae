"""What a sweep is asked for, and the hash by which a store knows it again."""

import hashlib
import json
from dataclasses import dataclass, field

import numpy as np

from reliab.errors import InputError
from reliab.indices.window import Window
from reliab.loop.engine import REDUCTION_TOLERANCE, Engine
from reliab.loop.structure import Structure
from reliab.sweep.grid import Grid, ScaledGrid


@dataclass(frozen=True, kw_only=True)
class SweepRequest:
    """Structures, actuators and windows that are simulated for every ground motion.

    Parameters
    ----------
    frequencies : tuple of float
        Natural frequencies [Hz], increasing.
    damping_ratios : tuple of float
        Damping ratios [-], increasing.
    grid : Grid, optional
        Which actuators; scaled to the structures by default.
    windows : tuple of Window, optional
        Stretches of the record over which errors are taken; the whole record by default.
    experimental_fraction : float, optional
        Share of the stiffness in the laboratory [-].
    engine : Engine, optional
        How the loop is solved.

    Raises
    ------
    InputError
        If frequencies, damping ratios or windows are missing, repeated or not increasing.
    """

    frequencies: tuple[float, ...]
    damping_ratios: tuple[float, ...]
    grid: Grid = field(default_factory=ScaledGrid)
    windows: tuple[Window, ...] = (Window(),)
    experimental_fraction: float = 1.0
    engine: Engine = Engine.AUTOMATIC

    def __post_init__(self) -> None:
        for what, values in (("frequencies", self.frequencies), ("damping ratios", self.damping_ratios)):
            if not values or np.any(np.diff(values) <= 0.0):
                raise InputError(
                    f"A sweep needs {what} that increase", value=list(values), remedy="Give each once, sorted"
                )
        labels = [window.label for window in self.windows]
        if not labels or len(set(labels)) < len(labels):
            raise InputError("A sweep needs windows, each once", value=labels, remedy="Give each window once")
        _ = self.structures

    @property
    def structures(self) -> list[Structure]:
        """Every structure, the damping ratio varying fastest."""
        return [
            Structure(frequency=f, damping_ratio=xi, experimental_fraction=self.experimental_fraction)
            for f in self.frequencies
            for xi in self.damping_ratios
        ]

    def describe(self) -> dict[str, object]:
        """Everything that determines the results for a given record, as plain values."""
        coordinates = self.grid.coordinates(self.frequencies, self.damping_ratios)
        return {
            "f": list(self.frequencies),
            "xi": list(self.damping_ratios),
            "grid": self.grid.name,
            "kp": coordinates["kp"].values.tolist(),
            "tau": coordinates["tau"].values.tolist(),
            "windows": [window.label for window in self.windows],
            "experimental_fraction": self.experimental_fraction,
            "engine": str(self.engine),
            "tolerance": REDUCTION_TOLERANCE,
        }

    def digest(self) -> str:
        """SHA-256 of everything that determines the results for a given record, in hexadecimal."""
        return hashlib.sha256(json.dumps(self.describe(), sort_keys=True).encode()).hexdigest()
