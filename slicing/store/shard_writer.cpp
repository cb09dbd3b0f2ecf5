#include "slicing/store/shard_writer.h"

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/sha256.h"
#include "slicing/store/build_file.h"

namespace lamella {

namespace {

using hdf5::written;
namespace fs = std::filesystem;

/// The memory image grows by this much at a time.
constexpr std::size_t kImageStep = std::size_t{1} << 20;

/// An open file or group and the path to name in errors.
struct Place {
  hid_t id = H5I_INVALID_HID;
  const fs::path& path;
};

/// Object times off: the same layers give the same bytes on every day.
hdf5::Properties timeless(hid_t kind, const fs::path& path) {
  hdf5::Properties properties(written(H5Pcreate(kind), path));
  written(H5Pset_obj_track_times(properties.id(), false), path);
  return properties;
}

/// Groups that know the order of their members also have the compact form of HDF5 1.8.
void keep_order(const hdf5::Properties& creation, const fs::path& path) {
  written(H5Pset_link_creation_order(creation.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), path);
}

hdf5::File create_in_memory(const fs::path& path) {
  const hdf5::Properties access(written(H5Pcreate(H5P_FILE_ACCESS), path));
  written(H5Pset_fapl_core(access.id(), kImageStep, false), path);
  // The oldest superblock: later ones have a checksum that H5Fget_file_image leaves stale.
  written(H5Pset_libver_bounds(access.id(), H5F_LIBVER_EARLIEST, H5F_LIBVER_V18), path);
  const hdf5::Properties creation = timeless(H5P_FILE_CREATE, path);
  keep_order(creation, path);
  // Most arrays are one chunk; the usual chunk index of 2 KiB for each would outweigh small layers.
  written(H5Pset_istore_k(creation.id(), 2), path);
  return hdf5::File(written(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), path));
}

/// Bytes of the file as they would be on disk.
std::string image_of(const hdf5::File& file, const fs::path& path) {
  written(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), path);
  const auto size = written(H5Fget_file_image(file.id(), nullptr, 0), path);
  std::string image(static_cast<std::size_t>(size), '\0');
  written(H5Fget_file_image(file.id(), image.data(), image.size()), path);
  return image;
}

std::string write_image(hdf5::File& file, const fs::path& path) {
  const std::string image = image_of(file, path);
  file.reset();
  write_file_atomically(path, image);
  Sha256 sha;
  sha.update(std::as_bytes(std::span(image)));
  return sha.finish();
}

hdf5::Group create_group(const Place& parent, const std::string& name) {
  const hdf5::Properties creation = timeless(H5P_GROUP_CREATE, parent.path);
  keep_order(creation, parent.path);
  return hdf5::Group(
      written(H5Gcreate2(parent.id, name.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), parent.path));
}

/// A string type that holds `size` bytes of UTF-8.
hdf5::Type string_type(std::size_t size, const fs::path& path) {
  hdf5::Type type(written(H5Tcopy(H5T_C_S1), path));
  written(H5Tset_size(type.id(), std::max<std::size_t>(size, 1)), path);
  written(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), path);
  written(H5Tset_cset(type.id(), H5T_CSET_UTF8), path);
  return type;
}

void put_attribute(const Place& object, const char* name, hid_t type, const void* value) {
  const hdf5::Space scalar(written(H5Screate(H5S_SCALAR), object.path));
  const hdf5::Attribute attribute(
      written(H5Acreate2(object.id, name, type, scalar.id(), H5P_DEFAULT, H5P_DEFAULT), object.path));
  written(H5Awrite(attribute.id(), type, value), object.path);
}

void put_attribute(const Place& object, const char* name, std::string_view value) {
  const std::string text(value);
  put_attribute(object, name, string_type(text.size(), object.path).id(), text.c_str());
}

void put_attribute(const Place& object, const char* name, double value) {
  put_attribute(object, name, H5T_IEEE_F64LE, &value);
}

void put_attribute(const Place& object, const char* name, std::int64_t value) {
  put_attribute(object, name, H5T_STD_I64LE, &value);
}

hid_t type_of(const PackedArray& array) {
  switch (array.type) {
    case ElementType::i32:
      return H5T_STD_I32LE;
    case ElementType::u32:
      return H5T_STD_U32LE;
    case ElementType::u64:
      return H5T_STD_U64LE;
    case ElementType::f32:
      return H5T_IEEE_F32LE;
    case ElementType::f64:
      break;
  }
  return H5T_IEEE_F64LE;
}

hdf5::Properties layout_of(const PackedArray& array, int compression, const fs::path& path) {
  hdf5::Properties creation = timeless(H5P_DATASET_CREATE, path);
  if (array.chunk == 0) {
    written(H5Pset_layout(creation.id(), H5D_COMPACT), path);
    return creation;
  }
  const hsize_t chunk = array.chunk;
  written(H5Pset_chunk(creation.id(), 1, &chunk), path);
  if (compression > 0) {
    written(H5Pset_shuffle(creation.id()), path);
    written(H5Pset_deflate(creation.id(), static_cast<unsigned>(compression)), path);
  }
  return creation;
}

hdf5::Dataset create_array(const Place& group, const char* name, hid_t type, hsize_t count, const char* unit,
                           const hdf5::Properties& creation) {
  const hdf5::Space space(written(H5Screate_simple(1, &count, nullptr), group.path));
  hdf5::Dataset dataset(
      written(H5Dcreate2(group.id, name, type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), group.path));
  put_attribute({dataset.id(), group.path}, "unit", std::string_view(unit));
  return dataset;
}

/// The pieces are stored as they are, past HDF5's own filters.
void put_array(const Place& group, const PackedArray& array, int compression) {
  const hdf5::Dataset dataset = create_array(group, array.name, type_of(array), array.count, array.unit,
                                             layout_of(array, compression, group.path));
  if (array.count == 0) return;
  if (array.chunk == 0) {
    written(H5Dwrite(dataset.id(), type_of(array), H5S_ALL, H5S_ALL, H5P_DEFAULT, array.pieces.front().data()),
            group.path);
    return;
  }
  hsize_t first = 0;
  for (const std::string& piece : array.pieces) {
    written(H5Dwrite_chunk(dataset.id(), H5P_DEFAULT, 0, &first, piece.size(), piece.data()), group.path);
    first += array.chunk;
  }
}

void put_rows(const Place& group, const PackedRows& rows, int compression) {
  for (const PackedArray& array : rows) put_array(group, array, compression);
}

/// A table of names: entry i belongs to id i.
void put_names(const Place& file, const char* name, const std::vector<std::string>& names) {
  std::vector<const char*> pointers;
  for (const std::string& text : names) pointers.push_back(text.c_str());
  const hdf5::Type type = string_type(H5T_VARIABLE, file.path);
  const hsize_t count = pointers.size();
  hdf5::Properties creation = timeless(H5P_DATASET_CREATE, file.path);
  if (count * H5Tget_size(type.id()) <= kCompactBytes) {
    written(H5Pset_layout(creation.id(), H5D_COMPACT), file.path);
  } else {
    const hsize_t chunk = std::min<hsize_t>(count, kChunkElements);
    written(H5Pset_chunk(creation.id(), 1, &chunk), file.path);
  }
  const hdf5::Dataset dataset = create_array(file, name, type.id(), count, "1", creation);
  if (count > 0) written(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, pointers.data()), file.path);
}

void put_header(const Place& file, const BuildInfo& info) {
  put_attribute(file, "format", std::string_view("lamella-layers"));
  put_attribute(file, "version", std::int64_t{1});
  put_attribute(file, "length_unit", std::string_view("mm"));
  put_attribute(file, "angle_unit", std::string_view("rad"));
  std::vector<std::string> materials;
  for (const Material& material : info.materials) materials.push_back(material.name);
  put_names(file, "material_names", materials);
  std::vector<std::string> solids;
  for (const BuildSolid& solid : info.solids) solids.push_back(solid.path);
  put_names(file, "solid_paths", solids);
}

}  // namespace

ShardWriter::ShardWriter(fs::path path, const BuildInfo& info, int compression)
    : path_(std::move(path)), compression_(compression) {
  const hdf5::Session session;
  file_ = create_in_memory(path_);
  put_header({file_.id(), path_}, info);
}

ShardWriter::~ShardWriter() {
  const hdf5::Session session;
  file_.reset();
}

void ShardWriter::add(const PackedLayer& layer) {
  const hdf5::Session session;
  const hdf5::Group group = create_group({file_.id(), path_}, layer_group_name(layer.index));
  const Place place{group.id(), path_};
  put_attribute(place, "index", static_cast<std::int64_t>(layer.index));
  put_attribute(place, "z_bottom", layer.z_bottom);
  put_attribute(place, "z_sample", layer.z_sample);
  put_attribute(place, "z_top", layer.z_top);
  const hdf5::Group raster = create_group(place, "raster");
  put_rows({raster.id(), path_}, layer.raster, compression_);
  if (layer.hatch) {
    const hdf5::Group hatch = create_group(place, "hatch");
    const Place hatch_place{hatch.id(), path_};
    put_attribute(hatch_place, "angle", layer.hatch->angle);
    put_attribute(hatch_place, "spacing", layer.hatch->spacing);
    put_attribute(hatch_place, "first_row", layer.hatch->first_row);
    put_rows(hatch_place, layer.hatch->rows, compression_);
  }
  if (!layer.contours) return;
  const hdf5::Group contours = create_group(place, "contours");
  put_rows({contours.id(), path_}, *layer.contours, compression_);
}

std::string ShardWriter::finish() {
  const hdf5::Session session;
  return write_image(file_, path_);
}

void write_master_file(const fs::path& path, const BuildInfo& info, std::size_t layers_per_shard) {
  const hdf5::Session session;
  hdf5::File file = create_in_memory(path);
  put_header({file.id(), path}, info);
  for (std::size_t layer = 0; layer < info.plan.layers.size(); ++layer) {
    const std::string name = layer_group_name(layer);
    const std::string target = "/" + name;
    written(H5Lcreate_external(shard_name(layer / layers_per_shard).c_str(), target.c_str(), file.id(), name.c_str(),
                               H5P_DEFAULT, H5P_DEFAULT),
            path);
  }
  (void)write_image(file, path);
}

}  // namespace lamella
