"""Regular frames: shear frames on storey springs, and moment frames of columns and beams."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical


def shear_frame(masses: Sequence[float], storey_stiffnesses: Sequence[float]) -> tuple[Array, Array]:
    """Mass and stiffness matrices of a shear frame.

    `masses` [kg]; `storey_stiffnesses` [N/m].
    Returns M [kg] and K [N/m] for the horizontal displacements of the floors, shape (storeys, storeys).

    >>> mass, stiffness = shear_frame([1000.0, 1000.0], [2e6, 1e6])
    >>> stiffness
    array([[ 3000000., -1000000.],
           [-1000000.,  1000000.]])
    """
    m, k = np.asarray(masses, dtype=np.float64), np.asarray(storey_stiffnesses, dtype=np.float64)
    if m.size != k.size or m.size == 0:
        raise InputError(
            "A shear frame needs as many floor masses as storey stiffnesses",
            value=f"{m.size} masses and {k.size} stiffnesses",
            remedy="Give one mass and one stiffness for each storey, from the ground up",
        )
    for place, (mass, stiffness) in enumerate(zip(m.tolist(), k.tolist(), strict=True), start=1):
        require_physical("mass", mass, label=f"mass of floor {place}")
        require_physical("stiffness", stiffness, label=f"stiffness of storey {place}")
    upper_stiffness = np.append(k[1:], 0.0)
    return np.diag(m), np.diag(k + upper_stiffness) - np.diag(k[1:], 1) - np.diag(k[1:], -1)


_MOST_UNKNOWNS = 5_000  # whose matrix takes 200 MB


@dataclass(frozen=True, kw_only=True)
class PlanarFrame:
    """A regular planar frame with rigid joints and axially rigid members, on pins or fixed.

    >>> frame = PlanarFrame(storeys=1, bays=1, elastic_modulus=2e11, column_inertia=1e-6,
    ...                     beam_inertia=1e3, storey_height=3.0, bay_width=6.0)
    >>> bool(np.isclose(frame.lateral_stiffness()[0, 0], 2 * 3 * 2e11 * 1e-6 / 3.0**3))  # pinned feet
    True
    """

    storeys: int  # storeys, bays: Number of storeys and of bays
    bays: int
    elastic_modulus: float  # Young's modulus E [Pa]
    # column_inertia, beam_inertia: Second moments of area I [m⁴] of one column and of one beam
    column_inertia: float
    beam_inertia: float
    storey_height: float  # storey_height, bay_width: Lengths of columns and beams [m]
    bay_width: float
    fixed_base: bool = False  # Whether the feet of the columns are clamped; pinned by default

    def __post_init__(self) -> None:
        for name in ("storeys", "bays"):
            if getattr(self, name) < 1:
                raise InputError(
                    f"A planar frame must have {name}",
                    value=getattr(self, name),
                    remedy="Complete the table of the frame",
                )
        require_physical("elastic modulus", self.elastic_modulus)
        for member, inertia, length in (
            ("a column", self.column_inertia, self.storey_height),
            ("a beam", self.beam_inertia, self.bay_width),
        ):
            require_physical("second moment of area", inertia, label=f"second moment of area of {member}")
            require_physical("length", length, label=f"length of {member}")
        if self.storeys * (self.bays + 2) > _MOST_UNKNOWNS:
            raise InputError(
                f"A planar frame may have {_MOST_UNKNOWNS:,} displacements and rotations at most",
                value=f"{self.storeys:,} storeys of {self.bays:,} bays",
                remedy="Give its stiffness matrix instead",
            )

    def lateral_stiffness(self) -> Array:
        """Stiffness for the horizontal displacements of the floors [N/m], shape (storeys, storeys).

        The rotations θ of all joints are condensed out, K = K_xx − K_xθ K_θθ⁻¹ K_θx.
        """
        n, lines = self.storeys, self.bays + 1
        full = np.zeros((n * (1 + lines), n * (1 + lines)))
        for line in range(lines):
            for storey in range(n):
                self._add_column(full, storey, line)
        for floor in range(n):
            for bay in range(self.bays):
                ends = [self._rotation(floor, bay), self._rotation(floor, bay + 1)]
                beam_stiffness = self.elastic_modulus * self.beam_inertia / self.bay_width
                full[np.ix_(ends, ends)] += beam_stiffness * np.array([[4.0, 2.0], [2.0, 4.0]])
        swept = np.linalg.solve(full[n:, n:], full[n:, :n])
        lateral = full[:n, :n] - full[:n, n:] @ swept
        return np.asarray(0.5 * (lateral + lateral.T))

    def _rotation(self, floor: int, line: int) -> int:
        return self.storeys + floor * (self.bays + 1) + line

    def _add_column(self, full: Array, storey: int, line: int) -> None:
        """Add a column: displacement and rotation at its foot, then at its head."""
        h = self.storey_height
        if storey == 0 and not self.fixed_base:
            ends = [0, self._rotation(0, line)]
            local = 3.0 * np.array([[1.0, -h], [-h, h * h]])
        else:
            local = np.array(
                [
                    [12.0, 6.0 * h, -12.0, 6.0 * h],
                    [6.0 * h, 4.0 * h * h, -6.0 * h, 2.0 * h * h],
                    [-12.0, -6.0 * h, 12.0, -6.0 * h],
                    [6.0 * h, 2.0 * h * h, -6.0 * h, 4.0 * h * h],
                ]
            )
            if storey == 0:
                ends, local = [0, self._rotation(0, line)], local[2:, 2:]
            else:
                foot = [storey - 1, self._rotation(storey - 1, line)]
                ends = [*foot, storey, self._rotation(storey, line)]
        sway_stiffness = self.elastic_modulus * self.column_inertia / self.storey_height**3
        full[np.ix_(ends, ends)] += sway_stiffness * local
