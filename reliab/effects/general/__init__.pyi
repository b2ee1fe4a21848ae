from .general_term import GeneralTerm as GeneralTerm, is_general as is_general
from .general_terms import (
    ElasticStops as ElasticStops,
    general_term as general_term,
    general_terms as general_terms,
)
from .periodic import Disturbance as Disturbance, disturbance as disturbance
