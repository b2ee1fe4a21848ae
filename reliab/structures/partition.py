"""A structure divided for hybrid simulation: its specimen and the displacement that drives it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reliab.arrays import Array, Spectrum
from reliab.effects import Effect, Role
from reliab.errors import InputError
from reliab.structures.frames import Frame
from reliab.structures.frames.frame import require_positive_definite, require_positive_semidefinite
from reliab.structures.structure import Structure


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """The specimen without further effects: force = k·x + c·v + m·a of the piston's motion.

    >>> Specimen(stiffness=2000.0).damping
    0.0
    """

    stiffness: float  # Stiffness k [N/m], not negative
    damping: float = 0.0  # Damping coefficient c [N·s/m]
    mass: float = 0.0  # Moving mass m [kg], not negative

    def __post_init__(self) -> None:
        for name in ("stiffness", "mass"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(
                    f"The specimen's {name} must be finite and not negative",
                    value=value,
                    remedy="Give it in N/m or kg; a softening specimen is an effect",
                )
        if not math.isfinite(self.damping):
            raise InputError("The specimen's damping must be finite", value=self.damping)


@dataclass(frozen=True, kw_only=True, eq=False)
class Partition:
    """A frame of which one specimen stands in the laboratory, driven by one actuator.

    The actuator imposes the interface displacement γᵀx: that of a floor, γ = e_j, or a storey's drift,
    γ = e_j − e_(j−1). The specimen's linear part k_e, c_e, m_e belongs to the frame's matrices, so that the
    numerical substructure keeps M − m_eγγᵀ, C − c_eγγᵀ and K − k_eγγᵀ::

        M_n x'' + C_n x' + K_n x = −M ι a_g − γ f_e

    Raises InputError if γ does not fit, or the specimen has more mass, damping or stiffness than the
    structure can spare.

    A frame of one degree of freedom whose whole spring is tested is the paper's structure:

    >>> frame = Frame.from_structure(Structure(frequency=1.0, damping_ratio=0.02), mass=1000.0)
    >>> partition = Partition(frame=frame, interface=[1.0], specimen=Specimen(stiffness=39478.4176))
    >>> partition.stiffness_shares.round(6)
    array([1.])
    """

    frame: Frame  # The whole structure, specimen included: the reference
    interface: Array  # γ [-], shape (degrees of freedom,)
    specimen: Specimen  # Linear part of the specimen
    # Effects of the specimen beyond its linear part; only effects on the force are allowed
    effects: tuple[Effect, ...] = ()

    def __post_init__(self) -> None:
        interface = np.array(self.interface, dtype=np.float64)
        if interface.shape != (self.frame.size,) or not np.isfinite(interface).all() or not interface.any():
            raise InputError(
                f"The interface needs {self.frame.size} finite numbers that are not all zero",
                value=interface.tolist(),
                remedy="Give the weight of each degree of freedom in the displacement of the actuator",
            )
        interface.setflags(write=False)
        object.__setattr__(self, "interface", interface)
        for effect in self.effects:
            if effect.role is not Role.FORCE:
                raise InputError(
                    "An effect of a partition's specimen must act on its force",
                    value=effect.name,
                    remedy="Put effects of actuators and sensors into the laboratory",
                )
        self._check_shares()

    def _check_shares(self) -> None:
        specimen, frame = self.specimen, self.frame
        if specimen.mass + abs(specimen.damping) + specimen.stiffness == 0.0 and not self.effects:
            raise InputError("A specimen needs stiffness, damping or mass", value="none")
        most_mass = 1.0 / float(self.interface @ np.linalg.solve(frame.mass, self.interface))
        if specimen.mass >= most_mass:
            raise InputError(
                "The specimen's mass must be smaller than the mass that moves at the interface, "
                f"which is {most_mass:g} kg",
                value=f"{specimen.mass:g} kg",
                remedy="The frame's mass matrix includes the specimen; raise it or take a lighter specimen",
            )
        require_positive_definite(self.numerical_mass, "mass matrix that is left to the computer", "")
        require_positive_semidefinite(
            self.numerical_stiffness,
            "stiffness matrix that is left to the computer",
            "The specimen is stiffer than the frame that contains it: the frame's stiffness includes "
            "it, and the partition would be unstable",
        )
        require_positive_semidefinite(
            self.numerical_damping,
            "damping matrix that is left to the computer",
            "The specimen has more damping than the frame that contains it; add its damping to the frame's",
        )

    @classmethod
    def from_structure(cls, structure: Structure, mass: float = 1.0) -> "Partition":
        """Return the one-mode structure as a partition: its share α of the spring is the specimen."""
        stiffness = structure.experimental_fraction * structure.circular_frequency**2 * mass
        return cls(
            frame=Frame.from_structure(structure, mass),
            interface=np.ones(1),
            specimen=Specimen(stiffness=stiffness),
        )

    def _without(self, matrix: Array, share: float) -> Array:
        return np.asarray(matrix - share * np.outer(self.interface, self.interface))

    @cached_property
    def numerical_mass(self) -> Array:
        """M_n [kg], shape (n, n)."""
        return self._without(self.frame.mass, self.specimen.mass)

    @cached_property
    def numerical_damping(self) -> Array:
        """C_n [N·s/m], shape (n, n)."""
        return self._without(self.frame.damping, self.specimen.damping)

    @cached_property
    def numerical_stiffness(self) -> Array:
        """K_n [N/m], shape (n, n)."""
        return self._without(self.frame.stiffness, self.specimen.stiffness)

    @property
    def stiffness_shares(self) -> Array:
        """Modal shares of the specimen in the stiffness, α_i = k_e(γᵀφ_i)²/ω_i² [-], shape (modes,)."""
        return self.specimen.stiffness * self._squared / self.frame.modes.circular_frequency**2

    @property
    def damping_shares(self) -> Array:
        """Modal shares of the specimen in the damping, c_e(γᵀφ_i)²/(2ζ_iω_i) [-]; zero where ζ_i = 0."""
        whole = 2.0 * self.frame.damping_ratios * self.frame.modes.circular_frequency
        share = np.zeros_like(whole)
        np.divide(self.specimen.damping * self._squared, whole, out=share, where=whole > 0.0)
        return share

    @property
    def mass_shares(self) -> Array:
        """Modal shares of the specimen in the mass, m_e(γᵀφ_i)² [-], shape (modes,)."""
        return self.specimen.mass * self._squared

    @property
    def impedance_shares(self) -> Spectrum:
        """Force of the specimen in each mode over that of the mode's spring, Z(iω_i)(γᵀφ_i)²/ω_i² [-].

        Its real part holds stiffness and mass, its imaginary part damping; for a spring it is α_i.
        """
        omega = self.frame.modes.circular_frequency
        return np.asarray(self.impedance((1j * omega).astype(np.complex128)) * self._squared / omega**2)

    @property
    def _squared(self) -> Array:
        return np.asarray((self.interface @ self.frame.modes.shapes) ** 2)

    def impedance(self, s: Spectrum) -> Spectrum:
        """Force of the linear specimen over its displacement, Z = k_e + c_e s + m_e s² [N/m]."""
        return np.asarray(
            self.specimen.stiffness + s * (self.specimen.damping + s * self.specimen.mass), dtype=complex
        )

    def responses(self, s: Spectrum, actuator: Spectrum, output: Array | None = None) -> Spectrum:
        """Transfer functions from −a_g in the hybrid test, by solving the equations at every s.

        Parameters
        ----------
        s : numpy.ndarray
            Complex frequencies [rad/s], shape (n,).
        actuator : numpy.ndarray
            Measured over command displacement σ(s) of the transfer system [-], shape of `s`.
        output : numpy.ndarray, optional
            Weights of the degrees of freedom in the response, shape (degrees of freedom,); by default the
            measured interface displacement σ γᵀx.

        Returns
        -------
        numpy.ndarray
            Response [s²], shape of `s`.
        """
        along = np.outer(self.interface, self.interface)
        extra = (self.impedance(s) * (actuator - 1.0))[:, np.newaxis, np.newaxis]
        load = self.frame.mass @ self.frame.influence
        moved = np.linalg.solve(
            self.frame.dynamic_stiffness(s) + extra * along, load.astype(complex)[:, np.newaxis]
        )[..., 0]
        return np.asarray(actuator * (moved @ self.interface) if output is None else moved @ output)


def floor_interface(frame: Frame, name: str | int) -> Array:
    """γ of a specimen between the ground and a degree of freedom, shape (n,)."""
    interface = np.zeros(frame.size)
    interface[frame.degree_of_freedom(name)] = 1.0
    return interface


def drift_interface(frame: Frame, upper: str | int, lower: str | int) -> Array:
    """γ of a specimen between two degrees of freedom, shape (n,).

    Raises InputError if both are the same.
    """
    interface = floor_interface(frame, upper)
    if frame.degree_of_freedom(lower) == frame.degree_of_freedom(upper):
        raise InputError("A drift needs two different degrees of freedom", value=str(upper))
    interface[frame.degree_of_freedom(lower)] = -1.0
    return interface


def with_specimen(frame: Frame, interface: Sequence[float] | Array, specimen: Specimen) -> Frame:
    """Return the frame with a specimen added at an interface: the whole of which it is then a part."""
    along = np.outer(interface, interface)
    return Frame(
        mass=frame.mass + specimen.mass * along,
        damping=frame.damping + specimen.damping * along,
        stiffness=frame.stiffness + specimen.stiffness * along,
        influence=frame.influence,
        names=frame.names,
    )
