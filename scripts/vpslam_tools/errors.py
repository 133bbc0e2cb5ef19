"""The one exception that is told to the user as a line, not as a traceback."""


class UserError(Exception):
    """Something the user can put right; the text names the fault and the remedy."""
