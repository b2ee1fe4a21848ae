"""All actuators before one structure from the responses of a few poles, for one ground motion."""
