"""From a grid of actuators to a labelled dataset: storage, resume, clusters.

Everything is imported on first use, since reading ellipses needs neither kernels nor the storage library.
"""
