#!/usr/bin/env python3
"""Reads .vtp files, or all files of a .pvd collection, with VTK's own reader and checks them.

    pip install vtk
    python3 check_vtp.py FILE... [--points N] [--dump FRAME.dump]

Prints the number of points and the bounds of each file. Exits with 1 when VTK reports an error, when points, point data,
cells, time or provenance are missing or not finite, when a collection names another time than its file, when the number of
points is not N, or when any value differs in any bit from the first frame of a LAMMPS dump of the same moment.
"""

import argparse
import math
import os
import sys
import xml.etree.ElementTree as ElementTree

import numpy
import vtk
from vtk.util.numpy_support import vtk_to_numpy

VECTORS = {
    "Points": ["x", "y", "z"],
    "velocity": ["vx", "vy", "vz"],
    "angular_velocity": ["omegax", "omegay", "omegaz"],
    "force": ["fx", "fy", "fz"],
    "torque": ["tqx", "tqy", "tqz"],
}
FIELDS = ["TimeValue", "step", "cell_lo", "cell_hi", "cell_periodic", "program_version", "plan_fingerprint", "created"]


class Mismatch(Exception):
    """What is wrong with a file."""


def require(condition, message):
    if not condition:
        raise Mismatch(message)


def read(path):
    """The poly data of a file and its arrays by name, as NumPy arrays."""
    require(os.path.isfile(path), "no such file")
    errors = []
    reader = vtk.vtkXMLPolyDataReader()
    reader.AddObserver("ErrorEvent", lambda *_: errors.append("error event"))
    require(reader.CanReadFile(path), "vtkXMLPolyDataReader cannot read this")
    reader.SetFileName(path)
    reader.Update()
    require(not errors and reader.GetErrorCode() == 0, "vtkXMLPolyDataReader reported an error")
    data = reader.GetOutput()
    arrays = {}
    if data.GetNumberOfPoints() > 0:
        arrays["Points"] = vtk_to_numpy(data.GetPoints().GetData())
    for index in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(index)
        arrays[array.GetName()] = vtk_to_numpy(array)
    return data, arrays


def read_dump(path):
    """Columns of the first frame of a LAMMPS dump, and its time and step."""
    with open(path, encoding="utf-8") as lines:
        step = time = None
        for line in lines:
            if line.startswith("ITEM: TIMESTEP"):
                step = int(next(lines))
            elif line.startswith("ITEM: NUMBER OF ATOMS"):
                times = [word[5:] for word in line.split() if word.startswith("time=")]
                time = float(times[0]) if times else None
                count = int(next(lines))
            elif line.startswith("ITEM: ATOMS"):
                names = line.split()[2:]
                rows = [next(lines).split() for _ in range(count)]
                values = numpy.array(rows, dtype=float).reshape(count, len(names))
                return {name: values[:, k] for k, name in enumerate(names)}, step, time
    raise Mismatch(f"{path} has no frame")


def check(path, arguments, collection_time):
    data, arrays = read(path)
    points = data.GetNumberOfPoints()
    bounds = data.GetBounds() if points else ()
    print(f"{path}: {points} points, bounds {' '.join(f'{b:.9g}' for b in bounds)}, arrays {' '.join(arrays)}")
    require(arguments.points is None or points == arguments.points, f"{arguments.points} points expected")
    require(data.GetNumberOfVerts() == (points > 0), "one poly-vertex cell expected")
    require(data.GetNumberOfCells() == data.GetNumberOfVerts(), "no other cell expected")
    if points:
        cell = vtk.vtkIdList()
        data.GetCellPoints(0, cell)
        require(cell.GetNumberOfIds() == points, "the cell must have all points")
        for name in ["id", "type", "radius", "mass", "velocity"]:
            require(name in arrays, f"{name} is missing")
        for name, values in arrays.items():
            require(len(values) == points, f"{name} has {len(values)} values")
            require(numpy.isfinite(values).all(), f"{name} is not finite")
    field = data.GetFieldData()
    for name in FIELDS:
        array = field.GetAbstractArray(name)
        require(array is not None and array.GetNumberOfTuples() == 1, f"field data {name} is missing")
    time = field.GetArray("TimeValue").GetValue(0)
    step = int(field.GetArray("step").GetValue(0))
    texts = [field.GetAbstractArray(name).GetValue(0) for name in ("program_version", "plan_fingerprint")]
    print(f"    time {time!r}, step {step}, version {texts[0]}, plan {texts[1]}")
    require(math.isfinite(time), "the time is not finite")
    require(all(texts), "the provenance is empty")
    require(collection_time is None or collection_time == time, f"the collection says time {collection_time!r}")
    if arguments.dump:
        compare(arrays, *read_dump(arguments.dump), step, time)


def compare(arrays, columns, dump_step, dump_time, step, time):
    require((dump_step, dump_time) == (step, time), f"the dump has step {dump_step}, time {dump_time!r}")
    compared = 0
    for name, values in arrays.items():
        for k, column in enumerate(VECTORS.get(name, [name])):
            require(column in columns, f"the dump has no column {column}")
            mine = values[:, k] if name in VECTORS else values
            mine = numpy.ascontiguousarray(mine, dtype=float)
            equal = mine.view(numpy.uint64) == numpy.ascontiguousarray(columns[column]).view(numpy.uint64)
            require(equal.all(), f"{column} differs from the dump, first at point {int(numpy.argmin(equal))}")
            compared += 1
    require(not arrays or compared == len(columns), f"{compared} columns, the dump has {len(columns)}")
    print(f"    equal to the dump bit by bit in {compared} columns")


def files(path):
    """Files and times that an argument names."""
    if not path.endswith(".pvd"):
        return [(path, None)]
    entries = ElementTree.parse(path).getroot().findall("./Collection/DataSet")
    require(entries, "the collection is empty")
    folder = os.path.dirname(path)
    return [(os.path.join(folder, entry.get("file")), float(entry.get("timestep"))) for entry in entries]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--points", type=int)
    parser.add_argument("--dump")
    arguments = parser.parse_args()
    vtk.vtkObject.GlobalWarningDisplayOff()
    wrong = 0
    for argument in arguments.files:
        path = argument
        try:
            for path, time in files(argument):
                check(path, arguments, time)
        except (Mismatch, OSError, ValueError, ElementTree.ParseError) as error:
            print(f"{path}: {error}", file=sys.stderr)
            wrong += 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
