from .command import criterion as criterion
