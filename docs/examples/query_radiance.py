#!/usr/bin/env python3
"""The radiance of every voxel of a result in any direction.

usage: query_radiance.py RESULT.h5 X Y Z

X Y Z is the direction in which the light travels: from the scene to the sensor, z up. The scene must have "radiance_field" among output.fields.
"""
import sys

import h5py
import numpy as np


def area(a, b, c):
    """Areas of the spherical triangles a, b, c: unit vectors, counter-clockwise seen from outside (Van Oosterom & Strackee 1983, Eq. 8)."""
    triple, dot = np.sum(a * np.cross(b, c), axis=-1), lambda u, v: np.sum(u * v, axis=-1)
    return 2 * np.arctan2(triple, 1 + dot(a, b) + dot(b, c) + dot(c, a))


def stencil(direction, triangle, travel):
    """The three control points around a direction of travel, and their weights, which sum to 1."""
    p = np.asarray(travel, float) / np.linalg.norm(travel)
    a, b, c = np.moveaxis(direction[triangle], 1, 0)
    sides = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)])
    holder = np.argmax((sides @ p).min(axis=0))  # inside a triangle p is to the left of all three sides
    a, b, c = direction[triangle[holder]]
    weight = np.maximum([area(p, b, c), area(p, c, a), area(p, a, b)], 0)
    return triangle[holder], weight / weight.sum()


def query(field, travel):
    """Diffuse radiance [W m-2 sr-1] of each active voxel along a direction of travel; field is the group radiance_field."""
    point, weight = stencil(field["direction"][...], field["triangle"][...], travel)
    order = np.argsort(point)  # h5py wants ascending indices
    return field["radiance"][:, point[order]] @ weight[order]


def main():
    with h5py.File(sys.argv[1]) as result:
        field = result["radiance_field"]
        radiance = query(field, [float(number) for number in sys.argv[2:5]])
        dense = np.full([result[axis].size for axis in "zyx"], np.nan)
        i, j, k = field["voxel"][...].T
        dense[k, j, i] = radiance
        print(f"{radiance.size} voxels: {radiance.min():.6g} to {radiance.max():.6g}, mean {radiance.mean():.6g} W m-2 sr-1")
        for level, values in enumerate(dense):
            if not np.isnan(values).all():
                print(f"z = {result['z'][level]:8.1f} m: mean {np.nanmean(values):.6g}")


if __name__ == "__main__":
    main()
