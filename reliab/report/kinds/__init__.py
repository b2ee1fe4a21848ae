"""One folder for each kind of report; `report.py` in it lays the pages out."""
