#!/usr/bin/python3
"""Writes one unstructured grid in every variant that VTK supports. Prints one file name per line.

usage: write_vtk_variants.py FOLDER
"""
import itertools
import pathlib
import sys

import vtk


def make_grid():
    """Returns two tetrahedra, one of them quadratic, a triangle and a pyramid, with arrays of many kinds."""
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for i in range(12):
        points.InsertNextPoint(i / 8, i * i / 4, -i / 16)  # legacy ASCII has few digits
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points)
    for cell_type, ids in ((vtk.VTK_TETRA, range(4)), (vtk.VTK_TRIANGLE, (7, 8, 9)),
                           (vtk.VTK_QUADRATIC_TETRA, range(10)), (vtk.VTK_PYRAMID, range(5))):
        grid.InsertNextCell(cell_type, len(ids), list(ids))

    labels = vtk.vtkIntArray()
    labels.SetName("CellEntityIds")
    for label in (3, 0, 200, 5):
        labels.InsertNextValue(label)
    vectors = vtk.vtkDoubleArray()
    vectors.SetName("a vector")
    vectors.SetNumberOfComponents(3)
    vectors.SetNumberOfTuples(12)
    vectors.Fill(0.5)
    vectors.GetRange(-1)  # creates information that VTK writes with the array
    bits = vtk.vtkBitArray()
    bits.SetName("bits")
    names = vtk.vtkStringArray()
    names.SetName("names")
    for i in range(4):
        bits.InsertNextValue(i % 2)
        names.InsertNextValue("x" * (40 * i))
    ids = vtk.vtkIdTypeArray()
    ids.SetName("ids")
    colors = vtk.vtkUnsignedCharArray()
    colors.SetName("colors")
    colors.SetNumberOfComponents(3)
    for i in range(4):
        ids.InsertNextValue(i)
        colors.InsertNextTuple3(i, 32, 10)
    note = vtk.vtkStringArray()
    note.SetName("note")
    note.InsertNextValue("of the whole grid")

    grid.GetFieldData().AddArray(note)
    grid.GetPointData().SetVectors(vectors)
    grid.GetCellData().SetScalars(colors)
    for array in (bits, names, ids, labels):
        grid.GetCellData().AddArray(array)
    return grid


def main():
    folder = pathlib.Path(sys.argv[1])
    grid = make_grid()
    xml = vtk.vtkXMLUnstructuredGridWriter()
    xml.SetInputData(grid)
    modes = {"ascii": xml.SetDataModeToAscii, "binary": xml.SetDataModeToBinary,
             "appended": xml.SetDataModeToAppended}
    headers = {"UInt32": xml.SetHeaderTypeToUInt32, "UInt64": xml.SetHeaderTypeToUInt64}
    orders = {"little": xml.SetByteOrderToLittleEndian, "big": xml.SetByteOrderToBigEndian}
    compressors = {"zlib": xml.SetCompressorTypeToZLib, "none": xml.SetCompressorTypeToNone}
    for mode, header, order, compressor, encode in itertools.product(modes, headers, orders, compressors, (0, 1)):
        name = f"{mode}-{header}-{order}-{compressor}-{encode}.vtu"
        modes[mode]()
        headers[header]()
        orders[order]()
        compressors[compressor]()
        xml.SetEncodeAppendedData(encode)
        xml.SetBlockSize(64)
        xml.SetFileName(str(folder / name))
        xml.Write()
        print(name)

    legacy = vtk.vtkUnstructuredGridWriter()
    legacy.SetInputData(grid)
    for version, coding in itertools.product((42, 51), ("ASCII", "Binary")):
        name = f"{version}-{coding}.vtk"
        legacy.SetFileVersion(version)
        getattr(legacy, f"SetFileTypeTo{coding}")()
        legacy.SetFileName(str(folder / name))
        legacy.Write()
        print(name)


main()
