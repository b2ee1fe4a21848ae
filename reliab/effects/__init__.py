"""Effects that may be missing from the model of a hybrid test, one to a file."""
