"""Reads the STEP file of bodies with OpenCASCADE as OCP (cadquery-ocp) wraps it, and checks it as strictly as that kernel can.

python strict.py BODY.step prints one JSON object: solids, whether all of it is valid without healing, the largest tolerance of a face, an edge
or a vertex, the shortest edge, and the volume by adaptive integration, in mm.
"""

import json
import sys

from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.GCPnts import GCPnts_AbscissaPoint
from OCP.GProp import GProp_GProps
from OCP.ShapeAnalysis import ShapeAnalysis_ShapeTolerance
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS


def parts(shape, kind):
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def main(step):
    reader = STEPControl_Reader()
    reader.ReadFile(step)
    reader.TransferRoots()
    shape = reader.OneShape()
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties, 1e-9, False, False)
    edges = [TopoDS.Edge(edge) for edge in parts(shape, TopAbs_EDGE)]
    lengths = [GCPnts_AbscissaPoint.Length_s(BRepAdaptor_Curve(edge)) for edge in edges if not BRep_Tool.Degenerated_s(edge)]
    result = {
        "solids": sum(1 for _ in parts(shape, TopAbs_SOLID)),
        "faces": sum(1 for _ in parts(shape, TopAbs_FACE)),
        "valid": BRepCheck_Analyzer(shape).IsValid(),
        "tolerance": ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1),
        "shortest": min(lengths),
        "volume": properties.Mass(),
    }
    print(json.dumps(result))


main(*sys.argv[1:])
