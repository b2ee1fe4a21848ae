"""The printed rows."""

import pandas as pd
import pytest

from reliab.core.shipped import shipped


@pytest.fixture
def printed_rows() -> pd.DataFrame:
    """Table 2 as printed."""
    return pd.read_csv(shipped("datasets", "paper/table2.csv"))
