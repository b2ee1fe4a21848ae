"""All structures learned together: a model of earthquakes, motions and structures, sampled by MCMC."""
