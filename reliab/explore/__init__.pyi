from .page import Settings as Settings, write_page as write_page
