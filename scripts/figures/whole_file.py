"""Files that appear whole or not at all."""
import os


def write_whole(path, data):
    """Until all bytes are written an older file of that name stays as it was. Raises OSError."""
    aside = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        aside.write_bytes(data)
        os.replace(aside, path)
    except BaseException:
        aside.unlink(missing_ok=True)
        raise
