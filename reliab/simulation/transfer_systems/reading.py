"""Identified models from other software: objects of SciPy and python-control, and MATLAB files."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.core.files import decoding, ordinary
from reliab.simulation.transfer_systems.matlab_structure import require_sound_structure
from reliab.simulation.transfer_systems.transfer_function import TransferFunction, coefficients_of

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
                "A transfer system has one input and one output", value=f"{b.shape[1]} and {c.shape[0]}"
            )
        numerator, denominator = scipy.signal.ss2tf(
            np.asarray(model.A), b, c, np.atleast_2d(np.asarray(model.D))
        )
        return TransferFunction(
            numerator=_without_rounding(numerator[0]), denominator=coefficients_of(denominator), delay=delay
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


def _without_rounding(numerator: np.ndarray) -> tuple[float, ...]:
    """Coefficients of which leading ones that are rounding of zero are removed."""
    small = np.abs(numerator) <= 1e-12 * np.abs(numerator).max()
    return coefficients_of(np.where(np.cumprod(small), 0.0, numerator))


def _single(coefficients: Any) -> tuple[float, ...]:  # noqa: ANN401 - any library's
    """Coefficients of one channel, which python-control nests in two lists."""
    channel = coefficients
    while len(channel) and np.ndim(channel[0]) > 0:
        if len(channel) != 1:
            raise InputError(
                "A transfer system has one input and one output", value=f"{len(channel)} channels"
            )
        channel = channel[0]
    return coefficients_of(channel)


def read_matlab(path: str | Path, variable: str | None = None, delay: float = 0.0) -> TransferFunction:
    """Read an identified model from a MATLAB file.

    `delay` [s].
    """
    held = _variables(path, variable)
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            return _build(_Held(held, str(path)), delay)
    except (FloatingPointError, OverflowError, np.linalg.LinAlgError) as error:
        raise InputError(
            "The numbers of this transfer system are too large",
            value=str(error),
            remedy="Check the units: 1/s",
            where=str(path),
        ) from None


def _build(held: "_Held", delay: float) -> TransferFunction:
    for numerator, denominator in _FORMS:
        if held.has(numerator, denominator):
            return TransferFunction(
                numerator=coefficients_of(held.vector(numerator)),
                denominator=coefficients_of(held.vector(denominator)),
                delay=delay,
            )
    if held.has("z", "p", "k"):
        zeros, poles = held.vector("z", real=False), held.vector("p", real=False)
        return TransferFunction.from_poles(zeros, poles, float(held.matrix("k", 1, 1)[0, 0]), delay=delay)
    if held.has("A", "B", "C", "D"):
        order = math.isqrt(held.vector("A").size)
        sizes = {"A": (order, order), "B": (order, 1), "C": (1, order), "D": (1, 1)}
        matrices = [held.matrix(name, *size) for name, size in sizes.items()]
        return transfer_function_of(scipy.signal.StateSpace(*matrices), delay)
    raise InputError(
        "A MATLAB file must hold num and den, or z, p and k, or A, B, C and D",
        value=", ".join(held.names) or "none of them",
        remedy="Objects of toolboxes cannot be read: save [num, den] = tfdata(model, 'v') instead",
        where=held.where,
    )


class _Held:
    """Variables of a MATLAB file, each checked when it is taken: numbers of the size that the form needs."""

    def __init__(self, variables: Mapping[str, Any], where: str) -> None:
        self._variables, self.where = variables, where

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

    def _refuse(self, name: str, needed: str, value: str) -> InputError:
        return InputError(
            f"The variable {name} of a transfer system must be {needed}",
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
