"""What the channels hold at which frequency: noise, segments, smoothing, conversion, scales."""
