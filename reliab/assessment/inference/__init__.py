"""The posterior of a test: its channels in a band of frequencies, evidence, and draws."""
