"""Former names of arguments and methods, which do what they did through one further minor version."""

import warnings
from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")
_Class = TypeVar("_Class", bound=type)


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
                _warn(former, names[former], ends)
                named[names[former]] = named.pop(former)
            return function(*arguments, **named)

        return accepting

    return decorate


def renamed_method(ends: str, former: str, name: str) -> Callable[[_Class], _Class]:
    """Let the instances of a class have a method by its former name too, with a warning."""

    def decorate(owner: _Class) -> _Class:
        def as_before(instance: object, *arguments: object, **named: object) -> Any:  # noqa: ANN401 - its own result
            _warn(former, name, ends)
            return getattr(instance, name)(*arguments, **named)

        setattr(owner, former, as_before)
        return owner

    return decorate


def _warn(former: str, name: str, ends: str) -> None:
    warnings.warn(
        f"`{former}` is called `{name}` now; the former name ends with version {ends}",
        DeprecationWarning,
        stacklevel=3,
    )
