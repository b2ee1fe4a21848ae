"""The blocks of a hybrid test whose input and output follow from the records, each simulated separately."""
