"""All uncertain quantities: each file of this folder that declares a `QUANTITY`."""

import importlib
import pkgutil
from dataclasses import dataclass, replace
from functools import cache

from reliab.assessment.inference.quantities import quantity as base
from reliab.assessment.inference.quantities.part_of_structure import part_of_structure
from reliab.assessment.inference.quantities.prior import Prior
from reliab.assessment.inference.quantities.quantity import Circumstances, Quantity
from reliab.structures.parts_of_structure import is_part

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
    of_parts = [part_of_structure(name) for name in circumstances.tolerances if is_part(name)]
    found: list[Unknown] = []
    for quantity in (*quantities(), *of_parts):
        for actuator in range(circumstances.partition.degrees if quantity.per_actuator else 1):
            of_actuator = replace(circumstances, actuator=actuator)
            prior = quantity.prior(of_actuator)
            if prior is not None:
                name = of_actuator.named(quantity.name) if quantity.per_actuator else quantity.name
                found.append(Unknown(quantity=quantity, prior=prior, actuator=actuator, name=name))
    return tuple(found)
