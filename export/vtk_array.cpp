#include "export/vtk_array.h"

#include <algorithm>
#include <cstdint>
#include <libdeflate.h>
#include <memory>
#include <vector>

#include "core/error.h"
#include "export/base64.h"
#include "export/byte_order.h"

namespace lamella {

namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 18;
constexpr int kDeflateLevel = 4;

struct Free {
  void operator()(libdeflate_compressor* compressor) const { libdeflate_free_compressor(compressor); }
};

}  // namespace

std::string vtk_text(std::span<const std::byte> bytes) {
  const std::unique_ptr<libdeflate_compressor, Free> compressor(libdeflate_alloc_compressor(kDeflateLevel));
  if (!compressor) throw ExportError("out of memory for compression");
  const std::size_t blocks = (bytes.size() + kBlockBytes - 1) / kBlockBytes;
  std::string sizes;
  append_little_endian(sizes, static_cast<std::uint64_t>(blocks));
  append_little_endian(sizes, static_cast<std::uint64_t>(kBlockBytes));
  // 0 says that the last block is a whole one.
  append_little_endian(sizes, static_cast<std::uint64_t>(bytes.size() % kBlockBytes));
  std::string packed;
  std::vector<char> block(libdeflate_zlib_compress_bound(compressor.get(), kBlockBytes));
  for (std::size_t begin = 0; begin < bytes.size(); begin += kBlockBytes) {
    const auto part = bytes.subspan(begin, std::min(kBlockBytes, bytes.size() - begin));
    const std::size_t size =
        libdeflate_zlib_compress(compressor.get(), part.data(), part.size(), block.data(), block.size());
    append_little_endian(sizes, static_cast<std::uint64_t>(size));
    packed.append(block.data(), size);
  }
  return base64(sizes) + base64(packed);
}

std::string vtk_text_of_names(std::span<const std::string> names) {
  std::string text;
  for (const std::string& name : names) {
    for (const char c : name) text += std::to_string(static_cast<unsigned char>(c)) + ' ';
    text += "0 ";
  }
  if (!text.empty()) text.pop_back();
  return text;
}

}  // namespace lamella
