from .plane import mean_squares as mean_squares
