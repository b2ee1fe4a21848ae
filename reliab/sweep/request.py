"""The request for a sweep, from plain numbers or grids; the hash that identifies it in a store."""

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import ClassVar, Final, TypeVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.stated_value import Names, Numbers, as_names
from reliab.core.vocabulary import Dimension
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.simulation.effect_loop import EffectLoop
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.linear_loop.cells import LEAD_TOLERANCE, REDUCTION_TOLERANCE, Cells
from reliab.structures.structure import Structure
from reliab.tracking.boundary.contour import DELAY_SCALE, GAIN_SCALE, REACH, furthest_lead, stretch_coordinate
from reliab.tracking.indices.window import Window

_FEWEST_GAINS, _FEWEST_DELAYS = 5, 4

Axis = tuple[tuple[str, ...], Array]
"""Names of dimensions and the values over them, as xarray takes a variable."""


class Grid(ABC):
    """Gains and delays that are simulated in all combinations."""

    name: ClassVar[str]

    @abstractmethod
    def gains(self, structure: Structure) -> Array:
        """Gains k_p [-] for a structure, increasing, shape (kp,)."""

    @abstractmethod
    def delays(self, structure: Structure) -> Array:
        """Delays τ [s] for a structure, increasing, 0 among them, negative for leads, shape (tau,)."""

    @property
    @abstractmethod
    def leads(self) -> bool:
        """Whether actuators that lead are among those simulated."""

    @abstractmethod
    def coordinates(self, frequencies: Sequence[float], damping_ratios: Sequence[float]) -> dict[str, Axis]:
        """Coordinates `kp` [-] and `tau` [s] of the dataset for all structures."""

    def cells(self, structure: Structure) -> Cells:
        """All combinations before a structure, the delay varying fastest."""
        gain, delay = np.meshgrid(self.gains(structure), self.delays(structure), indexing="ij")
        return Cells(structure=structure, gain=gain.ravel(), delay=delay.ravel())


@dataclass(frozen=True, kw_only=True)
class ExplicitGrid(Grid):
    """The same gains and delays for every structure, as in the paper.

    Raises InputError if there are too few values, or they do not increase.
    """

    name: ClassVar[str] = "explicit"

    # Gains [-], increasing, with 1 among them; by default 0.98 to 1.02 by 0.001
    gain: tuple[float, ...] = tuple(round(0.98 + 0.001 * k, 3) for k in range(41))
    # Delays [s], increasing, with 0 among them and negative for leads; by default 0 to 2 ms by 0.1 ms, as in
    # the paper
    delay: tuple[float, ...] = tuple(round(1e-4 * k, 4) for k in range(21))

    def __post_init__(self) -> None:
        for name, values, fewest in (
            ("gains", self.gain, _FEWEST_GAINS),
            ("delays", self.delay, _FEWEST_DELAYS),
        ):
            if len(values) < fewest or np.any(np.diff(values) <= 0.0):
                raise InputError(
                    f"An explicit grid needs at least {fewest} {name} that increase",
                    value=list(values),
                    remedy="Give them from the smallest to the largest",
                )
        if 0.0 not in self.delay or self.delay[-1] <= 0.0 or 1.0 not in self.gain:
            raise InputError(
                "The grid lacks the perfect actuator (gain 1, delay 0)",
                value=f"gains {self.gain[0]:g} … {self.gain[-1]:g}, "
                f"delays {self.delay[0]:g} … {self.delay[-1]:g} s",
                remedy="Add the gain 1, the delay 0 and delays above it",
            )

    @property
    def leads(self) -> bool:
        """Whether actuators that lead are among those simulated."""
        return self.delay[0] < 0.0

    def gains(self, structure: Structure) -> Array:  # noqa: ARG002 - the same for all
        """Gains k_p [-] for a structure, increasing, shape (kp,)."""
        return np.array(self.gain)

    def delays(self, structure: Structure) -> Array:  # noqa: ARG002 - the same for all
        """Delays τ [s] for a structure, increasing, shape (tau,)."""
        return np.array(self.delay)

    def coordinates(
        self,
        frequencies: Sequence[float],  # noqa: ARG002 - the same for all
        damping_ratios: Sequence[float],  # noqa: ARG002 - the same for all
    ) -> dict[str, Axis]:
        """Coordinates `kp` [-] and `tau` [s] of the dataset for all structures."""
        return {
            Dimension.GAIN: ((Dimension.GAIN,), np.array(self.gain)),
            Dimension.DELAY: ((Dimension.DELAY,), np.array(self.delay)),
        }


@dataclass(frozen=True, kw_only=True)
class ScaledGrid(Grid):
    """Gains that scale with ξ and delays that scale with ξ/ω₀, as the boundaries do.

    Around the perfect actuator the spacing is fine enough for the 1 % boundary of MTE^R; outwards it
    grows in proportion, in amplitude as far as contours are traced, and in delay up to four critical delays,
    where the 20 % boundary of RMS^R lies for the most tolerant motions. Leads go as far as a boundary is
    traced, or to a quarter of the shortest period.
    """

    name: ClassVar[str] = "scaled"

    _CORE: ClassVar[float] = 0.015  # of ξ, or of ξ/ω₀: below it the spacing is even
    _LONGEST: ClassVar[float] = 7.0  # of ξ/ω₀; the critical delay is about 2

    gain_steps: int = 20  # Gains on each side of 1
    delay_steps: int = 30  # Delays above zero
    lead_steps: int = 26  # Leads; 0 leaves them out

    def __post_init__(self) -> None:
        if self.lead_steps != 0 and self.lead_steps < _FEWEST_DELAYS:
            raise InputError(
                f"A scaled grid needs at least {_FEWEST_DELAYS} leads, or none",
                value=self.lead_steps,
                remedy="Ask for more steps",
            )
        if self.gain_steps < _FEWEST_GAINS or self.delay_steps < _FEWEST_DELAYS:
            raise InputError(
                f"A scaled grid needs at least {_FEWEST_GAINS} steps of gain and {_FEWEST_DELAYS} of delay",
                value=f"{self.gain_steps} and {self.delay_steps}",
                remedy="Ask for more steps",
            )

    def gains(self, structure: Structure) -> Array:
        """Gains k_p [-] for a structure, increasing, shape (kp,)."""
        return self._gains(structure.damping_ratio)

    def delays(self, structure: Structure) -> Array:
        """Delays τ [s] for a structure, increasing, negative for leads, shape (tau,)."""
        return self._delays(structure.frequency, structure.damping_ratio)

    @property
    def leads(self) -> bool:
        """Whether actuators that lead are among those simulated."""
        return self.lead_steps > 0

    def coordinates(self, frequencies: Sequence[float], damping_ratios: Sequence[float]) -> dict[str, Axis]:
        """Coordinates `kp` [-] over (xi, kp) and `tau` [s] over (f, xi, tau)."""
        gain = np.stack([self._gains(xi) for xi in damping_ratios])
        delay = np.stack([[self._delays(f, xi) for xi in damping_ratios] for f in frequencies])
        return {
            Dimension.GAIN: ((Dimension.DAMPING_RATIO, Dimension.GAIN), gain),
            Dimension.DELAY: ((Dimension.FREQUENCY, Dimension.DAMPING_RATIO, Dimension.DELAY), delay),
        }

    def _gains(self, damping_ratio: float) -> Array:
        outwards = _space_evenly(self._CORE, GAIN_SCALE * REACH, REACH, self.gain_steps)
        return np.exp(damping_ratio * np.concatenate([-outwards[:0:-1], outwards]))

    def _delays(self, frequency: float, damping_ratio: float) -> Array:
        scale = damping_ratio / (2.0 * np.pi * frequency)
        late = _space_evenly(self._CORE, DELAY_SCALE * self._LONGEST, self._LONGEST, self.delay_steps)
        if self.lead_steps == 0:
            return scale * late
        # The loop without numerical stiffness has the shortest period of all experimental fractions.
        structure = Structure(frequency=frequency, damping_ratio=damping_ratio)
        highest_gain = np.exp(REACH * damping_ratio)
        furthest = float(furthest_lead(structure, np.array(highest_gain))) / scale
        early = _space_evenly(self._CORE, DELAY_SCALE * self._LONGEST, furthest, self.lead_steps)
        return scale * np.concatenate([-early[:0:-1], late])


@lru_cache(maxsize=64)
def _space_evenly(core: float, scale: float, furthest: float, steps: int) -> Array:
    """Values from zero, evenly spaced in the coordinate in which surfaces are interpolated."""
    dense = np.concatenate([[0.0], np.geomspace(1e-3 * core, furthest, 20_000)])
    even = np.linspace(0.0, float(stretch_coordinate(np.array(furthest), core, scale)), steps + 1)
    return np.asarray(np.interp(even, stretch_coordinate(dense, core, scale), dense), dtype=np.float64)


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
        if self.model is not None and self.grid.leads:
            raise InputError(
                "A model with effects can be simulated for delays only",
                value="a grid with leads",
                remedy="Use a grid without leads, ScaledGrid(lead_steps=0)",
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


Motions = MotionSuite | Motion | str | Path
"""Ground motions, one of them, or what `load_motions` reads."""

_Choice = TypeVar("_Choice")
_GRIDS: Final[dict[str, Grid]] = {"scaled": ScaledGrid(), "paper": ExplicitGrid()}
_GRIDS_OF_DELAYS: Final[dict[str, Grid]] = {"scaled": ScaledGrid(lead_steps=0), "paper": ExplicitGrid()}
_FREQUENCIES: Final = (1.0,)
_DAMPING_RATIOS: Final = (0.02,)
WHOLLY_EXPERIMENTAL: Final = 1.0
"""Share of the stiffness in the laboratory where none is given [-]."""


def structure_grid(
    *, f: Numbers | None, xi: Numbers | None, alpha: Numbers, model: str | Path | HybridTest | None
) -> StructureGrid:
    """Take the structures that were stated, of 1 Hz and 2 % where nothing was, or that of a model.

    `f`, `xi`: natural frequencies [Hz] and damping ratios [-]; `alpha`: experimental fraction of the
    stiffness [-]; several are put in increasing order; `model`: a hybrid test with effects, or the file of
    one. Raises InputError if a model is stated beside a structure, or has none.
    """
    frequencies, ratios = (() if values is None else as_names(values) for values in (f, xi))
    shares = tuple(sorted(as_names(alpha)))
    if model is None:
        return StructureGrid(
            frequencies=frequencies or _FREQUENCIES,
            damping_ratios=ratios or _DAMPING_RATIOS,
            experimental_fractions=shares,
        )
    if frequencies or ratios or shares != (WHOLLY_EXPERIMENTAL,):
        raise InputError(
            "The model contains its structure",
            value="f, xi or alpha beside it",
            remedy="Leave these out, or change the [structure] table of the model",
        )
    test = _test(model)
    if test.structure is None:
        raise InputError(
            "The error of a whole test needs a numerical substructure",
            remedy="Add a [structure] table to the model",
            where="" if isinstance(model, HybridTest) else str(model),
        )
    return StructureGrid(
        frequencies=(test.structure.frequency,),
        damping_ratios=(test.structure.damping_ratio,),
        experimental_fractions=(test.structure.experimental_fraction,),
        model=test,
    )


def _test(model: str | Path | HybridTest) -> HybridTest:
    if isinstance(model, HybridTest):
        return model
    from reliab.simulation.hybrid_test.model_file import read_model

    return read_model(model).test


def sweep_request(
    *,
    f: Numbers | None = None,
    xi: Numbers | None = None,
    grid: str = "scaled",
    window: Names = ("record",),
    alpha: Numbers = WHOLLY_EXPERIMENTAL,
    model: str | Path | HybridTest | None = None,
    engine: str = "automatic",
) -> SweepRequest:
    """State what is simulated for every ground motion.

    `f`, `xi`: natural frequencies [Hz] and damping ratios [-]; 1 Hz and 0.02 by default; `grid`: actuators
    that are simulated; with a model those of "scaled" are late only; `window`: part of the record over which
    errors are computed: "record", "arias" or seconds; `alpha`: share of the stiffness in the laboratory [-];
    `model`: a hybrid test with effects, or the file of one, which brings its own structure.

    >>> sweep_request(f=[2.0, 0.5]).frequencies
    (0.5, 2.0)
    """
    structures = structure_grid(f=f, xi=xi, alpha=alpha, model=model)
    return SweepRequest(
        frequencies=tuple(sorted(structures.frequencies)),
        damping_ratios=tuple(sorted(structures.damping_ratios)),
        grid=one_of(grid, _GRIDS if structures.model is None else _GRIDS_OF_DELAYS, "grid"),
        windows=tuple(Window.parse(text) for text in as_names(window)),
        experimental_fractions=structures.experimental_fractions,
        engine=one_of(engine, {choice.value: choice for choice in Engine}, "engine"),
        model=structures.model,
    )


def one_of(name: str, choices: dict[str, _Choice], description: str) -> _Choice:
    """Return the choice of a name, and refuse any other name."""
    if name not in choices:
        raise InputError(f"Unknown {description}", value=name, remedy=f"Choose among {', '.join(choices)}")
    return choices[name]


def suite_of(motions: Motions) -> MotionSuite:
    """Take a suite as it is, put a motion into one, and load what is named.

    `motions`: a suite, a motion, or a folder, file or name that `load_motions` takes.
    """
    if isinstance(motions, MotionSuite):
        return motions
    return MotionSuite.from_motions([motions]) if isinstance(motions, Motion) else load_motions(motions)
