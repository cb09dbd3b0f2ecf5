"""pvpython paraview_cut.py BUILD VOLUME.vti PICTURE.png NX,NY,NZ: the voxels of a VTK image, cut open, by ParaView."""

import pathlib
import sys

from paraview.simple import (Clip, ColorBy, CreateView, GetColorTransferFunction, GetScalarBar, OpenDataFile,
                             ResetCamera, SaveScreenshot, Show, Threshold)

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from build_colors import materials

build, volume, picture, normal = sys.argv[1:5]
image = OpenDataFile(volume)
image.UpdatePipeline()
box = image.GetDataInformation().GetBounds()
solid = Threshold(Input=image, Scalars=["CELLS", "material"], LowerThreshold=0.5, UpperThreshold=1e9,
                  ThresholdMethod="Between")
cut = Clip(Input=solid, ClipType="Plane", Crinkleclip=1)
cut.ClipType.Origin = [(box[2 * a] + box[2 * a + 1]) / 2 for a in range(3)]
cut.ClipType.Normal = [float(n) for n in normal.split(",")]

view = CreateView("RenderView")
view.ViewSize = [960, 720]
view.UseColorPaletteForBackground = 0
view.Background = [1, 1, 1]
view.OrientationAxesVisibility = 0
shown = Show(cut, view)
ColorBy(shown, ("CELLS", "material"))
colors = GetColorTransferFunction("material")
colors.InterpretValuesAsCategories = 1
names = materials(build)
colors.Annotations = [text for label, (name, _) in enumerate(names, 1) for text in (str(label), name)]
colors.IndexedColors = [part for _, color in names for part in color]
shown.SetScalarBarVisibility(view, True)
view.CameraPosition = [view.CameraFocalPoint[0] - 2, view.CameraFocalPoint[1] - 3, view.CameraFocalPoint[2] + 2]
view.CameraViewUp = [0, 0, 1]
ResetCamera(view)
bar = GetScalarBar(colors, view)
bar.Title, bar.ComponentTitle = "material", ""
bar.TitleColor = bar.LabelColor = [0, 0, 0]
SaveScreenshot(picture, view, ImageResolution=[960, 720], CompressionLevel="9")
