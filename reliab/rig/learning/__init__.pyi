from .baselines import Baseline as Baseline, last_ten as last_ten, pooled as pooled
from .circumstances import Circumstances as Circumstances, places_in_day as places_in_day, warmth as warmth
from .learned import Learned as Learned, learn as learn
from .variances import Variances as Variances, fit_variances as fit_variances
