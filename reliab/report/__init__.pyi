from .axes import (
    AMPLITUDE as AMPLITUDE,
    DELAY as DELAY,
    DISPLACEMENT as DISPLACEMENT,
    ERRORS as ERRORS,
    TIME as TIME,
    label_logarithmic as label_logarithmic,
    legend_below as legend_below,
    mark as mark,
    name_axes as name_axes,
    plain as plain,
)
from .content import CONTENT_FILE as CONTENT_FILE, files_of as files_of
from .document import (
    Block as Block,
    Column as Column,
    Document as Document,
    Figure as Figure,
    Paragraph as Paragraph,
    Points as Points,
    Section as Section,
    Table as Table,
)
from .numbers import (
    Fixed as Fixed,
    Scientific as Scientific,
    Shortest as Shortest,
    Significant as Significant,
    Whole as Whole,
    in_line as in_line,
)
from .pdf import write_pdf as write_pdf
from .prose import Prose as Prose
from .provenance import provenance_of as provenance_of
from .saved import save_content as save_content, saved_content as saved_content
from .setting import Setting as Setting
from .sources import SOURCES as SOURCES
from .style import (
    BLUE as BLUE,
    GREY as GREY,
    INK as INK,
    PALE as PALE,
    SEQUENTIAL as SEQUENTIAL,
    VERMILION as VERMILION,
    FigureWarning as FigureWarning,
    blank as blank,
    letters as letters,
    line as line,
    panels as panels,
    picture as picture,
    styled as styled,
    svg as svg,
)
from .wording import (
    law_in_words as law_in_words,
    listed as listed,
    spelled_out as spelled_out,
    values as values,
)
