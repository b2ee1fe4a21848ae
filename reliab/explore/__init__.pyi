from .page import Settings as Settings, by_length as by_length, write_page as write_page
