"""The legend of a picture's colours, in a strip on its right."""
import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from .colours import rgb

MOST_LABELS = 30
RAMP_STEPS = 96


class Legend:
    """Rectangles and texts, placed in lines of text from the top and in line heights from the left."""

    width = 0.22  # fraction of the picture

    def __init__(self, num_lines):
        self._num_lines = num_lines
        self._rectangles = []  # (left, top, right, bottom, colour)
        self._texts = []  # (left, line, text)

    @classmethod
    def of_labels(cls, labels):
        """Makes a legend from pairs of name and colour, in the order of listing."""
        shown = labels[:MOST_LABELS]
        legend = cls(max(24, len(shown) + 1))
        for line, (name, colour) in enumerate(shown):
            legend._rectangles.append((0, line + 0.15, 0.9, line + 0.85, colour))
            legend._texts.append((1.3, line, name))
        if len(labels) > len(shown):
            legend._texts.append((1.3, len(shown), f"and {len(labels) - len(shown)} more"))
        return legend

    @classmethod
    def of_ramp(cls, title, low, high, colours):
        """Makes a ramp with the lowest value, in the first colour, at the bottom."""
        legend, height = cls(24), 14
        words = title.split(", ")
        legend._texts += [(0, line, text) for line, text in enumerate(words)]
        top = len(words) + 0.5
        shares = (numpy.arange(RAMP_STEPS) + 0.5) / RAMP_STEPS
        steps = numpy.linspace(0, 1, len(colours))
        for share in shares:
            colour = tuple(numpy.interp(share, steps, colours[:, channel]) for channel in range(3))
            at = top + height * (1 - share)
            legend._rectangles.append((0, at - height / RAMP_STEPS / 2, 1.2, at + height / RAMP_STEPS / 2, colour))
        for tick in _round_numbers(low, high):
            legend._texts.append((1.7, top + height * (high - tick) / (high - low) - 0.5, f"{tick:.4g}"))
        return legend

    def renderer(self, left_share, window_size, background):
        strip = vtk.vtkRenderer()
        strip.SetViewport(left_share, 0, 1, 1)
        strip.SetBackground(*rgb(background))
        line_px = 0.92 * min(window_size[1] / self._num_lines, self.width * window_size[0] / 9)
        top_px = 0.96 * window_size[1]
        boxes = [(left * line_px, top_px - bottom * line_px, right * line_px, top_px - top * line_px, colour)
                 for left, top, right, bottom, colour in self._rectangles]
        strip.AddActor2D(_boxes(boxes))
        for left, line, text in self._texts:
            strip.AddActor2D(_text(text, left * line_px, top_px - (line + 0.5) * line_px, 0.62 * line_px, background))
        return strip


def _round_numbers(low, high):
    """Returns four to ten multiples of 1, 2 or 5 times a power of ten."""
    power = 10.0 ** numpy.floor(numpy.log10((high - low) / 4))
    step = power * max(factor for factor in (1, 2, 5) if factor * power <= (high - low) / 4)
    return step * numpy.arange(numpy.ceil(low / step), numpy.floor(high / step * (1 + 1e-9)) + 1)


def _boxes(boxes):
    """Draws boxes given as (left, bottom, right, top, colour) in pixels."""
    corners = [(x, y, 0) for left, bottom, right, top, _ in boxes
               for x, y in ((left, bottom), (right, bottom), (right, top), (left, top))]
    points, quads = vtk.vtkPoints(), vtk.vtkCellArray()
    for corner in corners:
        points.InsertNextPoint(*corner)
    for first in range(0, len(corners), 4):
        quads.InsertNextCell(4, range(first, first + 4))
    drawing = vtk.vtkPolyData()
    drawing.SetPoints(points)
    drawing.SetPolys(quads)
    colours = numpy.round(255 * numpy.array([colour for *_, colour in boxes])).astype(numpy.uint8)
    drawing.GetCellData().SetScalars(numpy_to_vtk(colours, deep=True))
    mapper = vtk.vtkPolyDataMapper2D()
    mapper.SetInputData(drawing)
    actor = vtk.vtkActor2D()
    actor.SetMapper(mapper)
    return actor


def _text(words, left_px, middle_px, size_px, background):
    actor = vtk.vtkTextActor()
    actor.SetInput(words)
    actor.SetPosition(left_px, middle_px)
    look = actor.GetTextProperty()
    look.SetFontFamilyToArial()
    look.SetFontSize(max(int(size_px), 8))
    look.SetVerticalJustificationToCentered()
    is_dark = numpy.dot(rgb(background), (0.3, 0.6, 0.1)) < 0.5
    look.SetColor(*((0.93, 0.93, 0.91) if is_dark else (0.12, 0.14, 0.19)))
    return actor
