"""Takes an uploaded file into a folder: its name, its size, and what its header may name."""
import re

from .faults import Fault

IMAGES = (".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".inr", ".inr.gz")
BESIDE = (".raw", ".zraw", ".raw.gz", ".gz")  # voxels beside a header of .nhdr or .mhd
TABLES = (".txt", ".label", ".lut", ".ctbl")
LONGEST_NAME = 120
LONGEST_HEADER = 1 << 20
PART = 1 << 20
NRRD = (".nrrd", ".nhdr")
WITH_TEXT_HEADER = (*NRRD, ".mha", ".mhd")
NAMES_A_FILE = re.compile(rb"\s*(data ?file|elementdatafile)\s*[:=]+(.*)", re.IGNORECASE)


def checked_name(name):
    """Returns the name if it is one of a file in this folder, and of a kind that the page takes."""
    if (not name or len(name.encode()) > LONGEST_NAME or name[0] in ".-" or not name.isprintable()
            or "/" in name or "\\" in name or name.startswith("phantom:")):
        raise Fault(f"{_shown(name)}: not a file name that this page takes; rename the file.")
    if not name.endswith((*IMAGES, *BESIDE, *TABLES)):
        raise Fault(f"{_shown(name)}: not an image that podm reads ({' '.join(IMAGES)}), nor the voxels beside its "
                    f"header ({' '.join(BESIDE)}), nor a table of label names ({' '.join(TABLES)}).")
    return name


def _shown(name):
    return "".join(c if c.isprintable() else "?" for c in name)[:LONGEST_NAME] or "(no name)"


def receive(stream, length, path):
    """Writes `length` bytes of the stream to `path`. On failure no file is left."""
    try:
        with open(path, "xb") as file:
            left = length
            while left > 0:
                part = stream.read(min(left, PART))
                if not part:
                    raise Fault(f"{path.name}: the upload ended after {length - left:,} of {length:,} bytes.")
                file.write(part)
                left -= len(part)
    except FileExistsError:
        raise Fault(f"{path.name}: a file of this name is here already.") from None
    except OSError as error:
        path.unlink(missing_ok=True)
        raise Fault(f"{path.name}: the upload failed ({error.strerror or 'no bytes came for too long'}).") from None
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def check_header(path):
    """Refuses an image whose header names a file outside the image's folder, because podm would read that file."""
    if not path.name.endswith(WITH_TEXT_HEADER):
        return
    for line in _header_lines(path):
        if not (found := NAMES_A_FILE.match(line)):
            continue
        named = found[2].strip().decode(errors="replace")
        if named.lower() == "local" and found[1] == b"ElementDataFile":
            return  # voxels follow
        if "/" in named or "\\" in named or not (path.parent / named).is_file():
            raise Fault(f"{path.name}: its voxels are in the file '{_shown(named)}'; drop both files together.")


def _header_lines(path):
    """Yields the lines of a text header. An empty line ends the header of NRRD alone; MetaImage skips it."""
    with open(path, "rb") as file:
        for line in file.read(LONGEST_HEADER).split(b"\n"):
            if line in (b"", b"\r") and path.name.endswith(NRRD):
                return
            yield line
