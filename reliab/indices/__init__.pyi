from .frequency_evaluation import (
    CommandSpectrum as CommandSpectrum,
    FrequencyEvaluation as FrequencyEvaluation,
    evaluate_sums as evaluate_sums,
)
from .response_error import relative_error as relative_error
from .tracking import (
    delay_by_cross_correlation as delay_by_cross_correlation,
    energy_error as energy_error,
    maximum_tracking_error as maximum_tracking_error,
    phase_amplitude_errors as phase_amplitude_errors,
    rms_tracking_error as rms_tracking_error,
    tracking_indicator as tracking_indicator,
)
from .tracking_over_frequency import TrackingOverFrequency as TrackingOverFrequency
from .window import Window as Window
