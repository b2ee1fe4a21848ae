"""Where a model fails: what its residual goes along with."""
