"""A sweep asked for in plain numbers and names, as on the command line."""

from pathlib import Path
from typing import Final, TypeVar

from reliab.core.errors import InputError
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.simulation.engine import Engine
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.sweep.grid import ExplicitGrid, Grid, ScaledGrid
from reliab.sweep.request import StructureGrid, SweepRequest
from reliab.sweep.several import Names, Numbers, as_names
from reliab.tracking.indices.window import Window

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
