"""Reads the STEP file of a body with OpenCASCADE, as it comes with gmsh, and holds it against exact points of a CSV file.

python solid.py BODY.step [POINTS.csv] prints one JSON object: solids, faces, volume, and the largest distance of solved points from
the body's surface.
"""

import csv
import json
import sys

import gmsh

SLACK = 1e-3


def main(step, points=None):
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Geometry.OCCFixDegenerated", 0)
    gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    solids = gmsh.model.occ.importShapes(step, highestDimOnly=True)
    gmsh.model.occ.synchronize()
    faces = [tag for _, tag in gmsh.model.getEntities(2)]
    result = {
        "solids": sum(dimension == 3 for dimension, _ in solids),
        "shapes": len(solids),
        "faces": len(faces),
        "edges": len(gmsh.model.getEntities(1)),
        "vertices": len(gmsh.model.getEntities(0)),
        "volume": gmsh.model.occ.getMass(3, 1) if gmsh.model.getEntities(3) else 0.0,
        "centre": list(gmsh.model.occ.getCenterOfMass(3, 1)) if gmsh.model.getEntities(3) else None,
        # each edge of a closed body has two faces, or is the seam of one
        "open_edges": sum(len(gmsh.model.getAdjacencies(1, tag)[0]) == 0 for _, tag in gmsh.model.getEntities(1)),
    }
    if points:
        boxes = {tag: gmsh.model.getBoundingBox(2, tag) for tag in faces}
        with open(points, encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#"))]
        worst, count = 0.0, 0
        for row in (row for row in rows if row["status"] == "solved"):
            point = [float(row[key]) for key in "xyz"]
            near = [
                tag
                for tag, box in boxes.items()
                if all(box[k] - SLACK < point[k] < box[k + 3] + SLACK for k in range(3))
            ]
            distances = []
            for tag in near:
                closest, _ = gmsh.model.getClosestPoint(2, tag, point)
                distances.append(sum((a - b) ** 2 for a, b in zip(closest, point)) ** 0.5)
            worst, count = max(worst, min(distances, default=float("inf"))), count + 1
        result |= {"points": count, "distance": worst}
    print(json.dumps(result))
    gmsh.finalize()


main(*sys.argv[1:])
