"""Reads grids with VTK's own reader and prints what is in them as JSON, for tests.

Usage: read_fields.py FILE...   a .vtu gives one object, a .pvd one for each of its frames, in its order
"""
import json
import os
import sys
import xml.etree.ElementTree as xml

from vtkmodules.vtkCommonCore import vtkCommand
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

LINE, TRIANGLE = 3, 5
RISER, PAYLOAD = 5, 6  # of the cell array "kind"


def arrays_of(data):
    found = {}
    for i in range(data.GetNumberOfArrays()):
        array = data.GetArray(i)
        ranges = [array.GetRange(k) for k in range(array.GetNumberOfComponents())]
        found[array.GetName()] = {
            "type": array.GetDataTypeAsString(),
            "tuples": array.GetNumberOfTuples(),
            "components": array.GetNumberOfComponents(),
            "min": min(r[0] for r in ranges),
            "max": max(r[1] for r in ranges),
            "sum": sum(array.GetComponent(t, 0) for t in range(array.GetNumberOfTuples())),
        }
    return found


def area_of(grid, cell):
    a, b, c = (grid.GetPoint(cell.GetPointId(k)) for k in range(3))
    u, v = [q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return 0.5 * sum(x * x for x in n) ** 0.5


def read(file):
    complaints = []
    reader = vtkXMLUnstructuredGridReader()
    reader.AddObserver(vtkCommand.ErrorEvent, lambda *_: complaints.append("error"))
    reader.AddObserver(vtkCommand.WarningEvent, lambda *_: complaints.append("warning"))
    reader.SetFileName(file)
    reader.Update()
    grid = reader.GetOutput()
    points, cells = grid.GetPointData(), grid.GetCellData()
    kind, tension = cells.GetArray("kind"), cells.GetArray("cable_tension_N")
    types, area, pull, payload, by_kind = {}, 0.0, [0.0, 0.0, 0.0], None, {}
    of_kind = {}
    for i in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(i)
        types[cell.GetCellType()] = types.get(cell.GetCellType(), 0) + 1
        if cell.GetCellType() == TRIANGLE:
            area += area_of(grid, cell)
        k = int(kind.GetValue(i))
        of_kind[k] = of_kind.get(k, 0) + 1
        if k == PAYLOAD:
            payload = cell.GetPointId(0)
        ranges = by_kind.setdefault(k, {})
        for n in range(cells.GetNumberOfArrays()):
            low, high = ranges.get(cells.GetArrayName(n), (float("inf"), float("-inf")))
            value = cells.GetArray(n).GetComponent(i, 0)
            ranges[cells.GetArrayName(n)] = (min(low, value), max(high, value))
    # What the risers pull on the payload: tension times direction of those that end there.
    for i in range(grid.GetNumberOfCells() if tension else 0):
        cell = grid.GetCell(i)
        if cell.GetCellType() != LINE or kind.GetValue(i) != RISER:
            continue
        ends = [cell.GetPointId(0), cell.GetPointId(1)]
        if payload not in ends:
            continue
        far = ends[0] if ends[1] == payload else ends[1]
        arm = [q - p for p, q in zip(grid.GetPoint(payload), grid.GetPoint(far))]
        length = sum(x * x for x in arm) ** 0.5
        pull = [p + tension.GetValue(i) * x / length for p, x in zip(pull, arm)]
    time = grid.GetFieldData().GetArray("TimeValue")
    velocity = points.GetArray("velocity_m_s")
    return {
        "complaints": complaints,
        "time": time.GetValue(0) if time else None,
        "points": grid.GetNumberOfPoints(),
        "cells": {str(t): n for t, n in types.items()},
        "kinds": {str(k): n for k, n in of_kind.items()},
        "point_data": arrays_of(points),
        "cell_data": arrays_of(cells),
        "ranges": {str(k): r for k, r in by_kind.items()},
        "bounds": grid.GetBounds(),
        "fabric_area": area,
        "payload_position": grid.GetPoint(payload),
        "payload_velocity": velocity.GetTuple(payload) if velocity else None,
        "pull_on_payload": sum(p * p for p in pull) ** 0.5,
    }


def main():
    found = []
    for file in sys.argv[1:]:
        if not file.endswith(".pvd"):
            found.append(read(file))
            continue
        directory = os.path.dirname(os.path.abspath(file))
        for entry in xml.parse(file).getroot().iter("DataSet"):
            frame = read(os.path.join(directory, entry.get("file")))
            frame["timestep"] = float(entry.get("timestep"))
            found.append(frame)
    json.dump(found, sys.stdout)


main()
