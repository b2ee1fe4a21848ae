"""Parts of a frame that its file states with tolerances: floors, storeys, modes, entries of matrices."""

from functools import cache
from typing import TYPE_CHECKING, cast

from reliab.assessment.budget.budget import part_in_words
from reliab.assessment.inference.quantities.prior import Shape
from reliab.assessment.inference.quantities.quantity import Quantity

if TYPE_CHECKING:
    from reliab.assessment.inference.experiment import Experiment


class PartOfStructure(Quantity):
    """Relative change of one part of a frame."""

    unit = "%"
    factor = 100.0

    def apply(self, experiment: "Experiment", value: float, actuator: int) -> None:  # noqa: ARG002
        """Change an experiment."""
        experiment.parts[self.name] = value


@cache
def part_of_structure(name: str) -> Quantity:
    """Declare the quantity of a part by its name, such as "storey_stiffness_2"."""
    words, remedy = part_in_words(name)
    shape = Shape.LOGNORMAL if "damping" in name else Shape.NORMAL
    part = type(name, (PartOfStructure,), {"name": name, "words": words, "remedy": remedy, "shape": shape})
    return cast("Quantity", part())
