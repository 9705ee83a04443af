"""Makes the file that a user downloads: the mesh in one of podm's formats, several files as one zip."""
import shutil
import tempfile
import zipfile
from pathlib import Path

from .faults import Fault


def made_in(extension, mesh, declared, folder, convert):
    """Returns (name, path). The caller removes the file. `mesh`: a .vtu file with its facets beside it. `convert` runs
    podm convert on it in a folder."""
    if extension not in declared.extensions:
        raise Fault(f"{extension}: podm writes no such format.", 404)
    work = Path(tempfile.mkdtemp(dir=folder))
    try:
        files = _files(extension, mesh, work, convert)
        if len(files) == 1:
            return files[0].name, _moved(files[0], folder)
        name = f"{mesh.stem}{extension}.zip"
        with zipfile.ZipFile(work / name, "x", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
            for path in files:
                packed.write(path, path.name)
        return name, _moved(work / name, folder)
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _files(extension, mesh, work, convert):
    """Returns the files of the format: those that exist, or new ones."""
    if extension == mesh.suffix:
        return sorted(path for path in mesh.parent.glob("*.vtu"))
    ended = convert(work / f"{mesh.stem}{extension}", work)
    if ended.exit_code != 0:
        raise Fault(f"{extension}: {ended.broken or ended.errors.strip()}", 500)
    return sorted(work.iterdir())


def _moved(path, folder):
    handle, target = tempfile.mkstemp(dir=folder, prefix="download-")
    open(handle).close()
    return path.replace(target)
