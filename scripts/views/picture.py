"""Draws cells of a mesh by VTK. Cells are drawn whole, so that the cut shows tetrahedra."""
from dataclasses import dataclass

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

from .colours import RAMP, colours_of_labels, rgb
from .legend import Legend
from .quality import MEASURES, measured

SUPERSAMPLING = 2  # drawn larger and averaged: smooth edges with any driver
FACETS_SEEN_AS_LINES_PX = 4  # shorter edges would cover the colours


@dataclass(frozen=True)
class Look:
    """Settings of the picture. Azimuth and elevation are degrees from the direction that faces the cut."""

    towards: numpy.ndarray  # from the mesh to the viewer who faces the cut, of length 1
    colour: str  # "label" or one of quality.MEASURES
    camera_deg: tuple
    zoom: float
    size: tuple  # pixels
    background: str  # "#rrggbb"
    has_legend: bool


def png_of(mesh, cells, look):
    """Returns the bytes of a picture of some cells of the mesh."""
    surface = _surface(mesh, cells)
    drawn = cells[vtk_to_numpy(surface.GetCellData().GetArray("cell"))]  # one entry per facet
    colours, legend = _colours(mesh, drawn, look)
    surface.GetCellData().SetScalars(numpy_to_vtk(colours, deep=True))
    window = vtk.vtkRenderWindow()
    window.OffScreenRenderingOn()
    window.SetMultiSamples(0)
    window.SetSize(*(SUPERSAMPLING * pixels for pixels in look.size))
    share = 1 - (legend.width if legend else 0)
    scene = vtk.vtkRenderer()
    scene.SetViewport(0, 0, share, 1)
    scene.SetBackground(*rgb(look.background))
    for light in _lights():
        scene.AddLight(light)
    pixels_per_mm = _aim(scene.GetActiveCamera(), surface, look, share)
    scene.AddActor(_actor(surface, pixels_per_mm))
    window.AddRenderer(scene)
    if legend:
        window.AddRenderer(legend.renderer(share, window.GetSize(), look.background))
    scene.ResetCameraClippingRange()
    window.Render()
    return _png(window)


def _colours(mesh, cells, look):
    """Returns red, green and blue of each of `cells`, 0 to 255, and the legend, or None if it was not requested."""
    if look.colour == "label":
        table = colours_of_labels(mesh)
        values, positions = numpy.unique(mesh.labels[cells], return_inverse=True)
        colours = numpy.array([rgb(table[int(value)]) for value in values])[positions]
        seen = set(values.tolist())
        legend = Legend.of_labels([(mesh.name_of(value), rgb(colour)) for value, colour in table.items()
                                   if value in seen])
    else:
        colours, legend = _colours_of_quality(mesh, cells, MEASURES[look.colour], measured(mesh, look.colour))
    return numpy.round(255 * colours).astype(numpy.uint8), legend if look.has_legend else None


def _colours_of_quality(mesh, cells, measure, values):
    """Gives bad cells bright colours. A flat cell, which has no number, counts as the worst."""
    low = numpy.nanmin(values) if measure.low is None else measure.low
    high = numpy.nanmax(values) if measure.high is None else measure.high
    high = high if high > low else low + 1
    badness = numpy.clip((values[cells] - low) / (high - low), 0, 1)
    badness = numpy.nan_to_num(1 - badness if measure.is_low_bad else badness, nan=1)
    ramp = numpy.array([rgb(colour) for colour in RAMP])
    steps = numpy.linspace(0, 1, len(ramp))
    colours = numpy.stack([numpy.interp(badness, steps, ramp[:, channel]) for channel in range(3)], axis=1)
    return colours, Legend.of_ramp(measure.title, low, high, ramp[::-1] if measure.is_low_bad else ramp)


def _surface(mesh, cells):
    """Returns the outer facets of the cells. The array `cell` has the position of each facet's cell in `cells`."""
    used, corners = numpy.unique(mesh.cells[cells], return_inverse=True)
    corners = corners.reshape(-1, 4)
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(mesh.points[used], deep=True))
    array = vtk.vtkCellArray()
    array.SetData(numpy_to_vtkIdTypeArray(numpy.arange(0, 4 * len(corners) + 1, 4), deep=True),
                  numpy_to_vtkIdTypeArray(corners.ravel().astype(numpy.int64), deep=True))
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points)
    grid.SetCells(vtk.VTK_TETRA, array)
    numbers = numpy_to_vtkIdTypeArray(numpy.arange(len(corners)), deep=True)
    numbers.SetName("cell")
    grid.GetCellData().AddArray(numbers)
    outside = vtk.vtkDataSetSurfaceFilter()
    outside.SetInputData(grid)
    outside.Update()
    return outside.GetOutput()


def _actor(surface, pixels_per_mm):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetScalarModeToUseCellData()
    mapper.SetColorModeToDirectScalars()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetInterpolationToFlat()
    edge_px = pixels_per_mm * _typical_edge_mm(surface)
    if edge_px > FACETS_SEEN_AS_LINES_PX:
        look.EdgeVisibilityOn()
        look.SetEdgeColor(0.22, 0.22, 0.25)
        look.SetLineWidth(SUPERSAMPLING * min(0.6, edge_px / 20))
    look.SetAmbient(0.45)
    look.SetDiffuse(0.68)
    return actor


def _typical_edge_mm(surface):
    triangles = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    points = vtk_to_numpy(surface.GetPoints().GetData())
    return float(numpy.median(numpy.linalg.norm(points[triangles[:, 0]] - points[triangles[:, 1]], axis=1)))


def _aim(camera, surface, look, share):
    """Moves the camera as near as the whole surface fits, times the zoom. Returns pixels per mm at the surface's
    nearest point."""
    right, up, backward = axes = camera_axes(look.towards, *look.camera_deg)
    half_angle = numpy.radians(10)
    slopes = 0.94 * numpy.tan(half_angle) * numpy.array([share * look.size[0] / look.size[1], 1.0])
    seen = vtk_to_numpy(surface.GetPoints().GetData()) @ axes.T
    center = (seen.min(axis=0) + seen.max(axis=0)) / 2
    seen = seen - center
    distance = (seen[:, 2:] + abs(seen[:, :2]) / slopes).max()
    camera.SetViewAngle(2 * numpy.degrees(half_angle))
    camera.SetFocalPoint(center @ axes)
    camera.SetPosition((center + [0, 0, distance]) @ axes)
    camera.SetViewUp(up)
    camera.Zoom(look.zoom)
    nearest = max(distance - seen[:, 2].max(), 1e-9 * distance)
    return look.zoom * look.size[1] / (2 * nearest * numpy.tan(half_angle))


def camera_axes(towards, azimuth_deg, elevation_deg):
    """Returns as rows the viewer's right, up and backward axes in the world. Up is world z, or y if the viewer faces
    along z. Azimuth turns to the viewer's right about it, elevation goes up."""
    world_up = numpy.eye(3)[1 if abs(towards[2]) > 0.9 else 2]
    right = _unit(numpy.cross(world_up, towards))
    level_up = numpy.cross(towards, right)
    azimuth, elevation = numpy.radians([azimuth_deg, elevation_deg])
    level = numpy.cos(azimuth) * towards + numpy.sin(azimuth) * right
    backward = numpy.cos(elevation) * level + numpy.sin(elevation) * level_up
    right = numpy.cos(azimuth) * right - numpy.sin(azimuth) * towards
    return numpy.stack([right, numpy.cross(backward, right), backward])


def _unit(vector):
    return vector / numpy.linalg.norm(vector)


def _lights():
    """Yields a light from the viewer's upper left and a weaker one from the right. Facets of a flat cut then differ in
    shade."""
    for place, intensity in ((-0.6, 0.8, 1.0), 0.75), ((0.9, -0.1, 0.6), 0.35):
        light = vtk.vtkLight()
        light.SetLightTypeToCameraLight()
        light.SetPosition(*place)
        light.SetIntensity(intensity)
        yield light


def _png(window):
    picture = vtk.vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    smooth = vtk.vtkImageShrink3D()
    smooth.SetInputConnection(picture.GetOutputPort())
    smooth.SetShrinkFactors(SUPERSAMPLING, SUPERSAMPLING, 1)
    smooth.AveragingOn()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(smooth.GetOutputPort())
    writer.WriteToMemoryOn()
    writer.Write()
    return vtk_to_numpy(writer.GetResult()).tobytes()
