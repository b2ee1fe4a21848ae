"""An independent simulator of campaigns with hidden effects, and the scoring of a product's answers.

Nothing here imports `reliab`: README.md holds the equations.
"""
