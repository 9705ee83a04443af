#!/usr/bin/python3
"""Draws a mesh written by `podm mesh -o MESH.vtu`, cut open along a plane, as a PNG.

Cells are shown whole: those whose centre lies beyond the plane are left out, so the cut is a landscape of
tetrahedra. Every label has a colour of its own; the one with the greatest volume is pale, as a background.

Needs Debian's python3-vtk9 and python3-numpy; without a display also xvfb and xauth.
"""
import argparse
import os
import shutil
import sys
from pathlib import Path

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

AXES = {"x": 0, "y": 1, "z": 2}
PALE = (0.93, 0.89, 0.82)
# Told apart at a glance, also side by side; muted, so that the edges stay visible on them.
PALETTE = [
    (0.80, 0.36, 0.33), (0.27, 0.51, 0.71), (0.95, 0.72, 0.33), (0.42, 0.64, 0.42), (0.58, 0.45, 0.70),
    (0.91, 0.55, 0.40), (0.36, 0.68, 0.69), (0.86, 0.56, 0.68), (0.62, 0.55, 0.35), (0.55, 0.63, 0.82),
    (0.71, 0.78, 0.41), (0.56, 0.34, 0.36), (0.30, 0.42, 0.47), (0.83, 0.76, 0.55), (0.72, 0.61, 0.79),
]


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("mesh", type=Path, help="a .vtu file with the cell array `label`")
    parser.add_argument("-o", "--output", type=Path, help="PNG file (default: the mesh's name with .png)")
    parser.add_argument("--axis", choices=AXES, default="y", help="normal of the cutting plane (default: %(default)s)")
    parser.add_argument(
        "--fraction", type=float, default=0.5,
        help="place of the plane along the mesh's extent, 0 to 1 (default: %(default)s)",
    )
    parser.add_argument("--flip", action="store_true", help="keep the upper side instead of the lower one")
    parser.add_argument("--size", type=int, nargs=2, default=(1600, 1200), metavar=("W", "H"),
                        help="of the picture, pixels (default: 1600 1200)")
    arguments = parser.parse_args()
    if not 0 < arguments.fraction <= 1:
        parser.error("--fraction must lie in (0, 1]")
    if min(arguments.size) < 16:
        parser.error("--size must be at least 16 pixels each way")
    arguments.output = arguments.output or arguments.mesh.with_suffix(".png")
    return arguments


def ensure_display():
    """Debian's VTK draws through X only: without a display, start again inside a virtual one."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run") or not shutil.which("xauth"):
        sys.exit("render_mesh.py: no display; install the packages xvfb and xauth")
    os.execvp("xvfb-run", ["xvfb-run", "-a", sys.executable, *sys.argv])


def read_mesh(path):
    if not path.is_file():
        sys.exit(f"render_mesh.py: no file {path}")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    if grid.GetNumberOfCells() == 0 or not grid.GetCellData().HasArray("label"):
        sys.exit(f"render_mesh.py: {path}: no cells with an array `label`")
    return grid


def colours_of_labels(grid):
    """A table from label value to colour, the greatest label pale and the others by rank of volume."""
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    cell_data = sizes.GetOutput().GetCellData()
    values, positions = numpy.unique(vtk_to_numpy(cell_data.GetArray("label")), return_inverse=True)
    volumes = numpy.bincount(positions, vtk_to_numpy(cell_data.GetArray("Volume")))
    table = vtk.vtkLookupTable()
    table.IndexedLookupOn()
    table.SetNumberOfTableValues(len(values))
    for rank, index in enumerate(numpy.argsort(-volumes)):
        table.SetAnnotation(int(values[index]), str(values[index]))
        colour = PALE if rank == 0 and len(values) > 1 else PALETTE[(rank - 1) % len(PALETTE)]
        table.SetTableValue(table.GetAnnotatedValueIndex(int(values[index])), *colour)
    return table


def cut_open(grid, axis, fraction, flip):
    """The outer surface of the cells whose centres lie on the near side of the plane."""
    bounds = grid.GetBounds()[2 * axis : 2 * axis + 2]
    place = bounds[0] + fraction * (bounds[1] - bounds[0])
    centers = vtk.vtkCellCenters()
    centers.SetInputData(grid)
    centers.Update()
    along = vtk_to_numpy(centers.GetOutput().GetPoints().GetData())[:, axis]
    kept = numpy.flatnonzero(along >= place if flip else along <= place)
    if kept.size == 0:
        sys.exit("render_mesh.py: the plane leaves no cell; choose another --fraction")
    extract = vtk.vtkExtractCells()
    extract.SetInputData(grid)
    extract.SetCellList(as_id_list(kept))
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputConnection(extract.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


def as_id_list(numbers):
    ids = vtk.vtkIdList()
    ids.SetNumberOfIds(len(numbers))
    for position, number in enumerate(numbers.tolist()):
        ids.SetId(position, number)
    return ids


def make_actor(surface, table, scale):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetScalarModeToUseCellFieldData()
    mapper.SelectColorArray("label")
    mapper.SetLookupTable(table)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    look.EdgeVisibilityOn()
    look.SetEdgeColor(0.22, 0.22, 0.25)
    look.SetLineWidth(0.6 * scale)
    look.SetAmbient(0.45)
    look.SetDiffuse(0.68)
    return actor


def aim(camera, surface, arguments):
    """Looks at the cut, from a little to the side and from above (world z, or y where z is cut), as near as
    the whole surface fits."""
    axis = AXES[arguments.axis]
    up = numpy.eye(3)[1 if axis == 2 else 2]
    towards = (-1.0 if arguments.flip else 1.0) * numpy.eye(3)[axis]
    backward = unit(towards + 0.35 * numpy.cross(up, towards) + 0.25 * up)
    right = unit(numpy.cross(up, backward))
    view = numpy.stack([right, numpy.cross(backward, right), backward])  # rows: the camera's axes in the world

    half_angle = numpy.radians(10)
    slopes = 0.94 * numpy.tan(half_angle) * numpy.array([arguments.size[0] / arguments.size[1], 1.0])
    seen = vtk_to_numpy(surface.GetPoints().GetData()) @ view.T
    center = (seen.min(axis=0) + seen.max(axis=0)) / 2
    seen = seen - center
    distance = (seen[:, 2:] + abs(seen[:, :2]) / slopes).max()
    camera.SetViewAngle(2 * numpy.degrees(half_angle))
    camera.SetFocalPoint(center @ view)
    camera.SetPosition((center + [0, 0, distance]) @ view)
    camera.SetViewUp(up)


def unit(vector):
    return vector / numpy.linalg.norm(vector)


def lights():
    """Light comes from the viewer's upper left and, weaker, from the right: facets of a flat cut differ in shade."""
    for place, intensity in ((-0.6, 0.8, 1.0), 0.75), ((0.9, -0.1, 0.6), 0.35):
        light = vtk.vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*place)
        light.SetIntensity(intensity)
        yield light


def draw(surface, table, arguments):
    scale = 2  # drawn twice as large and averaged: smooth edges whatever the driver can do
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.AddActor(make_actor(surface, table, scale))
    window = vtk.vtkRenderWindow()
    window.OffScreenRenderingOn()
    window.SetMultiSamples(0)
    window.SetSize(*(scale * pixels for pixels in arguments.size))
    window.AddRenderer(renderer)
    for light in lights():
        renderer.AddLight(light)
    aim(renderer.GetActiveCamera(), surface, arguments)
    renderer.ResetCameraClippingRange()
    window.Render()

    picture = vtk.vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    smooth = vtk.vtkImageShrink3D()
    smooth.SetInputConnection(picture.GetOutputPort())
    smooth.SetShrinkFactors(scale, scale, 1)
    smooth.AveragingOn()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(smooth.GetOutputPort())
    writer.SetFileName(str(arguments.output))
    writer.Write()
    if writer.GetErrorCode():
        sys.exit(f"render_mesh.py: cannot write {arguments.output}")


def main():
    arguments = parse_arguments()
    ensure_display()
    vtk.vtkObject.GlobalWarningDisplayOff()  # failures are told in one line each
    grid = read_mesh(arguments.mesh)
    table = colours_of_labels(grid)
    surface = cut_open(grid, AXES[arguments.axis], arguments.fraction, arguments.flip)
    draw(surface, table, arguments)


if __name__ == "__main__":
    main()
