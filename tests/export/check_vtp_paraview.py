"""ParaView's view of a series of VTK layers: pvpython check_vtp_paraview.py BUILD FOLDER."""

import os
import sys

from paraview.simple import OpenDataFile, servermanager

from vector_build import Build

build = Build(sys.argv[1])
reader = OpenDataFile(os.path.join(sys.argv[2], "layers.pvd"))
reader.UpdatePipelineInformation()
assert len(reader.TimestepValues) == len(build.layers), reader.TimestepValues
segments = 0
for layer in build.layers:
    reader.UpdatePipeline(layer.z_sample)
    data = servermanager.Fetch(reader)
    rows = layer.hatch or layer.raster
    kinds, materials, solids = (data.GetCellData().GetArray(n) for n in ("kind", "material", "solid"))
    cells = [i for i in range(data.GetNumberOfCells()) if kinds.GetTuple1(i) == 0]
    assert [int(materials.GetTuple1(i)) for i in cells] == list(rows.material)
    assert [int(solids.GetTuple1(i)) for i in cells] == list(rows.solid)
    names = data.GetFieldData().GetAbstractArray("material_names")
    assert [names.GetValue(i) for i in range(names.GetNumberOfValues())] == build.materials
    segments += len(cells)
print(len(build.layers), "layers", segments, "segments")
