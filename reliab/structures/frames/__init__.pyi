from .damping import modal_damping as modal_damping, rayleigh_damping as rayleigh_damping
from .frame import (
    Frame as Frame,
    Modes as Modes,
    natural_modes as natural_modes,
    place_of as place_of,
    square_matrix as square_matrix,
)
from .planar_frame import PlanarFrame as PlanarFrame, shear_frame as shear_frame
from .response import (
    exact_step as exact_step,
    follow_load as follow_load,
    undivided_response as undivided_response,
)
