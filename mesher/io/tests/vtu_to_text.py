#!/usr/bin/python3
"""Reads a VTU file, or an index of pieces, with VTK and prints its contents, one item per line, doubles exactly.

usage: vtu_to_text.py FILE.vtu|FILE.pvtu
"""
import sys

import vtk


def arrays(data):
    return [data.GetAbstractArray(i) for i in range(data.GetNumberOfArrays())]


def values(array):
    return [array.GetValue(i) for i in range(array.GetNumberOfValues())]


def main():
    is_index = sys.argv[1].endswith(".pvtu")
    reader = vtk.vtkXMLPUnstructuredGridReader() if is_index else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(sys.argv[1])
    failures = []
    reader.AddObserver("ErrorEvent", lambda *_: failures.append(1))
    reader.Update()
    if failures:
        sys.exit(1)
    grid = reader.GetOutput()

    print("points", grid.GetNumberOfPoints())
    for i in range(grid.GetNumberOfPoints()):
        print(*(c.hex() for c in grid.GetPoint(i)))
    print("cells", grid.GetNumberOfCells())
    for i in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(i)
        print(cell.GetCellType(), *(cell.GetPointId(j) for j in range(cell.GetNumberOfPoints())))
    for kind, data in (("point", grid.GetPointData()), ("cell", grid.GetCellData())):
        for array in arrays(data):
            print(kind, array.GetName(), array.GetNumberOfValues())
            for value in values(array):
                print(value)

    ids = grid.GetPointData().GetGlobalIds()
    print("globalids", ids.GetName() if ids else "none")
    for array in arrays(grid.GetFieldData()):
        print("field", array.GetName() + "\t" + " ".join(map(str, values(array))))

    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.ComputeSumOn()
    sizes.Update()
    for name in ("Area", "Volume"):
        print(name.lower(), sizes.GetOutput().GetFieldData().GetArray(name).GetValue(0).hex())


main()
