"""The same as read_volume.py for VTK image data, MetaImage and NRRD, by VTK's own readers; run by ParaView's pvpython."""

import pathlib
import sys

import vtkmodules.vtkIOImage as image_readers
import vtkmodules.vtkIOXML as xml_readers
from vtkmodules.util.numpy_support import vtk_to_numpy

path = pathlib.Path(sys.argv[1])
reader = {
    ".vti": xml_readers.vtkXMLImageDataReader,
    ".mhd": image_readers.vtkMetaImageReader,
    ".nrrd": image_readers.vtkNrrdReader,
}[path.suffix]()
reader.SetFileName(str(path))
reader.Update()
image = reader.GetOutput()
is_cells = path.suffix == ".vti"  # the others have labels at points, the centres of our voxels
pitch = image.GetSpacing()
print("pitch", *pitch)
print("origin", *(o if is_cells else o - p / 2 for o, p in zip(image.GetOrigin(), pitch)))
print("size", *(n - 1 if is_cells else n for n in image.GetDimensions()))
array = (image.GetCellData() if is_cells else image.GetPointData()).GetScalars()
labels = vtk_to_numpy(array)
print("type", labels.dtype)
names = image.GetFieldData().GetAbstractArray("materials") if is_cells else None
for label in range(1, names.GetNumberOfValues() if names else 0):
    print(f"name{label}", names.GetValue(label))
labels.astype("<u2").tofile(sys.argv[2])
