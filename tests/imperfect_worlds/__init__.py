"""Worlds from published equations, none of which is a member of the library: where names are judged.

Each world holds one dominant effect that the library only resembles, and disturbances of 2 to 20 % of the
signal that it does not hold at all. They import nothing of the product.
"""
