"""What a stated confidence can mean, one method per file.

Which to use: `quantile` repeats the paper. `dirichlet`, jointly for a and b, is recommended: it keeps its
promise on average for few and many earthquakes, skewed or not. `tolerance` and `order_statistic` keep it
with an assurance, at the price of a smaller region.
`hierarchical` learns all structures together, from a posterior that is sampled.
"""
