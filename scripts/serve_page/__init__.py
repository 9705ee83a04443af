"""Serves a page in which a browser on this machine meshes an image: the server, the programs that it runs, the page."""
