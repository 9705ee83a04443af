"""The pictures of docs/concepts, each drawn of a real run of podm."""
