"""What an error is rebuilt from: noise and beginning of the channels, recursions, parts, running sums."""
