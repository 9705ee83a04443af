"""Reads an operation log (mesher/include/podm/operation_log.h) and gives the vertices at any moment of its run."""
import json
import struct
from dataclasses import dataclass

import numpy

MAGIC = b"podmlog1"
OPERATION = numpy.dtype([("sequence", "<u8"), ("point", "<f8", 3), ("vertex", "<u4"), ("worker", "<u4"),
                         ("kind", "<u4"), ("num_removed", "<u4")])
MOVED, ISOSURFACE, CIRCUMCENTER = 0, 2, 3


class LogError(Exception):
    """A log that cannot be read; the text names the file and the fault."""


@dataclass(frozen=True)
class OperationLog:
    operations: numpy.ndarray  # in the order of the commits
    removed: list  # the vertices that each operation removes
    box: numpy.ndarray  # 2 x 3: low and high corner

    def vertices_before(self, number):
        """{id: point} before the operation of this number; corners of the box have negative ids."""
        corners = numpy.stack(numpy.meshgrid(*self.box.T, indexing="ij"), axis=-1).reshape(-1, 3)
        vertices = {-1 - at: corner for at, corner in enumerate(corners)}
        for operation, removed in zip(self.operations[:number], self.removed[:number]):
            if operation["kind"] == MOVED:
                vertices[int(operation["vertex"])] = vertices.pop(int(removed[0]))
                continue
            for one in removed:
                vertices.pop(int(one))
            vertices[int(operation["vertex"])] = operation["point"]
        return vertices


def read_log(path):
    """Raises LogError."""
    data = path.read_bytes()
    if not data.startswith(MAGIC):
        raise LogError(f"{path}: no operation log")
    place, batches, removed = len(MAGIC), [], []
    try:
        while True:
            count, num_removed = struct.unpack_from("<II", data, place)
            place += 8
            if count == num_removed == 0:
                break
            batches.append(numpy.frombuffer(data, OPERATION, count, place))
            place += count * OPERATION.itemsize
            ids = numpy.frombuffer(data, "<u4", num_removed, place)
            place += 4 * num_removed
            removed += numpy.split(ids, numpy.cumsum(batches[-1]["num_removed"])[:-1])
        box = numpy.reshape(json.loads(data[place:])["box"], (2, 3))
    except (struct.error, ValueError, KeyError) as error:
        raise LogError(f"{path}: {error}") from None
    operations = numpy.concatenate(batches)
    order = numpy.argsort(operations["sequence"], kind="stable")
    return OperationLog(operations[order], [removed[at] for at in order], box)
