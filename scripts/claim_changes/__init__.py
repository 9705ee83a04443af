"""How the claims of experiments/*.toml changed over the commits that a repository has."""
