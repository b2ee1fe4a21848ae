"""The results of a diagnosis, as objects and as the JSON that `reliab diagnose` writes."""
