#!/usr/bin/env python3
"""The radiance of every voxel of a result in a direction as a VTK file with the result's own cells, for ParaView and VisIt.

usage: radiance_to_vtk.py RESULT.h5 X Y Z OUTPUT.vtk

X Y Z is the direction in which the light travels: from the scene to the sensor, z up. Cells without matter have no radiance (NaN).
"""
import sys

import h5py
import numpy as np

from query_radiance import query


def edges(centre):
    """Faces of equal cells around their centres."""
    size = centre.attrs["cell_size_m"]
    return centre[0] + size * (np.arange(centre.size + 1) - 0.5)


def main():
    with h5py.File(sys.argv[1]) as result:
        axes = [edges(result["x"]), edges(result["y"]), result["z_edge"][...]]
        dense = np.full([result[axis].size for axis in "zyx"], np.nan)
        i, j, k = result["radiance_field/voxel"][...].T
        dense[k, j, i] = query(result["radiance_field"], [float(number) for number in sys.argv[2:5]])
    with open(sys.argv[5], "wb") as file:
        file.write(f"# vtk DataFile Version 3.0\nradiance along {' '.join(sys.argv[2:5])}\nBINARY\nDATASET RECTILINEAR_GRID\n"
                   f"DIMENSIONS {' '.join(str(axis.size) for axis in axes)}\n".encode())
        for name, axis in zip("XYZ", axes):
            file.write(f"{name}_COORDINATES {axis.size} double\n".encode() + axis.astype(">f8").tobytes() + b"\n")
        file.write(f"CELL_DATA {dense.size}\nSCALARS radiance float 1\nLOOKUP_TABLE default\n".encode() + dense.astype(">f4").tobytes() + b"\n")


if __name__ == "__main__":
    main()
