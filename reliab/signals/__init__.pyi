from .converter import (
    converter_step as converter_step,
    expected_error as expected_error,
    vary_rounding as vary_rounding,
)
from .filters import low_pass as low_pass, smoothed as smoothed
from .noise import (
    CORNERS as CORNERS,
    NoiseModel as NoiseModel,
    Periodogram as Periodogram,
    fit_levels as fit_levels,
    fit_noise as fit_noise,
    line_places as line_places,
    mains_frequencies as mains_frequencies,
    near_mains as near_mains,
    noise_shapes as noise_shapes,
)
from .spectra import binned as binned, periodogram as periodogram, upper_level as upper_level
