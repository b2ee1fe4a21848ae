"""The blocks of a hybrid test whose input and output a campaign records, each simulated separately."""
