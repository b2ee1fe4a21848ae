"""The running error inside the loop of a test: the monitor as C and as an FMU."""
