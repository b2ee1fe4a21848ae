from .unexplained import LARGEST_REMAINDER as LARGEST_REMAINDER
