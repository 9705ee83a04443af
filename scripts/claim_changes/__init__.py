"""The changes of the claims of experiments/*.toml over the commits of a repository."""
