"""Manual pages and shell completion, made of what programs print for --help: their own tables of options."""
