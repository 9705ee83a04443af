"""One HTML page of claims, tables, figures, environment and a mesh, which needs nothing but a browser."""
