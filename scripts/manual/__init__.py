"""Makes manual pages and shell completion from the --help output of programs."""
