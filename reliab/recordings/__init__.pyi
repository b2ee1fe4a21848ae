from .calibration import (
    ChannelCalibration as ChannelCalibration,
    calibrate_channels as calibrate_channels,
    calibration_in_toml as calibration_in_toml,
)
from .channels_file import (
    ChannelTables as ChannelTables,
    read_channels_file as read_channels_file,
    stated_by_tables as stated_by_tables,
)
from .coupled_recording import (
    CoupledRecording as CoupledRecording,
    read_coupled_recording as read_coupled_recording,
)
from .followed_rows import (
    rows_about_zero as rows_about_zero,
    rows_at_equal_steps as rows_at_equal_steps,
    rows_without_skew as rows_without_skew,
    step_of_rows as step_of_rows,
)
from .following import (
    Rows as Rows,
    chunks_of_text as chunks_of_text,
    rows_as_written as rows_as_written,
)
from .readers import is_frame as is_frame, read_tests as read_tests
from .reading import (
    Histories as Histories,
    histories_of as histories_of,
    read_recording as read_recording,
    read_test as read_test,
    stated_by_options as stated_by_options,
)
from .record import (
    SCHEMA as SCHEMA,
    About as About,
    check_record as check_record,
    record_test as record_test,
    write_csv as write_csv,
    write_record as write_record,
)
from .recording import (
    FEWEST_SAMPLES as FEWEST_SAMPLES,
    LARGEST_READING as LARGEST_READING,
    Channel as Channel,
    Part as Part,
    Recording as Recording,
    StatedChannels as StatedChannels,
)
from .spikes import without_spikes as without_spikes
from .units import (
    LENGTHS as LENGTHS,
    TIMES as TIMES,
    UNITS as UNITS,
)
from .zero import zero_of as zero_of
