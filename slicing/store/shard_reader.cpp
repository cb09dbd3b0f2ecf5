#include "slicing/store/shard_reader.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <vector>

#include "core/error.h"
#include "core/sha256.h"

namespace lamella {

namespace {

namespace fs = std::filesystem;

/// Deflate's largest ratio is 1032 : 1; the rest is room for headers.
constexpr double kLargestRatio = 1100.0;

/// Largest chunk that is read, in elements; ours have 2^17.
constexpr hsize_t kMaxChunkElements = hsize_t{1} << 20;

/// An open file or group, and where it is for error messages.
struct Place {
  hid_t id = H5I_INVALID_HID;
  std::string where;
};

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw InputError(what, where, "the build is damaged; slice again");
}

hid_t opened(hid_t id, const std::string& where) {
  if (id < 0) refuse(where, "can't read slices: " + hdf5::last_error());
  return id;
}

/// A soft or external link could lead out of the build or in circles.
void require_hard_link(const Place& parent, const std::string& name) {
  H5L_info_t link{};
  opened(H5Lget_info(parent.id, name.c_str(), &link, H5P_DEFAULT), parent.where + "/" + name);
  if (link.type != H5L_TYPE_HARD) refuse(parent.where + "/" + name, "a link where an object of the build should be");
}

hdf5::Group open_group(const Place& parent, const std::string& name) {
  require_hard_link(parent, name);
  return hdf5::Group(opened(H5Gopen2(parent.id, name.c_str(), H5P_DEFAULT), parent.where + "/" + name));
}

/// Data may only lie in the file itself, raw or deflated.
void require_plain_layout(const hdf5::Dataset& dataset, const std::string& where) {
  const hdf5::Properties creation(opened(H5Dget_create_plist(dataset.id()), where));
  if (H5Pget_layout(creation.id()) == H5D_VIRTUAL || H5Pget_external_count(creation.id()) != 0) {
    refuse(where, "an array whose data lie outside the file");
  }
  const int filters = H5Pget_nfilters(creation.id());
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0;
    unsigned config = 0;
    std::size_t parameters = 0;
    const H5Z_filter_t filter =
        H5Pget_filter2(creation.id(), static_cast<unsigned>(i), &flags, &parameters, nullptr, 0, nullptr, &config);
    if (filter != H5Z_FILTER_SHUFFLE && filter != H5Z_FILTER_DEFLATE) refuse(where, "an unknown filter");
  }
  hsize_t chunk = 1;
  if (H5Pget_layout(creation.id()) == H5D_CHUNKED && H5Pget_chunk(creation.id(), 1, &chunk) != 1) {
    refuse(where, "an array of wrong shape");
  }
  // A chunk is held whole in memory.
  if (chunk > kMaxChunkElements) refuse(where, "an array in too large chunks");
}

void require_shape(const hdf5::Dataset& dataset, hid_t type, std::uint64_t size, const std::string& where) {
  const hdf5::Type actual(opened(H5Dget_type(dataset.id()), where));
  if (H5Tequal(actual.id(), type) <= 0) refuse(where, "an array of wrong type");
  const hdf5::Space space(opened(H5Dget_space(dataset.id()), where));
  hsize_t extent = 0;
  if (H5Sget_simple_extent_ndims(space.id()) != 1 || H5Sget_simple_extent_dims(space.id(), &extent, nullptr) != 1) {
    refuse(where, "an array of wrong shape");
  }
  if (extent != size) {
    refuse(where, "an array of " + std::to_string(extent) + " elements instead of " + std::to_string(size));
  }
}

template <class T>
std::vector<T> read_array(const Place& group, const char* name, hid_t type, std::uint64_t size, double byte_limit) {
  const std::string where = group.where + "/" + name;
  if (static_cast<double>(size) * sizeof(T) > byte_limit) refuse(where, "an array larger than its file can hold");
  require_hard_link(group, name);
  const hdf5::Dataset dataset(opened(H5Dopen2(group.id, name, H5P_DEFAULT), where));
  require_shape(dataset, type, size, where);
  require_plain_layout(dataset, where);
  std::vector<T> values(size);
  if (size > 0) opened(H5Dread(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), where);
  return values;
}

void read_mixtures(const Place& group, const MixtureEntry& entry, double byte_limit, Mixtures& out) {
  if (entry.segments == 0) return;
  const std::uint64_t count = entry.segments;
  out.segment = read_array<std::uint64_t>(group, "graded_segment", H5T_STD_U64LE, count, byte_limit);
  out.knot_start = read_array<std::uint64_t>(group, "knot_start", H5T_STD_U64LE, count + 1, byte_limit);
  out.x = read_array<double>(group, "knot_x", H5T_IEEE_F64LE, entry.knots, byte_limit);
  out.fraction_start = read_array<std::uint64_t>(group, "fraction_start", H5T_STD_U64LE, count + 1, byte_limit);
  out.fraction = read_array<float>(group, "fraction", H5T_IEEE_F32LE, entry.fractions, byte_limit);
}

SegmentRows read_rows(const Place& group, std::uint64_t rows, std::uint64_t segments, const MixtureEntry& mixtures,
                      double byte_limit) {
  SegmentRows out;
  out.row_start = read_array<std::uint64_t>(group, "row_start", H5T_STD_U64LE, rows + 1, byte_limit);
  const auto begin = read_array<double>(group, "x_begin", H5T_IEEE_F64LE, segments, byte_limit);
  const auto end = read_array<double>(group, "x_end", H5T_IEEE_F64LE, segments, byte_limit);
  const auto material = read_array<std::uint32_t>(group, "material", H5T_STD_U32LE, segments, byte_limit);
  const auto solid = read_array<std::uint32_t>(group, "solid", H5T_STD_U32LE, segments, byte_limit);
  out.segments.reserve(segments);
  for (std::size_t i = 0; i < segments; ++i) {
    out.segments.push_back({begin[i], end[i], MaterialId{material[i]}, SolidId{solid[i]}});
  }
  read_mixtures(group, mixtures, byte_limit, out.mixtures);
  return out;
}

template <class T>
T read_attribute(const Place& object, const char* name, hid_t type) {
  const std::string where = object.where + "/" + name;
  const hdf5::Attribute attribute(opened(H5Aopen(object.id, name, H5P_DEFAULT), where));
  const hdf5::Type actual(opened(H5Aget_type(attribute.id()), where));
  const hdf5::Space space(opened(H5Aget_space(attribute.id()), where));
  if (H5Tequal(actual.id(), type) <= 0 || H5Sget_simple_extent_type(space.id()) != H5S_SCALAR) {
    refuse(where, "an attribute of wrong type");
  }
  T value{};
  opened(H5Aread(attribute.id(), type, &value), where);
  return value;
}

HatchRows read_hatch(const Place& layer, const LayerEntry& entry, double byte_limit) {
  const hdf5::Group group = open_group(layer, "hatch");
  const Place place{group.id(), layer.where + "/hatch"};
  HatchRows hatch;
  hatch.angle = read_attribute<double>(place, "angle", H5T_IEEE_F64LE);
  hatch.spacing = read_attribute<double>(place, "spacing", H5T_IEEE_F64LE);
  hatch.first_row = read_attribute<std::int64_t>(place, "first_row", H5T_STD_I64LE);
  hatch.rows = read_rows(place, entry.hatch_rows, entry.hatch_segments, entry.hatch_mixtures, byte_limit);
  return hatch;
}

void read_curves(const Place& contours, std::uint64_t count, double byte_limit, std::vector<ContourCurve>& out) {
  constexpr std::size_t kNumbers = std::tuple_size_v<decltype(ContourCurve::numbers)>;
  if (count == 0) return;
  const auto first = read_array<std::uint64_t>(contours, "curve_side", H5T_STD_U64LE, count, byte_limit);
  const auto sides = read_array<std::uint64_t>(contours, "curve_sides", H5T_STD_U64LE, count, byte_limit);
  const auto kind = read_array<std::uint32_t>(contours, "curve_kind", H5T_STD_U32LE, count, byte_limit);
  const auto numbers = read_array<double>(contours, "curve_numbers", H5T_IEEE_F64LE, count * kNumbers, byte_limit);
  out.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (kind[i] > static_cast<std::uint32_t>(CurveKind::conic)) refuse(contours.where, "a curve of unknown kind");
    out[i] = {first[i], sides[i], static_cast<CurveKind>(kind[i]), {}};
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(i * kNumbers), kNumbers, out[i].numbers.begin());
  }
}

LayerContours read_contours(const Place& layer, const ContourEntry& entry, double byte_limit) {
  const hdf5::Group group = open_group(layer, "contours");
  const Place place{group.id(), layer.where + "/contours"};
  LayerContours contours;
  const auto solid = read_array<std::uint32_t>(place, "solid", H5T_STD_U32LE, entry.loops, byte_limit);
  const auto parent = read_array<std::int32_t>(place, "parent", H5T_STD_I32LE, entry.loops, byte_limit);
  const auto area = read_array<double>(place, "area", H5T_IEEE_F64LE, entry.loops, byte_limit);
  for (std::size_t i = 0; i < entry.loops; ++i) contours.loops.push_back({SolidId{solid[i]}, parent[i], area[i]});
  contours.point_start = read_array<std::uint64_t>(place, "point_start", H5T_STD_U64LE, entry.loops + 1, byte_limit);
  const auto x = read_array<double>(place, "x", H5T_IEEE_F64LE, entry.points, byte_limit);
  const auto y = read_array<double>(place, "y", H5T_IEEE_F64LE, entry.points, byte_limit);
  contours.points.reserve(entry.points);
  for (std::size_t i = 0; i < entry.points; ++i) contours.points.emplace_back(x[i], y[i]);
  read_curves(place, entry.curves, byte_limit, contours.curves);
  return contours;
}

}  // namespace

ShardReader::ShardReader(fs::path path, const ShardEntry& entry) : path_(std::move(path)) {
  std::error_code failure;
  if (!fs::is_regular_file(path_, failure)) refuse(path_.string(), "a file of the build is missing");
  if (sha256_of_file(path_) != entry.sha256) refuse(path_.string(), "the file's checksum is not that of build.xml");
  file_bytes_ = fs::file_size(path_);
  const hdf5::Session session;
  file_ = hdf5::File(opened(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), path_.string()));
}

ShardReader::~ShardReader() {
  const hdf5::Session session;
  file_.reset();
}

Layer ShardReader::read(std::size_t index, const LayerSpan& span, const LayerEntry& entry, std::size_t rows) const {
  const hdf5::Session session;
  const double byte_limit = kLargestRatio * static_cast<double>(file_bytes_);
  const Place file{file_.id(), path_.string()};
  const hdf5::Group group = open_group(file, layer_group_name(index));
  const Place place{group.id(), file.where + ":/" + layer_group_name(index)};
  Layer layer;
  layer.index = static_cast<std::uint32_t>(index);
  layer.z_bottom = span.z_bottom;
  layer.z_sample = span.z_sample;
  layer.z_top = span.z_top;
  const hdf5::Group raster = open_group(place, "raster");
  layer.raster = read_rows({raster.id(), place.where + "/raster"}, rows, entry.segments, entry.mixtures, byte_limit);
  if (entry.has_hatch) layer.hatch = read_hatch(place, entry, byte_limit);
  if (entry.contours) layer.contours = read_contours(place, *entry.contours, byte_limit);
  return layer;
}

}  // namespace lamella
