"""From a grid of actuators to a labelled dataset: storage, resume, clusters."""
