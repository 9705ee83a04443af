"""Makes an HTML page of claims, tables, figures, environment and a mesh, which needs only a browser."""
