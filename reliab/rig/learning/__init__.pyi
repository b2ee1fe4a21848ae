from .baselines import last_ten as last_ten, left_out_scores as left_out_scores, pooled as pooled
from .circumstances import Circumstances as Circumstances, places_in_day as places_in_day, warmth as warmth
from .learned import Learned as Learned, learn as learn
from .scatter import Scatter as Scatter
