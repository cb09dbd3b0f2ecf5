#include <BRepPrimAPI_MakeTorus.hxx>
#include <cmath>
#include <gp_Ax2.hxx>
#include <numbers>

#include "datasets/generator/catalog.h"
#include "datasets/generator/shapes.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = std::numbers::pi;

/// Screw along z, tip at 0: (z, r). The thread is cut as ring grooves, so that its volume has a closed form.
std::vector<ProfilePoint> threaded_outline(double z_end) {
  std::vector<ProfilePoint> outline{{0, 0}, {3.0, 1.7}};
  const double pitch = 1.25;
  for (int i = 0; i < 14; ++i) {
    const double z = 3.0 + pitch * i;
    outline.push_back({z + 0.35, 2.3});
    outline.push_back({z + 0.50, 2.3});
    outline.push_back({z + pitch, 1.7});
  }
  outline.push_back({z_end, 1.7});
  return outline;
}

constexpr double kHexFlats = 2.5, kSocketDepth = 2.2;

TopoDS_Shape hexagon(double flats, double z0, double z1) {
  std::vector<std::array<double, 2>> corners;
  const double radius = flats / std::sqrt(3.0);
  for (int i = 0; i < 6; ++i) corners.push_back({radius * std::cos(kPi / 3 * i), radius * std::sin(kPi / 3 * i)});
  return prism(corners, z0, z1);
}

Part screw_part() {
  std::vector<ProfilePoint> outline = threaded_outline(24);
  for (const ProfilePoint& p : {ProfilePoint{26, 4.0}, {28.4, 4.0}, {29, 3.4}, {29, 0}}) outline.push_back(p);
  const TopoDS_Shape shape = cut(revolved_polygon(outline, 'z'), {hexagon(kHexFlats, 29 - kSocketDepth, 31)});
  const double socket = std::sqrt(3.0) / 2 * kHexFlats * kHexFlats * kSocketDepth;
  return {"Knochenschraube Ø4,6",
          shape,
          {"Ti-6Al-4V", 4.43, {0.62, 0.66, 0.74}, 10},
          {revolved_polygon_volume(outline) - socket, "Pappus less the hexagonal socket"}};
}

}  // namespace

DataSet bone_screw() {
  DataSet set{"bone_screw", "Grooved screw through cortical bone into a spongy plug", "mm", {}, {}, {}};
  set.root.name = "Bone screw in a plug";
  set.add(screw_part());
  std::vector<ProfilePoint> plug = threaded_outline(21.5);
  plug.insert(plug.end(), {{21.5, 9.0}, {-4, 9.0}, {-4, 0}});
  set.add({"Spongiosa",
           revolved_polygon(plug, 'z'),
           {"Cancellous bone", 0.62, {0.88, 0.74, 0.60}, 0},
           {revolved_polygon_volume(plug), "Pappus"}});
  const std::vector<ProfilePoint> cortex{{21.5, 2.0}, {21.5, 9.0}, {23.6, 9.0}, {23.6, 2.0}};
  set.add({"Kortikalis",
           revolved_polygon(cortex, 'z'),
           {"Cortical bone", 1.91, {0.96, 0.92, 0.82}, 0},
           {revolved_polygon_volume(cortex), "Pappus"}});
  return set;
}

namespace {

constexpr double kChannelRadius = 3.0, kBend = 16.0, kUpperRadius = 2.2, kUpperBend = 12.0;

/// U-shaped channel at a height: in at y = -22, half a torus about the z axis, out at y = -22.
TopoDS_Shape channel(double z, double bend, double radius) {
  const gp_Ax2 axis(gp_Pnt(0, 0, z), gp_Dir(0, 0, 1), gp_Dir(1, 0, 0));
  return fuse({cylinder({bend, -22, z}, {0, 1, 0}, radius, 22), cylinder({-bend, -22, z}, {0, 1, 0}, radius, 22),
               BRepPrimAPI_MakeTorus(axis, bend, radius, kPi).Shape()});
}

double channel_volume(double bend, double radius) { return kPi * radius * radius * (2 * 22 + kPi * bend); }

TopoDS_Shape copper_core() { return fuse({cylinder({0, 0, 0}, {0, 0, 1}, 8, 14), sphere({0, 0, 14}, 8)}); }

}  // namespace

DataSet mould_insert() {
  DataSet set{"mould_insert", "Steel mould insert with a copper core and conformal cooling channels", "mm", {}, {}, {}};
  set.root.name = "Mould insert";
  const double core = kPi * 64 * 14 + 2.0 / 3 * kPi * 512;
  const TopoDS_Shape lower = channel(13, kBend, kChannelRadius);
  const TopoDS_Shape body =
      cut(box(-30, -22, 0, 30, 22, 32),
          {copper_core(), lower, channel(22, kUpperBend, kUpperRadius), cylinder({25, 16, -1}, {0, 0, 1}, 2.5, 40)});
  const double steel = 60.0 * 44 * 32 - core - channel_volume(kBend, kChannelRadius) -
                       channel_volume(kUpperBend, kUpperRadius) - kPi * 6.25 * 32;
  set.add({"Insert",
           body,
           {"Steel 1.2311", 7.83, {0.55, 0.58, 0.62}, 0},
           {steel, "box less cylinders, half ball and pipes (Pappus)"}});
  set.add({"Core", copper_core(), {"CuCr1Zr", 8.90, {0.80, 0.45, 0.22}, 10}, {core, "cylinder and half ball"}});
  set.add(
      {"Coolant", lower, {"Water", 0.998, {0.20, 0.50, 0.86}, 0}, {channel_volume(kBend, kChannelRadius), "Pappus"}});
  set.add({"Ejector pin",
           cylinder({25, 16, -6}, {0, 0, 1}, 2.5, 38),
           {"Steel 1.2344", 7.80, {0.34, 0.36, 0.40}, 5},
           {kPi * 6.25 * 38, "pi r^2 h"}});
  return set;
}

DataSet lattice_in_shell() {
  DataSet set{"lattice_in_shell", "Ball-and-strut lattice that touches the walls of a closed box", "mm", {}, {}, {}};
  set.root.name = "Lattice in a shell";
  constexpr double cell = 8, ball = 2.0, strut = 1.2;
  constexpr int nx = 3, ny = 2, nz = 2;
  std::vector<TopoDS_Shape> pieces;
  const auto at = [](int i) { return cell * (i + 0.5); };
  for (int j = 0; j < ny; ++j)
    for (int k = 0; k < nz; ++k) pieces.push_back(cylinder({0, at(j), at(k)}, {1, 0, 0}, strut, cell * nx));
  for (int i = 0; i < nx; ++i)
    for (int k = 0; k < nz; ++k) pieces.push_back(cylinder({at(i), 0, at(k)}, {0, 1, 0}, strut, cell * ny));
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) pieces.push_back(cylinder({at(i), at(j), 0}, {0, 0, 1}, strut, cell * nz));
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) pieces.push_back(sphere({at(i), at(j), at(k)}, ball));
  // Each node has six strut ends that dip `h` into the ball and lose a cap there; no two struts meet outside it.
  const double h = std::sqrt(ball * ball - strut * strut), rise = ball - h;
  const double cap_volume = kPi * rise * rise * (3 * ball - rise) / 3;
  const double nodes = nx * ny * nz;
  const double volume =
      nodes * (4.0 / 3 * kPi * ball * ball * ball + 3 * (kPi * strut * strut * (cell - 2 * h) - 2 * cap_volume));
  set.add({"Lattice",
           fuse(pieces),
           {"Ti-6Al-4V", 4.43, {0.40, 0.46, 0.62}, 10},
           {volume, "balls and struts less the spherical caps"}});
  const TopoDS_Shape outer = box(-1.5, -1.5, -1.5, cell * nx + 1.5, cell * ny + 1.5, cell * nz + 1.5);
  const double wall = (cell * nx + 3) * (cell * ny + 3) * (cell * nz + 3) - cell * cell * cell * nodes;
  set.add({"Shell",
           with_voids(outer, {box(0, 0, 0, cell * nx, cell * ny, cell * nz)}),
           {"PEEK", 1.30, {0.84, 0.74, 0.56}, 0},
           {wall, "box less box"}});
  return set;
}

}  // namespace lamella::datasets
