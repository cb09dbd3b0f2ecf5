#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <zlib.h>

#include "export/deflate_writer.h"
#include "export/huffman.h"

namespace lamella::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// What zlib makes of a stream; `window_bits` as for inflateInit2. Fails unless the stream ends where the bytes do.
Bytes inflated(const std::string& stream, int window_bits, std::size_t expected) {
  z_stream z{};
  EXPECT_EQ(inflateInit2(&z, window_bits), Z_OK);
  Bytes out(expected + 16);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stream.data()));
  z.avail_in = static_cast<uInt>(stream.size());
  z.next_out = out.data();
  z.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&z, Z_FINISH), Z_STREAM_END) << (z.msg != nullptr ? z.msg : "");
  EXPECT_EQ(z.avail_in, 0U);
  out.resize(z.total_out);
  inflateEnd(&z);
  return out;
}

/// Rows that resemble the one above, the pixel before, nothing, or are all equal.
Bytes random_rows(std::mt19937& random, std::size_t row, std::size_t rows, std::size_t pixel) {
  Bytes bytes(row * rows);
  const auto kind = random() % 4;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const bool repeats = random() % 12 != 0;
    if (kind == 0) bytes[i] = static_cast<std::uint8_t>(random());
    if (kind == 1) bytes[i] = i >= row && repeats ? bytes[i - row] : static_cast<std::uint8_t>(random() % 3);
    if (kind == 2) bytes[i] = i >= pixel && repeats ? bytes[i - pixel] : static_cast<std::uint8_t>(random());
  }
  return bytes;
}

TEST(Deflate, ZlibReadsRandomRowsBack) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 2000; ++trial) {
    const std::size_t row = 1 + random() % 300;
    const std::size_t pixel = 1 + random() % 4;
    const Bytes bytes = random_rows(random, row, 1 + random() % 40, pixel);
    ASSERT_EQ(inflated(zlib_rows(bytes, row, pixel), 15, bytes.size()), bytes) << trial;
  }
}

TEST(Deflate, PiecesFollowEachOther) {
  std::mt19937 random(8);
  std::string stream;
  Bytes expected;
  for (int piece = 0; piece < 50; ++piece) {
    const std::size_t row = 1 + random() % 100;
    const Bytes bytes = piece == 20 ? Bytes{} : random_rows(random, row, 20, 1);
    stream += deflate_rows(bytes, row, 1, true);
    expected.insert(expected.end(), bytes.begin(), bytes.end());
  }
  stream += deflate_rows({}, 1, 1);
  EXPECT_EQ(inflated(stream, -15, expected.size()), expected);
}

TEST(Deflate, RowsFartherThanTheWindowAndManyBlocksSurvive) {
  std::mt19937 random(9);
  for (const std::size_t row : {32767U, 32768U, 32769U, 200000U}) {
    Bytes bytes(row * 3);
    for (std::size_t i = 0; i < bytes.size(); ++i)
      bytes[i] = static_cast<std::uint8_t>(i < row ? random() : bytes[i - row]);
    const std::string stream = zlib_rows(bytes, row, 1);
    ASSERT_EQ(inflated(stream, 15, bytes.size()), bytes) << row;
    EXPECT_LT(stream.size(), row <= 32768 ? row * 11 / 10 : 4 * row);
  }
}

TEST(Deflate, EqualRowsTakeHardlyAnyBytes) {
  Bytes bytes(1000 * 1000);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = i % 1000 < 300 ? 1 : 2;
  const std::string stream = zlib_rows(bytes, 1000, 1);
  EXPECT_LT(stream.size(), 5000U);  // 10 bits for 258 bytes
  EXPECT_EQ(inflated(stream, 15, bytes.size()), bytes);
}

TEST(Huffman, LengthsAreAPrefixCodeWithinTheLimitAndShortForFrequentSymbols) {
  std::mt19937 random(10);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<std::uint32_t> counts(2 + random() % 280);
    // Fibonacci's numbers give the deepest trees.
    std::uint64_t a = 1;
    std::uint64_t b = 1;
    for (std::uint32_t& count : counts) {
      count = trial % 2 == 0 ? static_cast<std::uint32_t>(random() % 50) : static_cast<std::uint32_t>(a);
      if (a < 1'000'000'000) a = std::exchange(b, a + b);
    }
    const HuffmanCode code(counts, 15);
    double sum = 0.0;
    std::size_t used = 0;
    for (std::size_t s = 0; s < counts.size(); ++s) {
      ASSERT_EQ(code.lengths[s] > 0, counts[s] > 0);
      ASSERT_LE(code.lengths[s], 15);
      if (counts[s] == 0) continue;
      sum += std::pow(0.5, code.lengths[s]);
      ++used;
    }
    EXPECT_TRUE(used < 2 || sum == 1.0);  // complete, as zlib asks
    for (std::size_t s = 1; s < counts.size(); ++s) {
      const bool is_likelier = counts[s] > counts[s - 1] && counts[s - 1] > 0;
      ASSERT_TRUE(!is_likelier || code.lengths[s] <= code.lengths[s - 1]);
    }
  }
}

}  // namespace
}  // namespace lamella::test
