#include "slicing/accuracy/stl_file.h"

#include <bit>
#include <cstring>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "slicing/compensated_sum.h"

namespace lamella::accuracy {

namespace {

constexpr std::size_t kHead = 80;
constexpr std::size_t kRecord = 50;
constexpr std::size_t kBlock = 4096;  ///< triangles that are written or read at once

static_assert(std::endian::native == std::endian::little, "the file's byte order is copied from memory");

void put(char*& at, const void* data, std::size_t size) {
  std::memcpy(at, data, size);
  at += size;
}

void put_triangle(char*& at, const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle) {
  const Vec3& a = mesh.vertices[triangle[0]];
  const Vec3& b = mesh.vertices[triangle[1]];
  const Vec3& c = mesh.vertices[triangle[2]];
  const Vec3 cross = (b - a).cross(c - a);
  const double length = cross.norm();
  const Eigen::Vector3f normal = (length > 0.0 ? Vec3(cross / length) : Vec3(Vec3::Zero())).cast<float>();
  put(at, normal.data(), sizeof(float) * 3);
  for (const Vec3* corner : {&a, &b, &c}) {
    const Eigen::Vector3f rounded = corner->cast<float>();
    put(at, rounded.data(), sizeof(float) * 3);
  }
  const std::uint16_t nothing = 0;
  put(at, &nothing, sizeof nothing);
}

}  // namespace

void write_stl(const TriangleMesh& mesh, const std::filesystem::path& path) {
  const std::size_t count = mesh.triangles.size();
  if (count > std::numeric_limits<std::uint32_t>::max()) {
    throw ExportError("an STL file can't hold that many triangles", path.string(), "choose a coarser deflection");
  }
  std::ofstream stream(path, std::ios::binary);
  char head[kHead + 4] = "binary STL, mm";
  const auto number = static_cast<std::uint32_t>(count);
  std::memcpy(head + kHead, &number, sizeof number);
  stream.write(head, sizeof head);
  std::vector<char> block(kBlock * kRecord);
  for (std::size_t first = 0; first < count; first += kBlock) {
    char* at = block.data();
    for (std::size_t i = first; i < std::min(count, first + kBlock); ++i) put_triangle(at, mesh, mesh.triangles[i]);
    stream.write(block.data(), at - block.data());
  }
  stream.close();
  if (!stream) throw ExportError("can't write the STL file", path.string(), "is the disk full?");
}

std::vector<StlTriangle> read_stl(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  char head[kHead + 4];
  if (error || !stream.read(head, sizeof head)) throw InputError("can't read the STL file", path.string());
  std::uint32_t count = 0;
  std::memcpy(&count, head + kHead, sizeof count);
  if (size != stl_bytes(count)) {
    throw InputError("not a binary STL file: its size isn't what its head says", path.string());
  }
  std::vector<StlTriangle> triangles(count);
  std::vector<char> block(kBlock * kRecord);
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t part = std::min<std::size_t>(count - first, kBlock);
    if (!stream.read(block.data(), static_cast<std::streamsize>(part * kRecord))) {
      throw InputError("can't read the STL file", path.string());
    }
    constexpr std::size_t kNormal = 3 * sizeof(float);
    for (std::size_t i = 0; i < part; ++i) {
      std::memcpy(triangles[first + i].data(), block.data() + i * kRecord + kNormal, sizeof(StlTriangle));
    }
  }
  return triangles;
}

double enclosed_volume(const std::vector<StlTriangle>& triangles) {
  if (triangles.empty()) return 0.0;
  const auto corner = [](const StlTriangle& t, int i) { return Vec3(t[3 * i], t[3 * i + 1], t[3 * i + 2]); };
  const Vec3 near = corner(triangles.front(), 0);  // so that nothing cancels far from the origin
  CompensatedSum sum;
  for (const StlTriangle& t : triangles) {
    sum.add((corner(t, 0) - near).dot((corner(t, 1) - near).cross(corner(t, 2) - near)));
  }
  return sum.value() / 6.0;
}

}  // namespace lamella::accuracy
