from .cubic_path import CubicPath as CubicPath
from .filters import (
    REACH as REACH,
    RIPPLE as RIPPLE,
    LowPass as LowPass,
    butterworth_poles as butterworth_poles,
    low_pass as low_pass,
    recursively_filtered as recursively_filtered,
    smoothed as smoothed,
)
from .noise import (
    CORNERS as CORNERS,
    NoiseModel as NoiseModel,
    Periodogram as Periodogram,
    converter_step as converter_step,
    expected_error as expected_error,
    fit_levels as fit_levels,
    fit_noise as fit_noise,
    line_places as line_places,
    mains_frequencies as mains_frequencies,
    near_mains as near_mains,
    noise_shapes as noise_shapes,
    vary_rounding as vary_rounding,
)
from .spectra import (
    binned as binned,
    convolved as convolved,
    correlated as correlated,
    hann as hann,
    periodogram as periodogram,
    taper as taper,
    upper_level as upper_level,
)
