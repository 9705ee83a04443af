"""The exception of this package."""


class DocsError(Exception):
    """A query, a table or a file that cannot be read; the text gives its name and the reason."""
