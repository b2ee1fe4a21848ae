from .late_force import LateForce as LateForce
from .outside_term import OutsideTerm as OutsideTerm, is_outside as is_outside
from .outside_terms import outside_terms as outside_terms
