#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lamella {

/// A canonical prefix code (RFC 1951, 3.2.2).
struct HuffmanCode {
  /// For symbols that occur `counts` times, of at most `limit` bits, up to 15; 2^limit must not be below the number of
  /// symbols. A single symbol has one bit.
  HuffmanCode(std::span<const std::uint32_t> counts, int limit);

  std::vector<std::uint8_t> lengths;  ///< by symbol, bits; 0 for those that don't occur
  std::vector<std::uint16_t> codes;   ///< by symbol, the first bit the lowest, as DEFLATE writes them
};

}  // namespace lamella
