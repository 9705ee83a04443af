"""Components of an image's labels (voxels that share faces), and their fate in a mesh."""
import itertools

import numpy
from scipy import ndimage
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components


def image_components(volume, background=0):
    """Returns the number of each voxel's component, -1 in the background, and the label of each component."""
    number = numpy.full(volume.shape, -1)
    labels = []
    values, dense = numpy.unique(volume, return_inverse=True)
    for index, box in enumerate(ndimage.find_objects(dense.reshape(volume.shape) + 1)):
        if values[index] == background:
            continue
        found, count = ndimage.label(volume[box] == values[index])
        number[box][found > 0] = found[found > 0] - 1 + len(labels)
        labels += [values[index]] * count
    return number, numpy.array(labels)


def mesh_components(cells, labels):
    """Returns the number of each cell's component: cells of one label that share facets."""
    facets = numpy.concatenate([numpy.sort(numpy.delete(cells, corner, 1), 1) for corner in range(4)])
    owner = numpy.tile(numpy.arange(len(cells)), 4)
    order = numpy.lexsort(facets.T)
    facets, owner = facets[order], owner[order]
    is_shared = (facets[1:] == facets[:-1]).all(1)
    a, b = owner[:-1][is_shared], owner[1:][is_shared]
    is_joined = labels[a] == labels[b]
    a, b = a[is_joined], b[is_joined]
    return connected_components(coo_matrix((numpy.ones(len(a)), (a, b)), shape=(len(cells),) * 2), directed=False)[1]


def circumcenters(points, cells):
    origin = points[cells[:, 0]]
    edges = points[cells[:, 1:]] - origin[:, None]
    return origin + numpy.linalg.solve(edges, 0.5 * (edges ** 2).sum(2)[..., None])[..., 0]


def component_of_cells(volume, number, affine, centers, labels):
    """Returns the component of the nearest of the eight voxels around a cell's circumcenter that have the cell's
    label."""
    at = centers @ numpy.linalg.inv(affine[:, :3]).T - numpy.linalg.solve(affine[:, :3], affine[:, 3])
    low = numpy.floor(at).astype(int)
    found, nearest = numpy.full(len(at), -1), numpy.full(len(at), numpy.inf)
    for step in itertools.product((0, 1), repeat=3):
        corner = low + step
        is_inside = ((corner >= 0) & (corner < volume.shape)).all(1)
        voxel = tuple(numpy.where(is_inside[:, None], corner, 0).T)
        distance = numpy.where(is_inside & (volume[voxel] == labels), ((at - corner) ** 2).sum(1), numpy.inf)
        is_nearer = distance < nearest
        found[is_nearer], nearest[is_nearer] = number[voxel][is_nearer], distance[is_nearer]
    return found


def pieces_of_components(volume, number, num_components, affine, mesh):
    """Returns the number of pieces of each component of the image in the mesh; 0 if it is lost."""
    of_image = component_of_cells(volume, number, affine, circumcenters(mesh.points, mesh.cells), mesh.labels)
    pairs = numpy.unique(numpy.stack([of_image, mesh_components(mesh.cells, mesh.labels)], 1), axis=0)
    return numpy.bincount(pairs[pairs[:, 0] >= 0, 0], minlength=num_components)
