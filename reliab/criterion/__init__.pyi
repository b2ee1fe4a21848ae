from .carrying import (
    carry_to_length as carry_to_length,
    carry_to_response as carry_to_response,
    carry_to_suite as carry_to_suite,
)
from .copies import without_copies as without_copies
from .criterion import Criterion as Criterion
from .derivation import (
    MOST_AT_REST as MOST_AT_REST,
    Derivation as Derivation,
    derive_criterion as derive_criterion,
    require_meaning as require_meaning,
)
from .distributions import (
    DISTRIBUTIONS as DISTRIBUTIONS,
    Distribution as Distribution,
    Lognormal as Lognormal,
    LogSkewNormal as LogSkewNormal,
)
from .ellipse_reading import read_ellipses as read_ellipses
from .ellipse_sample import (
    EllipseSample as EllipseSample,
    is_ellipse as is_ellipse,
    of_curve as of_curve,
    sample_of as sample_of,
)
from .ellipse_table import (
    REST as REST,
    EllipseTable as EllipseTable,
    between_tables as between_tables,
    names_along as names_along,
    neighbours as neighbours,
    with_threshold as with_threshold,
)
from .experimental_share import (
    carry_to_share as carry_to_share,
    growth as growth,
    whole_is_worst as whole_is_worst,
)
from .goodness_of_fit import (
    SIGNIFICANCE as SIGNIFICANCE,
    QuantilePlot as QuantilePlot,
    lognormality as lognormality,
    quantile_plot as quantile_plot,
)
from .motion_predictive import MotionPredictive as MotionPredictive
from .population import Population as Population
from .protection import protect_over_lengths as protect_over_lengths
from .provenance import (
    Provenance as Provenance,
    installed_versions as installed_versions,
    records_checksum as records_checksum,
)
from .published import printed_share as printed_share, published_criterion as published_criterion
from .response_measures import (
    ResponseMeasures as ResponseMeasures,
    compared_by_ellipse as compared_by_ellipse,
)
from .scaling import scales as scales
from .scope import (
    Position as Position,
    compare_with_scope as compare_with_scope,
    magnitudes_of as magnitudes_of,
    population_of as population_of,
    populations_in_words as populations_in_words,
    promised as promised,
    range_of as range_of,
    regions_of as regions_of,
    scope_of as scope_of,
)
from .share_comparison import compare_shares as compare_shares
from .shipped_tables import (
    shipped_ellipses as shipped_ellipses,
    shipped_measures as shipped_measures,
    shipped_windows as shipped_windows,
)
from .summary import describe_sample as describe_sample, summarise as summarise
from .weights import Weights as Weights
