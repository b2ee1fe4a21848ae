"""Where a model fails: the motion quantities with which its residual is correlated."""
