#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "export/huffman.h"

namespace lamella {

/// Makes a DEFLATE stream (RFC 1951) of literals and repetitions that the caller knows already, so that nothing has to
/// be searched for. Blocks have Huffman codes of their own. The same calls give the same bytes.
class DeflateWriter {
 public:
  DeflateWriter();

  void literal(std::uint8_t byte) { push(byte); }

  /// The next `length` bytes, at least 3, are those `distance` bytes before, 1 to 32768.
  void repeat(std::size_t length, std::size_t distance);

  /// Ends the stream and returns it.
  [[nodiscard]] std::string finish();

  /// Returns what there is as a piece of a stream that goes on: it ends on a byte, behind an empty block.
  [[nodiscard]] std::string finish_piece();

 private:
  void push(std::uint32_t token) {
    tokens_.push_back(token);
    if (tokens_.size() == kBlockTokens) end_block(false);
  }
  void put(std::uint32_t bits, int count);
  void end_block(bool is_last);
  void put_codes(const HuffmanCode& literals, const HuffmanCode& distances);
  void put_tokens(const HuffmanCode& literals, const HuffmanCode& distances);
  void align();

  static constexpr std::size_t kBlockTokens = 1 << 14;

  std::vector<std::uint32_t> tokens_;
  std::string out_;
  std::uint64_t bits_ = 0;
  int bit_count_ = 0;  ///< below 8 between calls of put()
};

/// A DEFLATE stream of rows of `row_bytes` bytes each, one below the other, in which rows resemble the one above and
/// pixels of `pixel_bytes` the one before: labels, masks, flat colours. Proportional to bytes, with a small factor. A
/// piece can be followed by others; a stream ends with one that isn't a piece.
[[nodiscard]] std::string deflate_rows(std::span<const std::uint8_t> bytes, std::size_t row_bytes,
                                       std::size_t pixel_bytes, bool is_piece = false);

/// The same as a whole zlib stream (RFC 1950).
[[nodiscard]] std::string zlib_rows(std::span<const std::uint8_t> bytes, std::size_t row_bytes,
                                    std::size_t pixel_bytes);

}  // namespace lamella
