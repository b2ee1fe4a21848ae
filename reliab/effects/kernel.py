"""Compiled functions of effects: each kernel is compiled separately and called by its address.

A loop that calls kernels by address does not depend on which they are, so that a new effect compiles one
small function and nothing else, and every kernel is cached on disk across processes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, cast

from llvmlite import ir
from numba import types
from numba.core.errors import TypingError
from numba.extending import intrinsic

from reliab.core.compiled import compile_callback


class Numbers(Protocol):
    """Numbers that a kernel reads and writes: an array, or its address in compiled code."""

    def __getitem__(self, index: int, /) -> float: ...

    def __setitem__(self, index: int, value: float, /) -> None: ...


KernelFunction = Callable[[Numbers, float, float, Numbers, Numbers], float]

_NUMBERS = cast("Any", types.CPointer)(types.float64)
_SIGNATURE = types.float64(_NUMBERS, types.float64, types.float64, _NUMBERS, _NUMBERS)


@dataclass(frozen=True, kw_only=True)
class Kernel:
    """A function that is called at every step of a simulation.

    Parameters
    ----------
    function : callable
        `function(motion, time, step, coefficients, state) -> float` in Numba's nopython subset: displacement,
        velocity and acceleration (which it may change), time and step [s], the effect's coefficients, its
        state (zero before the first step). What it returns depends on the role of the effect.
    states : int, optional
        Length of the state.
    linear : int, optional
        Place of a coefficient to which what it returns is proportional; none where there is no such one.
    by_path : bool, optional
        Whether the displacement alone decides, not velocity, acceleration or time.

    Examples
    --------
    >>> import numpy as np
    >>> def spring(motion, time, step, coefficients, state):
    ...     return coefficients[0] * motion[0]
    >>> Kernel(function=spring)(np.array([0.1, 0.0, 0.0]), 0.0, 0.001, np.array([20.0]), np.zeros(1))
    2.0
    """

    function: KernelFunction
    states: int = 0
    linear: int | None = None
    by_path: bool = False

    def __call__(
        self, motion: Numbers, time: float, step: float, coefficients: Numbers, state: Numbers
    ) -> float:
        """Call the function without compiling it."""
        return float(self.function(motion, time, step, coefficients, state))

    @cached_property
    def _compiled(self) -> Any:  # noqa: ANN401 - Numba states no type
        return compile_callback(_SIGNATURE, self.function)

    @property
    def address(self) -> int:
        """Address of the compiled function in this process."""
        return int(self._compiled.address)


def _call(
    _typing: object,
    address: object,
    motion: object,
    time: object,
    step: object,
    coefficients: object,
    state: object,
) -> tuple[object, object]:
    del motion, time, step, coefficients, state
    if not isinstance(address, types.Integer):
        raise TypingError("a kernel is called by its address, an integer")

    def generate(_context: object, builder: Any, _signature: object, arguments: Any) -> object:  # noqa: ANN401
        number = ir.DoubleType()
        numbers = number.as_pointer()
        function = ir.FunctionType(number, [numbers, number, number, numbers, numbers])
        return builder.call(builder.inttoptr(arguments[0], function.as_pointer()), arguments[1:])

    return types.float64(types.intp, *_SIGNATURE.args), generate


def _point(_typing: object, array: object, offset: object) -> tuple[object, object]:
    del offset
    if not (isinstance(array, types.Array) and array.dtype == types.float64 and array.layout == "C"):
        raise TypingError("kernels read contiguous arrays of double precision")

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> object:  # noqa: ANN401
        data = context.make_array(signature.args[0])(context, builder, arguments[0]).data
        return builder.gep(data, [arguments[1]])

    return _NUMBERS(array, types.intp), generate


call_kernel = cast("Callable[[int, Numbers, float, float, Numbers, Numbers], float]", intrinsic(_call))
"""`call_kernel(address, motion, time, step, coefficients, state)` calls a kernel from compiled code."""

pointer_to = cast("Callable[[Numbers, int], Numbers]", intrinsic(_point))
"""`pointer_to(array, offset)` is what `call_kernel` takes for an array: the address of an element."""
