"""The documentation: its command blocks, its links, and the site that `make docs` builds."""
