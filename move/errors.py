"""The one exception that means: the input was wrong, nothing was written, exit code 2."""


class BadInput(ValueError):
    """Raised with one line that says what was given, what is allowed and where."""
