"""Reads rows from the archives that `podm-bench pack` writes. Nothing is unpacked to a disk."""
import tarfile

MOST_BYTES = 2**29  # unpacked, as podm-bench check allows
ENDING = ".tar.gz"


class ArchiveError(Exception):
    """An archive that cannot be read; the text names it and the fault."""


def texts_of(path):
    """Yields (name, text) of each file of rows in the archive. Raises ArchiveError."""
    try:
        with tarfile.open(path, "r:gz") as archive:
            unpacked = 0
            for member in archive:
                unpacked += member.size
                if unpacked > MOST_BYTES:
                    raise ArchiveError(f"{path}: it unpacks to more than {MOST_BYTES} bytes")
                if member.isfile() and member.name.startswith("rows/") and member.name.endswith(".jsonl"):
                    yield f"{path}: {member.name}", archive.extractfile(member).read().decode(errors="replace")
    except (tarfile.TarError, EOFError, OSError) as error:
        raise ArchiveError(f"{path}: not a whole archive of podm-bench pack: {error}") from None
