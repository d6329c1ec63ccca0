"""What stays open is said, with the reason."""

from gks.errors import GksError


class Undecided(GksError):
    """A question about abs(z) = 1 that the precision or the method allowed does not settle."""
