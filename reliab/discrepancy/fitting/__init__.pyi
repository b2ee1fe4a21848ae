from .problem import MOST_OF_A_TEST as MOST_OF_A_TEST
