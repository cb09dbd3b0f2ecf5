#include "export/deflate_writer.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <libdeflate.h>

#include "export/huffman.h"

namespace lamella {

static_assert(std::endian::native == std::endian::little, "words of bytes are compared and written as they lie");

namespace {

constexpr std::uint32_t kIsRepeat = 1U << 31;
constexpr std::size_t kLiterals = 286;
constexpr std::size_t kEndOfBlock = 256;
constexpr std::size_t kDistances = 30;
constexpr std::size_t kShortest = 3;
constexpr std::size_t kLongest = 258;
constexpr std::size_t kFarthest = 32768;
constexpr int kMostCodeBits = 15;
constexpr std::size_t kMostTokenBytes = 6;  // 15 + 5 bits for a length, 15 + 13 for a distance

/// A symbol with its further bits.
struct Symbol {
  std::uint16_t symbol;
  std::uint8_t extra_bits;
  std::uint16_t extra;
};

/// Of a length of `rest` + 3 (RFC 1951, 3.2.5).
constexpr Symbol length_symbol(unsigned rest) {
  if (rest == kLongest - kShortest) return {285, 0, 0};
  if (rest < 8) return {static_cast<std::uint16_t>(257 + rest), 0, 0};
  const auto extra = static_cast<unsigned>(std::bit_width(rest)) - 3;
  return {static_cast<std::uint16_t>(257 + 4 * (extra + 1) + (rest >> extra & 3U)), static_cast<std::uint8_t>(extra),
          static_cast<std::uint16_t>(rest & ((1U << extra) - 1))};
}

constexpr std::array<Symbol, 256> kLengthSymbols = [] {
  std::array<Symbol, 256> symbols{};
  for (unsigned rest = 0; rest < 256; ++rest) symbols[rest] = length_symbol(rest);
  return symbols;
}();

/// Of a distance of `rest` + 1.
constexpr Symbol distance_symbol(unsigned rest) {
  if (rest < 4) return {static_cast<std::uint16_t>(rest), 0, 0};
  const auto extra = static_cast<unsigned>(std::bit_width(rest)) - 2;
  return {static_cast<std::uint16_t>(2 * (extra + 1) + (rest >> extra & 1U)), static_cast<std::uint8_t>(extra),
          static_cast<std::uint16_t>(rest & ((1U << extra) - 1))};
}

Symbol length_of(std::uint32_t token) { return kLengthSymbols[token & 255U]; }
Symbol distance_of(std::uint32_t token) { return distance_symbol(token >> 8 & 0x7FFFU); }

/// Finds in rows what repeats the row above or the pixel before.
class RowScanner {
 public:
  RowScanner(std::span<const std::uint8_t> bytes, std::size_t row_bytes, std::size_t pixel_bytes, DeflateWriter& out)
      : bytes_(bytes), row_(row_bytes), pixel_(pixel_bytes), out_(out) {}

  void scan() {
    std::size_t at = std::min(row_, bytes_.size());
    if (row_ > kFarthest) at = bytes_.size();
    changed(0, at);
    while (at < bytes_.size()) {
      const std::size_t same = at;
      at += equal_bytes(at);
      if (at - same >= kShortest) {
        out_.repeat(at - same, row_);
      } else {
        for (std::size_t i = same; i < at; ++i) out_.literal(bytes_[i]);
      }
      const std::size_t first = at;
      while (at < bytes_.size() && bytes_[at] != bytes_[at - row_]) ++at;
      changed(first, at);
    }
  }

 private:
  /// How many bytes from `at` on are those of the row above.
  [[nodiscard]] std::size_t equal_bytes(std::size_t at) const {
    const std::size_t first = at;
    while (at + 32 <= bytes_.size() && (change(at) | change(at + 8) | change(at + 16) | change(at + 24)) == 0) at += 32;
    for (; at + 8 <= bytes_.size(); at += 8) {
      const std::uint64_t changed = change(at);
      if (changed != 0) return at - first + static_cast<std::size_t>(std::countr_zero(changed)) / 8;
    }
    while (at < bytes_.size() && bytes_[at] == bytes_[at - row_]) ++at;
    return at - first;
  }

  /// In which bits the eight bytes from `at` on differ from those above.
  [[nodiscard]] std::uint64_t change(std::size_t at) const {
    std::uint64_t word = 0;
    std::uint64_t above = 0;
    std::memcpy(&word, bytes_.data() + at, 8);
    std::memcpy(&above, bytes_.data() + at - row_, 8);
    return word ^ above;
  }

  void changed(std::size_t at, std::size_t end) {
    while (at < end) {
      const std::size_t first = at;
      while (at < end && at >= pixel_ && bytes_[at] == bytes_[at - pixel_]) ++at;
      if (at - first >= kShortest) {
        out_.repeat(at - first, pixel_);
      } else {
        for (std::size_t i = first; i < at; ++i) out_.literal(bytes_[i]);
      }
      if (at < end) out_.literal(bytes_[at++]);
    }
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t row_;
  std::size_t pixel_;
  DeflateWriter& out_;
};

}  // namespace

DeflateWriter::DeflateWriter() { tokens_.reserve(kBlockTokens); }

void DeflateWriter::repeat(std::size_t length, std::size_t distance) {
  const auto far = static_cast<std::uint32_t>(distance - 1) << 8 | kIsRepeat;
  while (length > 0) {
    std::size_t part = std::min(length, kLongest);
    if (length > part && length - part < kShortest) part -= kShortest;  // the rest must not be too short
    push(far | static_cast<std::uint32_t>(part - kShortest));
    length -= part;
  }
}

std::string DeflateWriter::finish() {
  end_block(true);
  align();
  return std::move(out_);
}

std::string DeflateWriter::finish_piece() {
  if (!tokens_.empty()) end_block(false);
  put(0, 3);  // an empty stored block
  align();
  out_ += std::string("\0\0\xFF\xFF", 4);
  return std::move(out_);
}

void DeflateWriter::put(std::uint32_t bits, int count) {
  bits_ |= static_cast<std::uint64_t>(bits) << bit_count_;
  bit_count_ += count;
  const auto whole = static_cast<std::size_t>(bit_count_) / 8;
  out_.append(reinterpret_cast<const char*>(&bits_), whole);
  bits_ >>= 8 * whole;
  bit_count_ %= 8;
}

void DeflateWriter::align() {
  if (bit_count_ > 0) put(0, 8 - bit_count_);
}

/// The lengths of a block's two codes, run-length coded by zeros only (RFC 1951, 3.2.7).
void DeflateWriter::put_codes(const HuffmanCode& literals, const HuffmanCode& distances) {
  std::vector<std::uint8_t> lengths = literals.lengths;
  lengths.insert(lengths.end(), distances.lengths.begin(), distances.lengths.end());
  constexpr std::array<std::uint8_t, 19> kOrder{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  constexpr std::size_t kMostZeros = 138;
  struct Item {
    std::uint8_t symbol, extra_bits, extra;
  };
  std::vector<Item> items;
  for (std::size_t at = 0; at < lengths.size();) {
    std::size_t end = at;
    while (end < lengths.size() && lengths[end] == 0 && end - at < kMostZeros) ++end;
    const std::size_t zeros = end - at;
    if (zeros >= 11) {
      items.push_back({18, 7, static_cast<std::uint8_t>(zeros - 11)});
    } else if (zeros >= 3) {
      items.push_back({17, 3, static_cast<std::uint8_t>(zeros - 3)});
    } else {
      items.push_back({lengths[at], 0, 0});
      end = at + 1;
    }
    at = end;
  }
  std::array<std::uint32_t, 19> counts{};
  for (const Item& item : items) ++counts[item.symbol];
  const HuffmanCode code(counts, 7);
  std::size_t used = kOrder.size();
  while (used > 4 && code.lengths[kOrder[used - 1]] == 0) --used;
  put(static_cast<std::uint32_t>(kLiterals - 257), 5);
  put(static_cast<std::uint32_t>(kDistances - 1), 5);
  put(static_cast<std::uint32_t>(used - 4), 4);
  for (std::size_t n = 0; n < used; ++n) put(code.lengths[kOrder[n]], 3);
  for (const Item& item : items) {
    put(code.codes[item.symbol], code.lengths[item.symbol]);
    put(item.extra, item.extra_bits);
  }
}

namespace {

/// What is written for a symbol with its further bits, the lowest bit first.
struct Word {
  std::uint64_t bits = 0;
  int count = 0;
};

Word word_of(const Symbol& symbol, const HuffmanCode& code) {
  const int length = code.lengths[symbol.symbol];
  return {code.codes[symbol.symbol] | static_cast<std::uint64_t>(symbol.extra) << length, length + symbol.extra_bits};
}

}  // namespace

void DeflateWriter::end_block(bool is_last) {
  std::array<std::uint32_t, kLiterals> literal_counts{};
  std::array<std::uint32_t, kDistances> distance_counts{};
  literal_counts[kEndOfBlock] = 1;
  for (const std::uint32_t token : tokens_) {
    const bool is_repeat = (token & kIsRepeat) != 0;
    ++literal_counts[is_repeat ? length_of(token).symbol : token];
    if (is_repeat) ++distance_counts[distance_of(token).symbol];
  }
  const HuffmanCode literals(literal_counts, kMostCodeBits);
  const HuffmanCode distances(distance_counts, kMostCodeBits);
  put(is_last ? 1 : 0, 1);
  put(2, 2);  // Huffman codes of its own
  put_codes(literals, distances);
  put_tokens(literals, distances);
  put(literals.codes[kEndOfBlock], literals.lengths[kEndOfBlock]);
  tokens_.clear();
}

/// The part that takes the time: no call, no branch but that between literals and repetitions.
void DeflateWriter::put_tokens(const HuffmanCode& literals, const HuffmanCode& distances) {
  std::array<Word, 256> lengths;
  for (std::size_t rest = 0; rest < lengths.size(); ++rest) lengths[rest] = word_of(kLengthSymbols[rest], literals);
  const std::size_t begin = out_.size();
  out_.resize(begin + tokens_.size() * kMostTokenBytes + sizeof(bits_));
  char* to = out_.data() + begin;
  std::uint64_t bits = bits_;
  int count = bit_count_;
  for (const std::uint32_t token : tokens_) {
    Word word{literals.codes[token & 255U], literals.lengths[token & 255U]};
    if ((token & kIsRepeat) != 0) {
      word = lengths[token & 255U];
      const Word distance = word_of(distance_of(token), distances);
      word.bits |= distance.bits << word.count;
      word.count += distance.count;
    }
    bits |= word.bits << count;
    count += word.count;
    std::memcpy(to, &bits, sizeof(bits));
    to += count / 8;
    bits >>= count / 8 * 8;
    count %= 8;
  }
  out_.resize(static_cast<std::size_t>(to - out_.data()));
  bits_ = bits;
  bit_count_ = count;
}

std::string deflate_rows(std::span<const std::uint8_t> bytes, std::size_t row_bytes, std::size_t pixel_bytes,
                         bool is_piece) {
  DeflateWriter writer;
  RowScanner(bytes, row_bytes, pixel_bytes, writer).scan();
  return is_piece ? writer.finish_piece() : writer.finish();
}

std::string zlib_rows(std::span<const std::uint8_t> bytes, std::size_t row_bytes, std::size_t pixel_bytes) {
  std::string out("\x78\x01", 2);
  out += deflate_rows(bytes, row_bytes, pixel_bytes);
  const std::uint32_t sum = libdeflate_adler32(1, bytes.data(), bytes.size());
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<char>(sum >> shift));
  return out;
}

}  // namespace lamella
