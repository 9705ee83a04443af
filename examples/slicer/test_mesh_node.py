"""A label map becomes a model in the frame of the scene, with labels, names and colours.

Slicer is not needed: VTK is the real one, and a stand-in of Slicer's modules has the calls that the example makes, with
the behaviour of Slicer 5."""

import sys
import types
import unittest
import unittest.mock

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

import mesh_node

# The first axis points to the left and the other two are turned: voxels are 1, 1.25 and 2 mm wide.
COSINE, SINE = np.cos(0.3), np.sin(0.3)
IJK_TO_RAS = np.array([[-1, 0, 0, 30], [0, COSINE, -SINE, -12], [0, SINE, COSINE, 7], [0, 0, 0, 1]]) @ np.diag(
    [1, 1.25, 2, 1])
CENTERS = {1: (10, 14, 9), 2: (22, 14, 9)}  # of two balls, as i, j, k
RADIUS_MM = 8
COLORS = [("(none)", 0, 0, 0), ("liver", 0.9, 0.3, 0.2), ("left kidney", 0.2, 0.4, 0.9)]


def kji_labels():
    """Returns balls of labels 1 and 2, as slicer.util.arrayFromVolume does."""
    labels = np.zeros((18, 28, 32), np.int16)
    k, j, i = np.ogrid[:18, :28, :32]
    for value, (ci, cj, ck) in CENTERS.items():
        labels[(i - ci)**2 + (1.25 * (j - cj))**2 + (2.0 * (k - ck))**2 < RADIUS_MM**2] = value
    return labels


def vtk_matrix(array):
    matrix = vtk.vtkMatrix4x4()
    matrix.DeepCopy(array.ravel())
    return matrix


def centers_of(grid):
    """Returns the center of the cells of each label."""
    filter_ = vtk.vtkCellCenters()
    filter_.SetInputData(grid)
    filter_.Update()
    centers = vtk_to_numpy(filter_.GetOutput().GetPoints().GetData())
    labels = vtk_to_numpy(grid.GetCellData().GetArray("label"))
    volumes = vtk.vtkCellSizeFilter()
    volumes.SetInputData(grid)
    volumes.Update()
    volumes = vtk_to_numpy(volumes.GetOutput().GetCellData().GetArray("Volume"))
    return {value: np.average(centers[labels == value], axis=0, weights=volumes[labels == value]) for value in CENTERS}


def expected_center(value):
    return (IJK_TO_RAS @ (*CENTERS[value], 1))[:3]


class Node:
    """A node of the scene. A class name decides what it is."""

    def __init__(self, class_name, name):
        self.class_name, self.name, self.display, self.transform = class_name, name, None, None

    def IsA(self, class_name):
        return class_name == self.class_name

    def GetName(self):
        return self.name

    def GetID(self):
        return f"{self.class_name}1"

    def GetDisplayNode(self):
        return self.display

    def GetTransformNodeID(self):
        return self.transform

    def SetAndObserveTransformNodeID(self, transform):
        self.transform = transform


class ColorTable(Node):
    def GetColorName(self, index):
        if type(index) is not int:
            raise TypeError("GetColorName argument 1: an int is expected")  # as VTK's wrappers
        return COLORS[index][0] if index < len(COLORS) else None


class LabelMap(Node):
    def fill(self, labels):
        self.image = vtk.vtkImageData()
        self.image.SetDimensions(*labels.shape[::-1])
        self.image.GetPointData().SetScalars(numpy_to_vtk(labels.ravel(), deep=True))

    def CreateDefaultDisplayNodes(self):
        if self.display is None:
            self.display = Display("vtkMRMLLabelMapVolumeDisplayNode", "")
            self.display.colors = ColorTable("vtkMRMLColorTableNode", "colors")

    def GetIJKToRASMatrix(self, matrix):
        matrix.DeepCopy(IJK_TO_RAS.ravel())


class Display(Node):
    UseColorNodeScalarRange = 2

    def GetColorNode(self):
        return self.colors

    def SetAndObserveColorNodeID(self, colors):
        self.color_id = colors

    def SetActiveScalarName(self, name):
        self.scalars = name

    def SetActiveAttributeLocation(self, location):
        self.location = location

    def SetScalarRangeFlag(self, flag):
        self.range = flag

    def SetScalarVisibility(self, is_visible):
        self.is_visible = is_visible


class Model(Node):
    def SetAndObserveMesh(self, mesh):
        self.mesh = mesh

    def CreateDefaultDisplayNodes(self):
        self.display = Display("vtkMRMLModelDisplayNode", "")


class Scene:
    CLASSES = {"vtkMRMLLabelMapVolumeNode": LabelMap, "vtkMRMLModelNode": Model}

    def __init__(self):
        self.nodes = []

    def AddNewNodeByClass(self, class_name, name):
        self.nodes.append(self.CLASSES[class_name](class_name, name))
        return self.nodes[-1]

    def RemoveNode(self, node):
        self.nodes.remove(node)


def array_from_volume(node):
    return vtk_to_numpy(node.image.GetPointData().GetScalars()).reshape(node.image.GetDimensions()[::-1])


def export_all_segments(segmentation, labelmap, extent):
    """Fills the label map as Slicer does, with a table of colours and the parent's transform."""
    if extent != "reference geometry":
        raise ValueError(extent)
    labelmap.fill(kji_labels())
    labelmap.CreateDefaultDisplayNodes()
    labelmap.SetAndObserveTransformNodeID(segmentation.GetTransformNodeID())


def stand_in():
    """Returns a module with the parts of slicer that the example uses."""
    logic = types.SimpleNamespace(ExportAllSegmentsToLabelmapNode=export_all_segments)
    slicer = types.ModuleType("slicer")
    slicer.mrmlScene = Scene()
    slicer.util = types.SimpleNamespace(arrayFromVolume=array_from_volume)
    slicer.vtkSegmentation = types.SimpleNamespace(EXTENT_REFERENCE_GEOMETRY="reference geometry")
    slicer.modules = types.SimpleNamespace(segmentations=types.SimpleNamespace(logic=lambda: logic))
    return slicer


class GridOfLabels(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.grid = mesh_node.grid_of(kji_labels(), vtk_matrix(IJK_TO_RAS), {1: "liver", 2: "left kidney"}, radius=4)

    def test_each_label_lies_at_its_place_in_ras(self):
        for value, center in centers_of(self.grid).items():
            np.testing.assert_allclose(center, expected_center(value), atol=0.5)

    def test_cells_are_positive_tetrahedra_with_the_volumes_of_the_voxels(self):
        self.assertEqual(set(vtk_to_numpy(self.grid.GetCellTypesArray())), {vtk.VTK_TETRA})
        corners = vtk_to_numpy(self.grid.GetPoints().GetData())[
            vtk_to_numpy(self.grid.GetCells().GetConnectivityArray()).reshape(-1, 4)]
        volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
        self.assertGreater(volumes.min(), 0)
        labels = vtk_to_numpy(self.grid.GetCellData().GetArray("label"))
        for value in CENTERS:
            of_voxels = (kji_labels() == value).sum() * 2.5
            self.assertLess(abs(volumes[labels == value].sum() / of_voxels - 1), 0.1)

    def test_names_are_in_the_field_data(self):
        fields = self.grid.GetFieldData()
        self.assertEqual([fields.GetArray(f"label:{name}").GetTuple1(0) for name in ("liver", "left kidney")], [1, 2])

    def test_another_frame_is_refused(self):
        with self.assertRaisesRegex(TypeError, "space"):
            mesh_node.grid_of(kji_labels(), vtk_matrix(IJK_TO_RAS), {}, space="LPS")


class MeshOfNode(unittest.TestCase):
    def setUp(self):
        self.slicer = stand_in()
        patch = unittest.mock.patch.dict(sys.modules, slicer=self.slicer)
        patch.start()
        self.addCleanup(patch.stop)

    def assert_model(self, model, name):
        self.assertTrue(model.IsA("vtkMRMLModelNode"))
        self.assertEqual((model.GetName(), model.GetTransformNodeID()), (name, "vtkMRMLLinearTransformNode7"))
        for value, center in centers_of(model.mesh).items():
            np.testing.assert_allclose(center, expected_center(value), atol=0.5)
        display = model.GetDisplayNode()
        self.assertEqual((display.color_id, display.scalars, display.location, display.range, display.is_visible),
                         ("vtkMRMLColorTableNode1", "label", vtk.vtkAssignAttribute.CELL_DATA,
                          Display.UseColorNodeScalarRange, True))
        self.assertIsNotNone(model.mesh.GetFieldData().GetArray("label:left kidney"))

    def label_map(self, labels):
        node = LabelMap("vtkMRMLLabelMapVolumeNode", "seg-label")
        node.fill(labels)
        node.SetAndObserveTransformNodeID("vtkMRMLLinearTransformNode7")
        return node

    def segmentation(self):
        node = Node("vtkMRMLSegmentationNode", "seg")
        node.SetAndObserveTransformNodeID("vtkMRMLLinearTransformNode7")
        return node

    def test_a_label_map_stays_and_a_model_is_added(self):
        model = mesh_node.mesh_node(self.label_map(kji_labels()), radius=4)
        self.assert_model(model, "seg-label mesh")
        self.assertEqual(self.slicer.mrmlScene.nodes, [model])

    def test_a_label_without_a_row_in_the_table_of_colours_has_its_value_as_name(self):
        model = mesh_node.mesh_node(self.label_map(kji_labels() * 3), radius=4)
        self.assertIsNotNone(model.mesh.GetFieldData().GetArray("label:label 6"))

    def test_a_segmentation_leaves_only_the_model(self):
        model = mesh_node.mesh_node(self.segmentation(), radius=4)
        self.assert_model(model, "seg mesh")
        self.assertEqual(self.slicer.mrmlScene.nodes, [model])

    def test_an_error_leaves_nothing_in_the_scene(self):
        with self.assertRaisesRegex(ValueError, "radius"):
            mesh_node.mesh_node(self.segmentation(), radius=-1)
        self.assertEqual(self.slicer.mrmlScene.nodes, [])


if __name__ == "__main__":
    unittest.main()
