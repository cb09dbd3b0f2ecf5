#include "export/xml_payload.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <libdeflate.h>
#include <memory>
#include <new>
#include <stdexcept>

#include "core/xml.h"
#include "export/base64.h"

namespace lamella {

static_assert(std::endian::native == std::endian::little, "blocks are little-endian and copied as they are");

namespace {

constexpr int kDeflateLevel = 4;
constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::string_view kWhite = " \t\r\n";

constexpr std::array<std::int8_t, 256> kDigitValues = [] {
  std::array<std::int8_t, 256> values{};
  values.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i) {
    values[static_cast<unsigned char>(kDigits[i])] = static_cast<std::int8_t>(i);
  }
  return values;
}();

/// The bytes of base64 text, white space ignored. Throws unless they are exactly `size` with the right padding.
std::string from_base64(std::string_view text, std::size_t size) {
  std::string out;
  out.reserve(size + 3);
  std::uint32_t group = 0;
  std::size_t digits = 0;
  std::size_t padding = 0;
  for (char c : text) {
    if (kWhite.find(c) != std::string_view::npos) continue;
    const int value = kDigitValues[static_cast<unsigned char>(c)];
    if (c == '=' ? ++padding > 2 : value < 0 || padding > 0) throw std::invalid_argument("malformed base64");
    group = group << 6 | (c == '=' ? 0u : static_cast<std::uint32_t>(value));
    if (++digits % 4 != 0) continue;
    for (int shift : {16, 8, 0}) out.push_back(static_cast<char>(group >> shift));
    if (out.size() > size + 2) throw std::invalid_argument("more bytes than stated");
  }
  if (digits % 4 != 0) throw std::invalid_argument("base64 ends in the middle of a group");
  out.resize(out.size() - padding);
  if (out.size() != size) throw std::invalid_argument("not as many bytes as stated");
  return out;
}

void check_number(double value) {
  if (!std::isfinite(value)) throw std::invalid_argument("a number is not finite");
}
void check_number(std::uint32_t) {}
void check_number(std::int64_t) {}

/// Reads the number at the start of `text`, which doesn't begin with white space, and cuts it off.
template <class T>
T take_number(std::string_view& text) {
  if (text.starts_with('+') && !text.starts_with("+-"))
    text.remove_prefix(1);  // XML Schema allows it, from_chars doesn't
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const auto length = static_cast<std::size_t>(end - text.data());
  const bool ends = length == text.size() || kWhite.find(text[length]) != std::string_view::npos;
  if (error != std::errc{} || !ends) throw std::invalid_argument("malformed number");
  check_number(value);
  text.remove_prefix(length);
  return value;
}

void skip_white(std::string_view& text) { text.remove_prefix(std::min(text.find_first_not_of(kWhite), text.size())); }

std::string format_number(double value) { return format_double(value); }
std::string format_number(std::uint32_t value) { return std::to_string(value); }

}  // namespace

template <class T>
PackedBlock pack_block(std::span<const T> items) {
  const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor(
      libdeflate_alloc_compressor(kDeflateLevel), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  const std::size_t bytes = items.size_bytes();
  std::string stored(libdeflate_zlib_compress_bound(compressor.get(), bytes), '\0');
  stored.resize(libdeflate_zlib_compress(compressor.get(), items.data(), bytes, stored.data(), stored.size()));
  return {bytes, stored.size(), base64(stored)};
}

template <class T>
void unpack_block(std::size_t bytes, std::size_t stored, std::string_view text, std::vector<T>& items) {
  if (bytes == 0 || bytes % sizeof(T) != 0 || bytes / sizeof(T) > kMaxBlockItems) {
    throw std::invalid_argument("a block holds 1 to 65536 whole numbers");
  }
  // Base64 takes 4 characters for 3 bytes, so `stored` is bounded by text that is there already.
  if (stored > text.size()) throw std::invalid_argument("not as many bytes as stated");
  const std::string compressed = from_base64(text, stored);
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  const std::size_t old_size = items.size();
  items.resize(old_size + bytes / sizeof(T));
  const auto result = libdeflate_zlib_decompress(decompressor.get(), compressed.data(), compressed.size(),
                                                 items.data() + old_size, bytes, nullptr);
  if (result != LIBDEFLATE_SUCCESS) throw std::invalid_argument("the zlib stream is damaged or not of the stated size");
  for (std::size_t i = old_size; i < items.size(); ++i) check_number(items[i]);
}

template <class T>
std::string format_list(std::span<const T> items) {
  std::string out;
  for (const T& item : items) {
    if (!out.empty()) out += ' ';
    out += format_number(item);
  }
  return out;
}

template <class T>
void parse_list(std::string_view text, std::size_t most, std::vector<T>& items) {
  const std::size_t limit = items.size() + most;
  for (skip_white(text); !text.empty(); skip_white(text)) {
    if (items.size() == limit) throw std::invalid_argument("more numbers than expected");
    items.push_back(take_number<T>(text));
  }
}

template <class T>
T parse_number(std::string_view text) {
  skip_white(text);
  const T value = take_number<T>(text);
  skip_white(text);
  if (!text.empty()) throw std::invalid_argument("more than one number");
  return value;
}

template PackedBlock pack_block(std::span<const double>);
template PackedBlock pack_block(std::span<const std::uint32_t>);
template void unpack_block(std::size_t, std::size_t, std::string_view, std::vector<double>&);
template void unpack_block(std::size_t, std::size_t, std::string_view, std::vector<std::uint32_t>&);
template std::string format_list(std::span<const double>);
template std::string format_list(std::span<const std::uint32_t>);
template void parse_list(std::string_view, std::size_t, std::vector<double>&);
template void parse_list(std::string_view, std::size_t, std::vector<std::uint32_t>&);
template double parse_number(std::string_view);
template std::int64_t parse_number(std::string_view);
template std::uint32_t parse_number(std::string_view);

}  // namespace lamella
