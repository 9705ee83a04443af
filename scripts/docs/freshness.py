"""Whether rows are of today's program: a folder of reference rows holds the canonical hashes of the program that made
them, and today's are in results/reference/canonical_hashes.json."""
import subprocess

from .canonical_hashes import HASHES, HashesError, differences, read


def stale_folders(root, folders):
    """(warnings, faults): a stale folder of a release is a fault, and before the release a warning."""
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
