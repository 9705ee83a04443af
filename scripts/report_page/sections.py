"""Flat cuts through a mesh that has too many cells to be turned in a page."""
import base64
import io

import numpy
from figures import style
from figures.plane_cut import plane_cut
from matplotlib.collections import PolyCollection
from views.colours import colours_of_labels

AXES = "xyz"


def sections_html(mesh):
    """Draws three pictures: cells cut by planes through the middle of the mesh."""
    figure, axes = style.new_figure(columns=3, width=12, height=4.4)
    colours = colours_of_labels(mesh)
    for one, across in zip(axes, (2, 1, 0)):
        _draw(one, mesh, across, colours)
    style.finish(figure, "")
    figure.patch.set(alpha=1, facecolor="white")  # the ink stays dark in a dark page
    made = io.BytesIO()
    figure.savefig(made, format="png", dpi=150)
    data = base64.b64encode(made.getvalue()).decode()
    return ('<img class="sections" alt="The mesh cut by three planes, cells coloured by label" '
            f'src="data:image/png;base64,{data}">')


def _draw(axes, mesh, across, colours):
    others = [axis for axis in range(3) if axis != across]
    points = mesh.points[:, [*others, across]]
    middle = (points[:, 2].min() + points[:, 2].max()) / 2
    polygons, cells = plane_cut(points, mesh.cells, middle)
    values, positions = numpy.unique(mesh.labels[cells], return_inverse=True)
    faces = numpy.array([colours[int(value)] for value in values])[positions]
    axes.add_collection(PolyCollection(polygons, facecolors=faces, edgecolors=style.INK, linewidths=0.05))
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set(title=f"{AXES[across]} = {middle:.4g} mm", xlabel=f"{AXES[others[0]]}, mm",
             ylabel=f"{AXES[others[1]]}, mm")
