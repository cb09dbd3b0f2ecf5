#include "export/xml_payload.h"

#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <stdexcept>

namespace lamella::test {
namespace {

TEST(XmlPayload, BlocksComeBackBitForBit) {
  std::mt19937_64 random(1);
  for (std::size_t count : {1u, 2u, 3u, 100u, 65536u}) {
    std::vector<double> items;
    while (items.size() < count) {
      const double x = std::bit_cast<double>(random());
      if (std::isfinite(x)) items.push_back(x);
    }
    const PackedBlock block = pack_block(std::span<const double>(items));
    std::vector<double> back;
    unpack_block(block.bytes, block.stored, block.text, back);
    EXPECT_EQ(back, items);
  }
}

TEST(XmlPayload, BlocksAreZlibOfLittleEndianNumbersInBase64) {
  // Python: struct.unpack('<2I', zlib.decompress(base64.b64decode(...)))
  std::vector<std::uint32_t> items;
  unpack_block(8, 14, "eJxjZGBgYAQiAAAVAAQ=", items);
  EXPECT_EQ(items, (std::vector<std::uint32_t>{1, 0x1000001}));
}

TEST(XmlPayload, DamagedBase64IsRefused) {
  std::vector<std::uint32_t> items;
  for (const char* text : {"", "eJx", "eJx=jZGB", "eJxjZGBgYAQiAAAVAAQ",
                           "eJxjZGBgYAQiAAAVAAQ==", "eJxjZGBg*AQiAAAVAAQ=", "====", "eJxjZGBgYAQiAAAVAAQ=AAAA"}) {
    EXPECT_THROW(unpack_block(8, 14, text, items), std::invalid_argument) << text;
  }
}

TEST(XmlPayload, NumbersThatAreNotFiniteAreRefused) {
  const std::vector<double> items = {1.0, std::numeric_limits<double>::quiet_NaN()};
  const PackedBlock block = pack_block(std::span<const double>(items));
  std::vector<double> back;
  EXPECT_THROW(unpack_block(block.bytes, block.stored, block.text, back), std::invalid_argument);
  EXPECT_THROW(parse_list("1 nan", 9, back), std::invalid_argument);
  EXPECT_THROW(parse_list("1 inf", 9, back), std::invalid_argument);
  EXPECT_THROW(parse_list("1e400", 9, back), std::invalid_argument);
}

TEST(XmlPayload, ListsTakeWhatSchemaNumbersAllow) {
  std::vector<double> items;
  parse_list(" +1 -2.5e3\n.5\t7. ", 9, items);
  EXPECT_EQ(items, (std::vector<double>{1.0, -2500.0, 0.5, 7.0}));
  EXPECT_THROW(parse_list("1 2 3", 2, items), std::invalid_argument);
  for (const char* text : {"1,2", "0x10", "1 two", "+-1", "--1", "1e", "."}) {
    EXPECT_THROW(parse_list(text, 9, items), std::invalid_argument) << text;
  }
}

TEST(XmlPayload, IndicesAreUnsigned32Bit) {
  std::vector<std::uint32_t> items;
  parse_list("0 4294967295", 9, items);
  EXPECT_EQ(items.back(), 4294967295u);
  for (const char* text : {"-1", "4294967296", "1.0"}) EXPECT_THROW(parse_list(text, 9, items), std::invalid_argument);
}

}  // namespace
}  // namespace lamella::test
