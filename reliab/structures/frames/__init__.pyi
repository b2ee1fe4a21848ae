from .frame import (
    Frame as Frame,
    exact_step as exact_step,
    follow_load as follow_load,
    massless as massless,
    modal_damping as modal_damping,
    place_of as place_of,
    rayleigh_damping as rayleigh_damping,
    square_matrix as square_matrix,
    undivided_response as undivided_response,
)
from .planar_frame import PlanarFrame as PlanarFrame, shear_frame as shear_frame
