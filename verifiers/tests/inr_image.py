"""Writes label images as INRIMAGE-4 with unit voxels."""

import numpy as np


def write_inr(path, voxels, offset=0.0):
    """Writes voxels[z, y, x] of 0 to 255; the center of voxel (0, 0, 0) is at (offset, offset, offset) mm."""
    nz, ny, nx = voxels.shape
    header = (f"#INRIMAGE-4#{{\nXDIM={nx}\nYDIM={ny}\nZDIM={nz}\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n"
              f"SCALE=2**0\nCPU=decm\nVX=1\nVY=1\nVZ=1\nTX={offset}\nTY={offset}\nTZ={offset}\n")
    path.write_bytes(header.ljust(256 - 4, "\n").encode() + b"##}\n" + voxels.astype(np.uint8).tobytes())
