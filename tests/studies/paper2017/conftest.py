"""The printed rows."""

import pandas as pd
import pytest

from reliab.core.shipped import shipped


@pytest.fixture
def rows_of_paper() -> pd.DataFrame:
    """Table 2 as printed."""
    return pd.read_csv(shipped("datasets", "paper/table2.csv"))
