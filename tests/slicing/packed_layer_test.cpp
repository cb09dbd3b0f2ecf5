#include "slicing/store/packed_layer.h"

#include <cmath>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <zlib.h>

namespace lamella {
namespace {

/// What any reader of HDF5 makes of an array: inflates every chunk with zlib, undoes the shuffle, and drops what fills
/// up the last one.
template <class T>
std::vector<T> unpacked(const PackedArray& array, bool deflated = true) {
  std::vector<T> values;
  for (const std::string& piece : array.pieces) {
    if (array.chunk == 0 || !deflated) {
      const std::size_t count = piece.size() / sizeof(T);
      values.resize(values.size() + count);
      if (count > 0) std::memcpy(values.data() + values.size() - count, piece.data(), piece.size());
      continue;
    }
    std::vector<unsigned char> planes(array.chunk * sizeof(T));
    uLongf size = planes.size();
    EXPECT_EQ(uncompress(planes.data(), &size, reinterpret_cast<const Bytef*>(piece.data()), piece.size()), Z_OK);
    EXPECT_EQ(size, planes.size());
    for (std::size_t i = 0; i < array.chunk; ++i) {
      std::array<unsigned char, sizeof(T)> bytes;
      for (std::size_t b = 0; b < sizeof(T); ++b) bytes[b] = planes[b * array.chunk + i];
      values.push_back(std::bit_cast<T>(bytes));
    }
  }
  EXPECT_GE(values.size(), array.count);
  values.resize(array.count);
  return values;
}

std::size_t stored_bytes(const PackedArray& array) {
  std::size_t bytes = 0;
  for (const std::string& piece : array.pieces) bytes += piece.size();
  return bytes;
}

/// One row of segments with the given begins.
Layer layer_of(const std::vector<double>& begins) {
  Layer layer;
  layer.z_sample = 0.5;
  layer.z_top = 1.0;
  for (std::size_t i = 0; i < begins.size(); ++i)
    layer.raster.segments.push_back({begins[i], begins[i] + 1.0, MaterialId{i % 3}, SolidId{i % 7}});
  layer.raster.row_start.push_back(begins.size());
  return layer;
}

void expect_unpacks(const PackedRows& packed, const SegmentRows& rows, bool deflated = true) {
  ASSERT_EQ(packed.size(), 5u);
  EXPECT_EQ(unpacked<std::uint64_t>(packed[0], deflated), rows.row_start);
  const auto begins = unpacked<double>(packed[1], deflated);
  const auto ends = unpacked<double>(packed[2], deflated);
  const auto materials = unpacked<std::uint32_t>(packed[3], deflated);
  const auto solids = unpacked<std::uint32_t>(packed[4], deflated);
  ASSERT_EQ(begins.size(), rows.segments.size());
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const Segment segment{begins[i], ends[i], MaterialId{materials[i]}, SolidId{solids[i]}};
    ASSERT_EQ(segment, rows.segments[i]) << i;
  }
}

std::vector<double> noise(std::size_t count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> place(100.0, 200.0);
  std::vector<double> begins(count);
  for (double& x : begins) x = place(random);
  return begins;
}

TEST(PackedLayer, UnpacksToTheSameBitsAtEveryLevelAndSize) {
  // Up to three chunks; planes of more bytes than a stored block holds; sizes about the limits.
  for (const std::size_t count : {0u, 1u, 128u, 129u, 4095u, 4096u, 70000u, 131072u, 131073u, 300000u}) {
    const Layer layer = layer_of(noise(count));
    for (const int level : {0, 1, 4, 9}) expect_unpacks(pack_layer(layer, level).raster, layer.raster, level > 0);
  }
}

TEST(PackedLayer, UnpacksValuesThatAreNoiseInEveryByte) {
  std::mt19937_64 random(3);
  std::vector<double> begins(20000);
  for (double& x : begins) {
    do x = std::bit_cast<double>(random());
    while (!std::isfinite(x));
  }
  const Layer layer = layer_of(begins);
  const PackedLayer packed = pack_layer(layer, 4);
  expect_unpacks(packed.raster, layer.raster);
  EXPECT_LT(stored_bytes(packed.raster[1]), 20000u * 8 + 100);
}

TEST(PackedLayer, DeflatesWhatCanBeDeflatedAndStoresNoiseAsItIs) {
  const std::size_t count = 50000;
  // 100 to 200 in doubles: the two highest bytes take few values.
  EXPECT_LT(stored_bytes(pack_layer(layer_of(noise(count)), 4).raster[1]), count * 7);
  // Columns that come again on every row are no noise, however many bits they have.
  const std::vector<double> row = noise(900);
  std::vector<double> rows;
  while (rows.size() < count) rows.insert(rows.end(), row.begin(), row.end());
  EXPECT_LT(stored_bytes(pack_layer(layer_of(rows), 4).raster[1]), count);
  const PackedLayer packed = pack_layer(layer_of(noise(count)), 4);
  EXPECT_LT(stored_bytes(packed.raster[3]), 2000u);
  EXPECT_LT(stored_bytes(packed.raster[4]), 2000u);
}

TEST(PackedLayer, KeepsShortArraysPlain) {
  const PackedLayer packed = pack_layer(layer_of(noise(128)), 4);
  for (const PackedArray& array : packed.raster) {
    EXPECT_EQ(array.chunk, 0u) << array.name;
    EXPECT_EQ(array.pieces.size(), 1u) << array.name;
  }
  EXPECT_EQ(pack_layer(layer_of(noise(129)), 4).raster[1].chunk, 129u);
}

}  // namespace
}  // namespace lamella
