from .columns import Columns as Columns, Series as Series, is_frame as is_frame, read_frame as read_frame
from .registry import FORMATS as FORMATS, Format as Format, read_tests as read_tests
