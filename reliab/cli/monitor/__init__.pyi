from .command import monitor as monitor
