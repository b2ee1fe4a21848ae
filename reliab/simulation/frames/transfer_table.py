"""The table `[transfer_system]` of `frame.toml`: its actuators, and their geometry in a plane.

Actuator i is pinned to the body at r_i from its node and to the ground at r_i − L_i d_i, with d_i its
direction at rest. The body moves by u and turns by θ, its pin moves by w = u + (R(θ) − I)r_i, and it extends
by ::

    q_i = |L_i d_i + w| − L_i = (2 d_i·w + |w|²/L_i)/(|d_i + w/L_i| + 1)

which is d_i·w where it is long. Motions of the body follow from extensions by Newton's iteration.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Final, Self

import numpy as np
import scipy
from numpy.typing import NDArray
from pydantic import Field, model_validator

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.files import decoding, ordinary
from reliab.core.significant_digits import significant
from reliab.core.stated_value import Physical
from reliab.core.untrusted_files import resolve_within
from reliab.core.vocabulary import MILLI
from reliab.simulation.frames.tolerances_table import DescribedTable, require
from reliab.simulation.transfer_systems.matlab_structure import require_sound_structure
from reliab.simulation.transfer_systems.transfer_function import (
    ActuatorMatrix,
    ServoHydraulic,
    TransferFunction,
    TransferSystem,
    coefficients_of,
)

_STEPS = 50
_CONVERGENCE_TOLERANCE = 1e-12
_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])
MOTIONS = ("x", "y", "rotation")
"""What an interface displacement may be: of the node along x or y [m], or a turn from x to y [rad]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanarGeometry:
    """Where actuators are pinned to a body that moves in a plane.

    The two actuators of the multi-axial benchmark, when the node turns by 0.1 rad:

    >>> pins = 0.29540 * np.array([[0.90285, -0.42994], [0.90285, 0.42994]])
    >>> along = np.array([[1.0, 0.0], [1.0, 0.0]])
    >>> geometry = PlanarGeometry(motions=("x", "rotation"), pins=pins, directions=along)
    >>> (1000.0 * geometry.extensions(np.array([[0.0], [0.1]]))).round(2).T
    array([[ 11.35, -14.01]])
    """

    motions: tuple[str, ...]  # What each interface displacement is
    pins: Array  # r_i [m], shape (actuators, 2)
    directions: Array  # d_i, in which an actuator extends, made unit vectors, shape (actuators, 2)
    lengths: Array | None = None  # L_i between the pins at rest [m], shape (actuators,); long by default

    def __post_init__(self) -> None:
        number, allowed_motions = len(self.motions), set(MOTIONS)
        if not allowed_motions.issuperset(self.motions) or len(set(self.motions)) != number:
            raise InputError(
                "The motions of a body in a plane are x, y and rotation, each once",
                value=list(self.motions),
                remedy="Name each of the three once",
            )
        directions, pins = (np.array(rows, dtype=np.float64) for rows in (self.directions, self.pins))
        lengths = np.full(number, np.inf) if self.lengths is None else np.array(self.lengths, dtype=float)
        if not directions.shape == pins.shape == (number, 2) or lengths.shape != (number,):
            raise InputError(
                f"The geometry needs pin, direction and length of {number} actuators, one for each motion",
                value=f"{len(pins)} pins, {len(directions)} directions and {lengths.size} lengths",
                remedy="Give two coordinates of each pin and direction",
            )
        size = np.linalg.norm(directions, axis=1)
        if not (np.isfinite([*pins.ravel(), *size]).all() and (size > 0.0).all() and (lengths > 0.0).all()):
            raise InputError(
                "Pins must be finite, directions not zero and lengths positive",
                value=f"directions {directions.tolist()} and lengths {lengths.tolist()} m",
                remedy="Check the numbers of [kinematics.geometry]",
            )
        object.__setattr__(self, "pins", pins)
        object.__setattr__(self, "directions", directions / size[:, np.newaxis])
        object.__setattr__(self, "lengths", lengths)

    @property
    def matrix(self) -> Array:
        """Extensions per unit of each small motion, shape (actuators, motions)."""
        return np.asarray(self._extend(np.zeros((len(self.motions), 1)))[1][0])

    def extensions(self, displacements: Array) -> Array:
        """Extensions of the actuators [m] at interface displacements [m, rad], shape (p, n) both."""
        return self._extend(displacements)[0]

    def displacements(self, extensions: Array) -> Array:
        """Interface displacements [m, rad] at extensions of the actuators [m], shape (p, n) both.

        Raises InputError where no motion of the body near its rest gives them.
        """
        with suppress(np.linalg.LinAlgError), np.errstate(all="ignore"):
            estimate: Array = np.asarray(np.linalg.solve(self.matrix, extensions), dtype=np.float64)
            for _ in range(_STEPS):
                reached_extensions, slopes = self._extend(estimate)
                step = np.linalg.solve(slopes, (extensions - reached_extensions).T[..., np.newaxis])[..., 0].T
                estimate = estimate + step
                if np.abs(step).max() <= _CONVERGENCE_TOLERANCE * max(np.abs(estimate).max(), 1.0):
                    return estimate
        raise InputError(
            "The actuators cannot reach these extensions with their geometry",
            value=f"up to {significant(float(np.abs(extensions).max()))} m",
            remedy="Check pins and directions of [kinematics.geometry], and the unit of the channels",
        )

    def as_small(self, extensions: Array) -> Array:
        """Extensions that the same motions would take if they were small [m], shape (p, n)."""
        return np.asarray(self.matrix @ self.displacements(extensions))

    def _extend(self, displacements: Array) -> tuple[Array, Array]:
        """Extensions, shape (p, n), and their slopes over the motions, shape (n, p, p)."""
        motion = dict(zip(self.motions, displacements, strict=True))
        still = np.zeros(displacements.shape[1])
        angle = motion.get("rotation", still)[:, np.newaxis, np.newaxis]
        normal_pins = self.pins @ _TURN.T
        pins = np.cos(angle) * self.pins + np.sin(angle) * normal_pins  # (n, p, 2)
        shift = np.stack([motion.get("x", still), motion.get("y", still)], axis=1)[:, np.newaxis]
        w = shift + pins - self.pins
        shortness = 1.0 / np.asarray(self.lengths)[:, np.newaxis]
        axis = self.directions + shortness * w
        ratio = np.linalg.norm(axis, axis=2, keepdims=True)
        longitudinal = (self.directions * w).sum(axis=2, keepdims=True)
        extension = (2.0 * longitudinal + shortness * (w**2).sum(axis=2, keepdims=True)) / (ratio + 1.0)
        unit = axis / ratio
        rates = {
            "x": unit[..., 0],
            "y": unit[..., 1],
            "rotation": (unit * (pins @ _TURN.T)).sum(axis=2),
        }
        slopes = np.stack([rates[motion] for motion in self.motions], axis=2)
        return np.ascontiguousarray(extension[..., 0].T), slopes


_FORMS: Final = (("num", "den"), ("numerator", "denominator"), ("b", "a"))


def transfer_function_of(model: Any, delay: float = 0.0) -> TransferFunction:  # noqa: ANN401 - any library's
    """Return the transfer function of a model of SciPy or python-control.

    `delay` [s].

    >>> transfer_function_of(scipy.signal.ZerosPolesGain([], [-100.0], 100.0)).denominator
    (1.0, 100.0)
    """
    if getattr(model, "dt", None) not in {None, 0}:
        raise InputError(
            "A transfer system must be a model in continuous time",
            value=f"a model in discrete time, dt = {model.dt}",
            remedy="Convert it first, with d2c in MATLAB or python-control",
        )
    if hasattr(model, "A") and hasattr(model, "B"):
        b = np.atleast_2d(np.asarray(model.B))
        c = np.atleast_2d(np.asarray(model.C))
        if b.shape[1] != 1 or c.shape[0] != 1:
            raise InputError(
                "A transfer system has one input and one output",
                value=f"{b.shape[1]} and {c.shape[0]}",
                remedy="Give the model of one actuator",
            )
        numerator, denominator = scipy.signal.ss2tf(
            np.asarray(model.A), b, c, np.atleast_2d(np.asarray(model.D))
        )
        return TransferFunction(
            numerator=_strip_rounding(numerator[0]), denominator=coefficients_of(denominator), delay=delay
        )
    if hasattr(model, "zeros") and hasattr(model, "gain") and hasattr(model, "poles"):
        return TransferFunction.from_poles(model.zeros, model.poles, float(model.gain), delay=delay)
    if hasattr(model, "num") and hasattr(model, "den"):
        return TransferFunction(numerator=_single(model.num), denominator=_single(model.den), delay=delay)
    raise InputError(
        "A model must be one of scipy.signal or python-control",
        value=type(model).__name__,
        remedy="Give numerator and denominator, or zeros, poles and gain",
    )


def _strip_rounding(numerator: np.ndarray) -> tuple[float, ...]:
    """Coefficients of which leading ones that are rounding of zero are removed."""
    small = np.abs(numerator) <= 1e-12 * np.abs(numerator).max()
    return coefficients_of(np.where(np.cumprod(small), 0.0, numerator))


def _single(coefficients: Any) -> tuple[float, ...]:  # noqa: ANN401 - any library's
    """Coefficients of one channel, which python-control nests in two lists."""
    channel = coefficients
    while len(channel) and np.ndim(channel[0]) > 0:
        if len(channel) != 1:
            raise InputError(
                "A transfer system has one input and one output",
                value=f"{len(channel)} channels",
                remedy="Give the model of one actuator",
            )
        channel = channel[0]
    return coefficients_of(channel)


def read_matlab(path: str | Path, variable: str | None = None, delay: float = 0.0) -> TransferFunction:
    """Read an identified model from a MATLAB file.

    `delay` [s].
    """
    variables = _variables(path, variable)
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            return _build(_MatlabVariables(variables, str(path)), delay)
    except (FloatingPointError, OverflowError, np.linalg.LinAlgError) as error:
        raise InputError(
            "The numbers of this transfer system are too large",
            value=str(error),
            remedy="Check the units: 1/s",
            where=str(path),
        ) from None


def _build(variables: "_MatlabVariables", delay: float) -> TransferFunction:
    for numerator, denominator in _FORMS:
        if variables.has(numerator, denominator):
            return TransferFunction(
                numerator=coefficients_of(variables.vector(numerator)),
                denominator=coefficients_of(variables.vector(denominator)),
                delay=delay,
            )
    if variables.has("z", "p", "k"):
        zeros, poles = variables.vector("z", real=False), variables.vector("p", real=False)
        return TransferFunction.from_poles(
            zeros, poles, float(variables.matrix("k", 1, 1)[0, 0]), delay=delay
        )
    if variables.has("A", "B", "C", "D"):
        order = math.isqrt(variables.vector("A").size)
        sizes = {"A": (order, order), "B": (order, 1), "C": (1, order), "D": (1, 1)}
        matrices = [variables.matrix(name, *size) for name, size in sizes.items()]
        return transfer_function_of(scipy.signal.StateSpace(*matrices), delay)
    raise InputError(
        "A MATLAB file must hold num and den, or z, p and k, or A, B, C and D",
        value=", ".join(variables.names) or "none of them",
        remedy="Objects of toolboxes cannot be read: save [num, den] = tfdata(model, 'v') instead",
        where=variables.where,
    )


class _MatlabVariables:
    """Variables of a MATLAB file, each checked when it is taken: numbers of the size that the form needs."""

    def __init__(self, variables: Mapping[str, Any], location: str) -> None:
        self._variables, self.where = variables, location

    @property
    def names(self) -> list[str]:
        return [name for name in self._variables if not name.startswith("_")]

    def has(self, *names: str) -> bool:
        return set(names) <= set(self._variables)

    def vector(self, name: str, *, real: bool = True) -> NDArray[Any]:
        """Numbers in a row, whatever their shape was; real ones only, unless complex ones are meant."""
        values = np.asarray(self._variables[name])
        if not np.issubdtype(values.dtype, np.number):
            raise self._refuse(name, "a full matrix of numbers", "something else")
        if not np.isfinite(values).all():
            raise self._refuse(name, "finite", "numbers that are not")
        if real and np.imag(values).any():
            raise self._refuse(name, "real numbers", "complex ones")
        return np.asarray(np.real(values) if real else values).ravel()

    def matrix(self, name: str, rows: int, columns: int) -> NDArray[Any]:
        """Real numbers in a shape that MATLAB has squeezed."""
        values = self.vector(name)
        if values.size != rows * columns:
            size = f"{rows} × {columns}, for one input and one output"
            raise self._refuse(name, f"a matrix of {size}", f"{values.size} numbers")
        return values.reshape(rows, columns)

    def _refuse(self, name: str, requirement: str, value: str) -> InputError:
        return InputError(
            f"The variable {name} of a transfer system must be {requirement}",
            value=value,
            remedy="Save the model of one actuator again",
            where=self.where,
        )


def _variables(path: str | Path, variable: str | None) -> Mapping[str, Any]:
    """Variables of a MATLAB file, or the fields of one of them that is a structure."""
    rule, remedy = "A MATLAB file must be readable", "Save it in MATLAB with the option -v7"
    with decoding(rule, remedy=remedy, where=path):
        require_sound_structure(ordinary(path))
        content = scipy.io.loadmat(str(path), squeeze_me=True, struct_as_record=False)
    if variable is None:
        return dict(content)
    if variable not in content:
        names = [name for name in content if not name.startswith("__")]
        raise InputError(
            f"No variable {variable} in the file",
            remedy=f"It holds {', '.join(names) or 'nothing'}",
            where=str(path),
        )
    structure = content[variable]
    return vars(structure) if hasattr(structure, "_fieldnames") else {}


_Positive = Annotated[float, Physical("number")]
_Number = Annotated[float, Physical("number", zero=True, signed=True)]

Root = _Number | tuple[_Number, _Number]
"""A real zero or pole [1/s], or real and imaginary part of one that stands for a conjugate pair."""


class ServoHydraulicTable(DescribedTable):
    """The servo-hydraulic plant of the benchmark, with other numbers where given."""

    input_gain: _Positive = Field(
        default=ServoHydraulic.input_gain, description="Gain of the command’s way to the valve"
    )
    valve_gain: _Positive = Field(
        default=ServoHydraulic.valve_gain, description="Gain of the valve [N/(m·s³)]"
    )
    piston_coupling_n_per_m: _Positive = Field(
        default=ServoHydraulic.piston_coupling, description="Coupling of the piston"
    )
    leakage_per_s: _Positive = Field(default=ServoHydraulic.leakage, description="Leakage past the piston")
    valve_damping_per_s: _Positive = Field(
        default=ServoHydraulic.valve_damping, description="Damping of the valve"
    )
    valve_stiffness_per_s2: _Positive = Field(
        default=ServoHydraulic.valve_stiffness, description="Stiffness of the valve"
    )

    @property
    def plant(self) -> ServoHydraulic:
        """The actuator."""
        return ServoHydraulic(
            input_gain=self.input_gain,
            valve_gain=self.valve_gain,
            piston_coupling=self.piston_coupling_n_per_m,
            leakage=self.leakage_per_s,
            valve_damping=self.valve_damping_per_s,
            valve_stiffness=self.valve_stiffness_per_s2,
        )


class TransferTable(DescribedTable):
    """The actuators with their inner control: one, in one of its ways with a pure delay beside it, or all."""

    gain: Annotated[float, Physical("actuator's gain")] | None = Field(
        default=None, description="Static gain, alone or with `poles_per_s`"
    )
    numerator: tuple[_Number, ...] | None = Field(
        default=None, description="Coefficients of the numerator, in descending powers of s"
    )
    denominator: tuple[_Number, ...] | None = Field(
        default=None, description="Coefficients of the denominator, likewise"
    )
    zeros_per_s: tuple[Root, ...] = Field(default=(), description="Zeros, as `poles_per_s`")
    poles_per_s: tuple[Root, ...] | None = Field(
        default=None, description="Poles; [real, imaginary] stands for a conjugate pair"
    )
    file: str | None = Field(
        default=None,
        description="MATLAB file in the folder of this file, with num and den, z, p and k, or A, B, C and D",
    )
    variable: str | None = Field(default=None, description="Structure in that file which holds them")
    servo_hydraulic: ServoHydraulicTable | None = Field(default=None, description="Plant of the benchmark")
    matrix: tuple[tuple["TransferTable | _Number", ...], ...] | None = Field(
        default=None,
        description="Transfer functions of several actuators, coupled: row i and column j is what the "
        "command of actuator j moves actuator i by; 0 where they are not coupled. Any other way is that of "
        "each actuator",
    )
    delay_ms: Annotated[float, Physical("time", zero=True)] = Field(
        default=0.0, description="Pure delay in addition to each of these"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        require(
            (self.numerator is None) == (self.denominator is None),
            "numerator and denominator belong together",
        )
        ways = self.denominator, self.poles_per_s, self.file, self.servo_hydraulic, self.matrix
        count = sum(way is not None for way in ways)
        require(
            count == 1 or (count == 0 and (self.gain is not None or bool(self.delay_ms))),
            "give numerator and denominator, or poles_per_s, file, servo_hydraulic, matrix, or gain and "
            "delay_ms",
        )
        has_poles = self.poles_per_s is not None
        require(self.gain is None or has_poles or count == 0, "gain needs poles_per_s or delay_ms")
        require(not self.zeros_per_s or has_poles, "zeros_per_s needs poles_per_s")
        require(self.variable is None or self.file is not None, "variable needs file")
        require(not self.delay_ms or self.servo_hydraulic is None, "servo_hydraulic takes no delay_ms")
        require(
            not self.delay_ms or self.matrix is None,
            "a matrix takes no delay_ms apart from those of its entries",
        )
        return self

    def system(self, folder: Path) -> TransferSystem:
        """Transfer system of one actuator; a file is looked for in the folder of the description."""
        delay = self.delay_ms / MILLI
        gain = 1.0 if self.gain is None else self.gain
        if self.servo_hydraulic is not None:
            return self.servo_hydraulic.plant
        if self.file is not None:
            if Path(self.file).suffix.lower() != ".mat":
                raise InputError(
                    "A transfer system is read from a MATLAB file",
                    value=self.file,
                    remedy="Save num and den with scipy.io.savemat, or give numerator and denominator here",
                )
            return read_matlab(resolve_within(folder, self.file, where=""), self.variable, delay)
        if self.poles_per_s is not None:
            zeros, poles = _roots(self.zeros_per_s), _roots(self.poles_per_s)
            return TransferFunction.from_poles(zeros, poles, gain, static=True, delay=delay)
        numerator, denominator = self.numerator or (gain,), self.denominator or (1.0,)
        return TransferFunction(numerator=numerator, denominator=denominator, delay=delay)


def _roots(entries: tuple[Root, ...]) -> list[complex]:
    """All zeros or poles, both of each pair."""
    roots: list[complex] = []
    for root in entries:
        if isinstance(root, tuple):
            roots += [complex(*root), complex(root[0], -root[1])] if root[1] else [complex(root[0])]
        else:
            roots.append(complex(root))
    return roots


def rig_of_table(
    table: TransferTable | None, kinematics: Array | None, folder: Path
) -> TransferSystem | ActuatorMatrix | None:
    """Rig of several actuators with their kinematics, or of one without; None where none is described."""
    if table is None:
        return None
    if kinematics is None and table.matrix is None:
        return table.system(folder)
    matrix = np.eye(1) if kinematics is None else kinematics
    if table.matrix is None:
        actuator, size = _entry(table, folder), len(matrix)
        rows = tuple(tuple(actuator if i == j else None for j in range(size)) for i in range(size))
    else:
        rows = tuple(tuple(_entry(entry, folder) for entry in row) for row in table.matrix)
    return ActuatorMatrix(kinematics=matrix, transfer=rows)


def _entry(entry: TransferTable | float, folder: Path) -> TransferFunction | None:
    if isinstance(entry, TransferTable):
        system = entry.system(folder)
        if not isinstance(system, TransferFunction):
            raise InputError(
                "An entry of the matrix of transfer functions must not depend on the specimen",
                value="servo_hydraulic",
                remedy="Give numerator and denominator as they were identified with the specimen",
            )
        return system
    return TransferFunction(numerator=(entry,), denominator=(1.0,)) if entry else None
