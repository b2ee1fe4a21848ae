"""All uncertain quantities: each file of this folder that declares a `QUANTITY`."""

import importlib
import pkgutil
from dataclasses import dataclass
from functools import cache

from reliab.assessment.inference.quantities import quantity as base
from reliab.assessment.inference.quantities.prior import Prior
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity

_FOLDER = base.__name__.rpartition(".")[0]


@cache
def quantities() -> tuple[Quantity, ...]:
    """Every quantity that is declared, in the order of their files."""
    found: list[Quantity] = []
    for module in pkgutil.iter_modules(importlib.import_module(_FOLDER).__path__):
        declared = getattr(importlib.import_module(f"{_FOLDER}.{module.name}"), "QUANTITY", ())
        found.extend(declared if isinstance(declared, tuple) else [declared])
    return tuple(found)


@dataclass(frozen=True, kw_only=True, eq=False)
class Unknown:
    """A quantity of a test, or of one of its actuators, with its prior."""

    quantity: Quantity
    prior: Prior
    actuator: int = 0
    name: str = ""  # Key in JSON


def list_unknowns(circumstances: Circumstances) -> tuple[Unknown, ...]:
    """List what is uncertain about a test."""
    found: list[Unknown] = []
    actuators = circumstances.partition.degrees
    for quantity in quantities():
        prior = quantity.prior(circumstances)
        if prior is None:
            continue
        for actuator in range(actuators if quantity.per_actuator else 1):
            numbered = quantity.per_actuator and actuators > 1
            name = f"{quantity.name}_{actuator + 1}" if numbered else quantity.name
            found.append(Unknown(quantity=quantity, prior=prior, actuator=actuator, name=name))
    return tuple(found)
