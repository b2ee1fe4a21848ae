"""Former names of arguments, which do what they did through one further minor version."""

import warnings
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def renamed(
    ends: str, **names: str
) -> Callable[[Callable[_Parameters, _Result]], Callable[_Parameters, _Result]]:
    """Let a function take arguments by their former names too, with a warning.

    >>> @renamed("0.4", frequency="f")
    ... def period(*, f):
    ...     return 1.0 / f
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     period(frequency=2.0), str(caught[0].message)
    (0.5, '`frequency` is called `f` now; the former name ends with version 0.4')
    """

    def decorate(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
        @wraps(function)
        def accepting(*arguments: _Parameters.args, **named: _Parameters.kwargs) -> _Result:
            for former in names.keys() & named.keys():
                warnings.warn(
                    f"`{former}` is called `{names[former]}` now; the former name ends with version {ends}",
                    DeprecationWarning,
                    stacklevel=2,
                )
                named[names[former]] = named.pop(former)
            return function(*arguments, **named)

        return accepting

    return decorate
