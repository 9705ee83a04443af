"""Writes a file completely or not at all."""
import json
import os


def write_whole(path, data):
    """Keeps an existing file of that name unchanged until all bytes are written. Raises OSError."""
    aside = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        aside.write_bytes(data)
        os.replace(aside, path)
    except BaseException:
        aside.unlink(missing_ok=True)
        raise


def write_text(path, text):
    write_whole(path, text.encode())


def write_json(path, value):
    write_text(path, json.dumps(value, indent=1, allow_nan=False) + "\n")
