from .method import limits_section as limits_section, method_section as method_section
from .rates import rates_section as rates_section, rates_table as rates_table
