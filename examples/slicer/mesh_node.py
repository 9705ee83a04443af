"""Meshes a segmentation or a label map of 3D Slicer into a model node. README.md shows its use in Slicer's console."""

import numpy as np
import vtk

import podm


def grid_of(kji_labels, ijk_to_ras, names, **options):
    """Meshes labels as slicer.util.arrayFromVolume returns them, indexed k, j, i; returns a vtkUnstructuredGrid.

    ijk_to_ras is a vtkMatrix4x4. Points are in RAS, mm, the frame of Slicer's scene. `options` are those of
    podm.mesh."""
    affine = np.array([[ijk_to_ras.GetElement(row, column) for column in range(4)] for row in range(4)])
    return podm.mesh(kji_labels.transpose(2, 1, 0), affine=affine, names=names, space="RAS", **options).to_vtk()


def mesh_node(node, **options):
    """Meshes a vtkMRMLSegmentationNode or vtkMRMLLabelMapVolumeNode; returns a vtkMRMLModelNode with its colours."""
    import slicer
    is_segmentation = node.IsA("vtkMRMLSegmentationNode")
    labelmap = node
    if is_segmentation:  # Slicer numbers the segments, and makes a table of their names and colours
        labelmap = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLLabelMapVolumeNode", node.GetName() + " labels")
    try:
        if is_segmentation:
            slicer.modules.segmentations.logic().ExportAllSegmentsToLabelmapNode(
                node, labelmap, slicer.vtkSegmentation.EXTENT_REFERENCE_GEOMETRY)
        labelmap.CreateDefaultDisplayNodes()  # changes nothing if there is one
        colors = labelmap.GetDisplayNode().GetColorNode()
        labels = slicer.util.arrayFromVolume(labelmap)
        ijk_to_ras = vtk.vtkMatrix4x4()
        labelmap.GetIJKToRASMatrix(ijk_to_ras)
        values = [int(value) for value in np.unique(labels) if value > 0]
        names = {value: colors.GetColorName(value) or f"label {value}" for value in values}
        grid = grid_of(labels, ijk_to_ras, names, **options)
        transform = labelmap.GetTransformNodeID()
    finally:
        if is_segmentation:
            slicer.mrmlScene.RemoveNode(labelmap)
    model = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode", node.GetName() + " mesh")
    model.SetAndObserveMesh(grid)
    model.SetAndObserveTransformNodeID(transform)
    model.CreateDefaultDisplayNodes()
    display = model.GetDisplayNode()
    display.SetAndObserveColorNodeID(colors.GetID())
    display.SetActiveScalarName("label")
    display.SetActiveAttributeLocation(vtk.vtkAssignAttribute.CELL_DATA)
    display.SetScalarRangeFlag(display.UseColorNodeScalarRange)  # the label is the row of the table
    display.SetScalarVisibility(True)
    return model
