"""Opens a STEP file with OpenCASCADE and tells how far exact points are from its faces.

step.py FILE.step POINTS.csv: for each surface of the points, in their order, one line of JSON with the nearest face: its number,
the largest distance in mm, the smallest cosine between the face's normal and the points' normals, its area in mm^2.
"""

import collections
import csv
import json
import sys

import gmsh


def read_points(path):
    surfaces = collections.defaultdict(list)
    with open(path) as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            if row["status"] == "solved":
                surfaces[row["surface"]].append([float(row[k]) for k in ("x", "y", "z", "nx", "ny", "nz")])
    return surfaces


def compare(face, points):
    positions = [x for point in points for x in point[:3]]
    closest, parameters = gmsh.model.getClosestPoint(2, face, positions)
    normals = gmsh.model.getNormal(face, parameters)
    distance = max(
        sum((closest[3 * i + k] - point[k]) ** 2 for k in range(3)) ** 0.5 for i, point in enumerate(points)
    )
    cosine = min(sum(normals[3 * i + k] * point[3 + k] for k in range(3)) for i, point in enumerate(points))
    return distance, cosine


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
gmsh.model.occ.importShapes(sys.argv[1])
gmsh.model.occ.synchronize()
faces = [face for _, face in gmsh.model.getEntities(2)]
for name, points in read_points(sys.argv[2]).items():
    (distance, cosine), face = min((compare(face, points), face) for face in faces)
    told = {"surface": name, "face": face, "distance": distance, "cosine": cosine, "area": gmsh.model.occ.getMass(2, face)}
    print(json.dumps({key: value if isinstance(value, (str, int)) else float(value) for key, value in told.items()}))
