"""The loop: structure, actuator, stability and the engines that solve it."""
