"""Results that hold rows give them as a table of pandas."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar

if TYPE_CHECKING:
    import pandas as pd


class ResultWithRows(ABC):
    """A result whose plain values hold rows: criteria, tests, motions, ellipses."""

    rows_in: ClassVar[str]  # The key of `to_dict` that holds the rows

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys."""

    def to_frame(self) -> "pd.DataFrame":
        """Put the rows into a table, with their keys as columns; a value within a value is `outer_inner`."""
        import pandas as pd

        return pd.json_normalize(self.to_dict()[self.rows_in], sep="_")
