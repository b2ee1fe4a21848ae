"""The request for a sweep, the hash that identifies it in a store, and the loops that answer it."""

import hashlib
import json
from dataclasses import asdict, dataclass, field
from itertools import product

import numpy as np

from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import Dimension
from reliab.motions.motion import Motion
from reliab.simulation.effect_loop import EffectLoop
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.linear_loop.cells import LEAD_TOLERANCE, REDUCTION_TOLERANCE
from reliab.structures.structure import Structure
from reliab.sweep.grid import Grid, ScaledGrid
from reliab.tracking.indices.window import Window

MOST_STRUCTURES = 10_000
"""Largest number of structures of a sweep, which takes a minute and more for one motion."""

_MOST_BYTES = 1_000_000_000  # of the results of one motion in memory, of which each thread holds one
_BYTES_OF_CELL = 4 * 8 + 1  # of RMS^R, MTE^R, A and d, and whether it is stable


@dataclass(frozen=True, kw_only=True)
class StructureGrid:
    """Every frequency with every damping ratio and share of the stiffness, or the structure of a model.

    Raises InputError if there are too many, or the model has another structure.
    """

    frequencies: tuple[float, ...]  # Natural frequencies [Hz]
    damping_ratios: tuple[float, ...]  # Damping ratios [-]
    # Shares of the stiffness in the laboratory [-]; the whole of it by default
    experimental_fractions: tuple[float, ...] = (1.0,)
    # A model with effects of the one structure; A and d are then those of its actuator alone
    model: HybridTest | None = None

    def __post_init__(self) -> None:
        structures = self.structures
        if self.model is not None and structures != [self.model.structure]:
            raise InputError(
                "A model with effects holds for its own structure only",
                value=f"{len(structures)} structures, the first of {structures[0].frequency:g} Hz",
                remedy="Leave out the structures; the model contains its own",
            )

    @property
    def structures(self) -> list[Structure]:
        """Every structure, the share of the stiffness varying fastest, then the damping ratio."""
        number = len(self.frequencies) * len(self.damping_ratios) * len(self.experimental_fractions)
        if number > MOST_STRUCTURES:
            raise InputError(
                f"More than {MOST_STRUCTURES:,} structures: each frequency meets each damping ratio and "
                "share",
                value=f"{number:,}",
                remedy="Ask for fewer at once, and for the others afterwards",
            )
        return [
            Structure(frequency=f, damping_ratio=xi, experimental_fraction=share)
            for f, xi, share in product(self.frequencies, self.damping_ratios, self.experimental_fractions)
        ]


@dataclass(frozen=True, kw_only=True)
class SweepRequest(StructureGrid):
    """Structures, actuators and windows that are simulated for every ground motion.

    Raises InputError if frequencies, damping ratios, shares or windows are missing, repeated or not
    increasing, or the model has another structure.
    """

    # Actuators to simulate; scaled to the structures by default
    grid: Grid = field(default_factory=ScaledGrid)
    # Parts of the record over which errors are computed; the whole record by default
    windows: tuple[Window, ...] = (Window(),)
    engine: Engine = Engine.AUTOMATIC  # How the loop is solved

    def __post_init__(self) -> None:
        for name, values in (
            ("frequencies", self.frequencies),
            ("damping ratios", self.damping_ratios),
            ("shares of the stiffness", self.experimental_fractions),
        ):
            if not values or np.any(np.diff(values) <= 0.0):
                raise InputError(
                    f"A sweep needs {name} that increase", value=list(values), remedy="Give each once, sorted"
                )
        labels = [window.label for window in self.windows]
        if not labels or len(set(labels)) < len(labels):
            raise InputError(
                "A sweep needs at least one window, and each only once",
                value=labels,
                remedy="Give each window once",
            )
        super().__post_init__()
        self._require_memory()
        if self.model is not None and self.grid.leads:
            raise InputError(
                "A model with effects can be simulated for delays only",
                value="a grid with leads",
                remedy="Use a grid without leads, ScaledGrid(lead_steps=0)",
            )

    def _require_memory(self) -> None:
        structures = self.structures
        actuators = self.grid.gains(structures[0]).size * self.grid.delays(structures[0]).size
        size = _BYTES_OF_CELL * actuators * len(structures) * len(self.windows)
        if size > _MOST_BYTES:
            raise InputError(
                f"The results of one motion would take more than {_MOST_BYTES / 1e9:g} GB",
                value=f"{significant(size / 1e9)} GB for {len(structures):,} structures, "
                f"{len(self.windows)} windows and {actuators:,} actuators",
                remedy="Simulate fewer structures or windows at once, each part into a store of its own",
            )

    @property
    def structure_axes(self) -> dict[Dimension, tuple[float, ...]]:
        """Dimensions of the structures with their values; the share is one where there are several."""
        axes = {Dimension.FREQUENCY: self.frequencies, Dimension.DAMPING_RATIO: self.damping_ratios}
        has_several = len(self.experimental_fractions) > 1
        return axes | ({Dimension.SHARE: self.experimental_fractions} if has_several else {})

    def describe(self) -> dict[str, object]:
        """Everything that determines the results for a given record, as plain values."""
        coordinates = self.grid.coordinates(self.frequencies, self.damping_ratios)
        model = {} if self.model is None else {"model": _description(self.model)}
        return {
            "f": list(self.frequencies),
            "xi": list(self.damping_ratios),
            "grid": self.grid.name,
            "kp": coordinates["kp"][1].tolist(),
            "tau": coordinates["tau"][1].tolist(),
            "windows": [window.label for window in self.windows],
            **self._describe_shares(),
            "engine": str(self.engine),
            "tolerance": REDUCTION_TOLERANCE,
            "tolerance_lead": LEAD_TOLERANCE,
            **model,
        }

    def _describe_shares(self) -> dict[str, object]:
        if len(self.experimental_fractions) > 1:
            return {"experimental_fractions": list(self.experimental_fractions)}
        return {"experimental_fraction": self.experimental_fractions[0]}

    def digest(self) -> str:
        """SHA-256 of everything that determines the results for a given record, in hexadecimal."""
        return hashlib.sha256(json.dumps(self.describe(), sort_keys=True).encode()).hexdigest()


def loop_of(
    model: HybridTest | None, excitation: Excitation, structure: Structure, engine: Engine
) -> Loop | EffectLoop:
    """Return the loop of a model with effects, or the linear loop of a structure where there is none."""
    if model is None:
        return Loop(excitation=excitation, structure=structure, engine=engine)
    return EffectLoop(excitation=excitation, test=model)


def _description(model: HybridTest) -> dict[str, object]:
    """Everything of a model that determines an error of the whole test."""
    return {
        "mass": model.mass,
        "specimen": None if model.specimen is None else asdict(model.specimen),
        "effects": [{"name": str(effect.name), **asdict(effect)} for effect in model.effects],
    }


def excitation_of(motion: Motion, window: Window) -> Excitation:
    """Return the excitation that a ground motion is within a window.

    `window`: part of the record over which the error is computed. Returns the whole record, with the bounds
    of the window [s].

    >>> from reliab.motions.loading import load_motions
    >>> motion = load_motions("synthetic")[0]
    >>> excitation_of(motion, Window()).time_step == motion.time_step
    True
    """
    bounds = window.bounds(motion.acceleration, motion.time_step)
    return Excitation(acceleration=motion.acceleration, time_step=motion.time_step, window=bounds)
