#include "bench/mesh.h"

#include <cstring>
#include <stdexcept>

namespace lamella::bench {
namespace {

void put(std::string& bytes, const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  void get(void* data, std::size_t size) {
    if (size > bytes_.size() - next_) throw std::runtime_error("a mesh is cut short");
    if (size > 0) std::memcpy(data, bytes_.data() + next_, size);
    next_ += size;
  }
  std::size_t count(std::size_t item_size) {
    std::uint64_t value = 0;
    get(&value, sizeof value);
    if (value > (bytes_.size() - next_) / item_size) throw std::runtime_error("a mesh is cut short");
    return value;
  }

 private:
  const std::string& bytes_;
  std::size_t next_ = 0;
};

template <class T>
void put_vector(std::string& bytes, const std::vector<T>& items) {
  const std::uint64_t count = items.size();
  put(bytes, &count, sizeof count);
  put(bytes, items.data(), items.size() * sizeof(T));
}

template <class T>
std::vector<T> get_vector(Reader& reader) {
  std::vector<T> items(reader.count(sizeof(T)));
  reader.get(static_cast<void*>(items.data()), items.size() * sizeof(T));
  return items;
}

}  // namespace

std::size_t ModelMesh::triangle_count() const {
  std::size_t count = 0;
  for (const SolidMesh& solid : solids) count += solid.triangles.size();
  return count;
}

std::string to_bytes(const ModelMesh& mesh) {
  std::string bytes;
  put(bytes, &mesh.seconds, sizeof mesh.seconds);
  const std::uint64_t count = mesh.solids.size();
  put(bytes, &count, sizeof count);
  for (const SolidMesh& solid : mesh.solids) {
    put_vector(bytes, solid.vertices);
    put_vector(bytes, solid.triangles);
  }
  return bytes;
}

ModelMesh mesh_from_bytes(const std::string& bytes) {
  Reader reader(bytes);
  ModelMesh mesh;
  reader.get(&mesh.seconds, sizeof mesh.seconds);
  const std::size_t count = reader.count(2 * sizeof(std::uint64_t));
  for (std::size_t i = 0; i < count; ++i) {
    SolidMesh& solid = mesh.solids.emplace_back();
    solid.vertices = get_vector<Vec3>(reader);
    solid.triangles = get_vector<std::array<std::uint32_t, 3>>(reader);
  }
  return mesh;
}

}  // namespace lamella::bench
