"""blender -b --python blender_volumes.py -- BUILD VOLUMES.vdb PICTURE.png: each material's fog grid as a surface, the half
nearer to the camera cut away, rendered by Cycles."""

import pathlib
import sys

import bpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

build, volumes, picture = sys.argv[sys.argv.index("--") + 1:]
sys.path.insert(0, str(pathlib.Path(__file__).parent))
from build_colors import materials

SIZE = 10.0  # Blender's units for the longest side

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
bpy.ops.object.volume_import(filepath=volumes)
source = bpy.context.object
source.data.grids.load()
grids = [grid.name for grid in source.data.grids if grid.name.startswith("density_")]
box = [Vector(corner) for corner in source.bound_box]
low, high = box[0], box[6]
scale = SIZE / max(high - low)
middle = (low + high) / 2

# One box cuts what lies nearer to the camera, which looks along +y.
bpy.ops.mesh.primitive_cube_add(size=2.0)
knife = bpy.context.object
knife.scale = (2 * SIZE, 2 * SIZE, 2 * SIZE)
knife.location = (0, -2.0013 * SIZE, 0)  # not through vertices
knife.hide_render = True

def letters(text):
    """What is left of a name where it is made safe for a grid's."""
    return "".join(c for c in text if c.isalnum())


colors = {letters(name): color for name, color in materials(build)}
for grid in grids:
    name = grid[len("density_"):]
    color = colors[letters(name)]
    # Blender meshes a volume's first grid only, unless it is told its name.
    mesh = bpy.data.meshes.new(name)
    surface = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(surface)
    surface.location = -middle * scale
    surface.scale = (scale,) * 3
    modifier = surface.modifiers.new("volume", "VOLUME_TO_MESH")
    modifier.object = source
    modifier.grid_name = grid
    modifier.threshold = 0.5
    modifier.resolution_mode = "GRID"
    cut = surface.modifiers.new("cut", "BOOLEAN")
    cut.object = knife
    cut.operation = "DIFFERENCE"
    cut.solver = "EXACT"
    paint = bpy.data.materials.new(name)
    paint.use_nodes = True
    shader = paint.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*(c ** 2.2 for c in color), 1)
    shader.inputs["Roughness"].default_value = 0.45
    mesh.materials.append(paint)
source.hide_render = True
source.location, source.scale = -middle * scale, (scale,) * 3

bpy.ops.object.camera_add()
camera = bpy.context.object
scene.camera = camera
scene.render.resolution_x, scene.render.resolution_y = 960, 720


def fits(distance):
    """Whether all that is left of the box is in the picture from this far."""
    camera.location = Vector((0.45, -0.8, 0.5)).normalized() * distance
    camera.rotation_euler = (-camera.location).to_track_quat("-Z", "Y").to_euler()
    bpy.context.view_layer.update()
    places = [world_to_camera_view(scene, camera, (Vector((c.x, max(c.y, middle.y), c.z)) - middle) * scale) for c in box]
    return all(0.03 < place[axis] < 0.97 for place in places for axis in (0, 1))


distance = SIZE
while not fits(distance):
    distance *= 1.02
bpy.ops.object.light_add(type="SUN", rotation=(0.7, 0.3, 0.4))
bpy.context.object.data.energy = 2.5
bpy.context.object.data.angle = 0.1
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
scene.world.node_tree.nodes["Background"].inputs[1].default_value = 0.45
scene.render.engine = "CYCLES"
scene.cycles.samples = 48
scene.cycles.use_denoising = False
scene.view_settings.view_transform = "Standard"
scene.render.film_transparent = False
scene.render.image_settings.compression = 100
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
