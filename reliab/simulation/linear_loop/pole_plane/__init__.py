"""Solutions for all actuators of one structure and ground motion from the responses of a few poles."""
