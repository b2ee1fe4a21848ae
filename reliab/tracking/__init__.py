"""How an actuator followed its command: indices of tracking, and boundaries of equal error."""
