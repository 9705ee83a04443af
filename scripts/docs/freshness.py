"""Checks that rows come from a program that makes the same meshes as today's. A folder of reference rows holds the
canonical hashes of the program that made them; today's hashes are in results/reference/canonical_hashes.json."""
import subprocess

from .canonical_hashes import HASHES, HashesError, differences, read


def stale_folders(root, folders):
    """Returns (warnings, faults). A stale folder is a fault if its release is tagged, otherwise a warning."""
    warnings, faults = [], []
    reference = root / "results" / "reference"
    for folder in sorted(folders):
        why = _why_stale(reference, folder)
        if why:
            words = f"results/reference/{folder}: {why}"
            (faults if is_released(root, folder.parts[0]) else warnings).append(words)
    return warnings, faults


def is_released(root, release):
    tags = subprocess.run(["git", "-C", root, "tag", "--list", release, f"v{release}"], capture_output=True, text=True,
                          check=False)
    return bool(tags.stdout.strip())


def _why_stale(reference, folder):
    theirs = reference / folder / HASHES.name
    if not theirs.exists():
        return "its rows are of a program whose canonical hashes are not known"
    try:
        changed = differences(read(theirs), read(reference / HASHES.name))
    except HashesError as error:
        return str(error)
    return f"its rows are of a program that makes other meshes than today's: {', '.join(changed)}" if changed else ""
