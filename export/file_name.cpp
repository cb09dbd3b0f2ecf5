#include "export/file_name.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

#include "core/utf8.h"

namespace lamella {

namespace {

constexpr std::size_t kMaxBytes = 90;  // leaves room for a number that tells duplicates apart

bool is_plain_ascii(char32_t c) {
  return (c >= U'a' && c <= U'z') || (c >= U'A' && c <= U'Z') || (c >= U'0' && c <= U'9') || c == U'-' || c == U'_' ||
         c == U'+' || c == U'.';
}

/// Characters beyond ASCII that are invisible, change the direction of writing, or have no meaning of their own.
bool is_formatting(char32_t c) {
  static constexpr std::array<std::array<char32_t, 2>, 12> kRanges = {{{0x80, 0xA0},
                                                                       {0xAD, 0xAD},
                                                                       {0x061C, 0x061C},
                                                                       {0x115F, 0x1160},
                                                                       {0x180B, 0x180F},
                                                                       {0x2000, 0x206F},
                                                                       {0x3000, 0x3000},
                                                                       {0x3164, 0x3164},
                                                                       {0xE000, 0xF8FF},
                                                                       {0xFE00, 0xFE0F},
                                                                       {0xFEFF, 0xFEFF},
                                                                       {0xFFA0, 0xFFA0}}};
  if (c >= 0xFFF0 && c <= 0xFFFF) return true;
  if (c >= 0xE0000) return true;
  return std::any_of(kRanges.begin(), kRanges.end(), [c](const auto& r) { return c >= r[0] && c <= r[1]; });
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

bool is_reserved(std::string_view name) {
  const std::string stem = lower(name.substr(0, name.find('.')));
  static const std::set<std::string, std::less<>> kWords = {"con", "prn", "aux", "nul"};
  if (kWords.count(stem) != 0) return true;
  const bool port = stem.size() == 4 && (stem.starts_with("com") || stem.starts_with("lpt"));
  return port && stem[3] >= '0' && stem[3] <= '9';
}

std::string plain(std::string_view name) {
  std::string out;
  for (std::size_t at = 0; at < name.size();) {
    const CodePoint c = decode_utf8(name, at);
    const std::size_t length = c.length == 0 ? 1 : c.length;
    if (out.size() + length > kMaxBytes) break;
    const bool keep = c.length != 0 && (c.value < 0x80 ? is_plain_ascii(c.value) : !is_formatting(c.value));
    out += keep ? name.substr(at, length) : "_";
    at += length;
  }
  if (out.empty()) return "unnamed";
  // A leading dot hides a file or climbs up, and Windows drops one at the end.
  if (out.front() == '.') out.front() = '_';
  if (out.back() == '.') out.back() = '_';
  return is_reserved(out) ? std::string(1, '_').append(out) : out;
}

}  // namespace

std::vector<std::string> safe_file_names(const std::vector<std::string>& names, const std::vector<std::string>& taken) {
  std::set<std::string> used;
  for (const std::string& name : taken) used.insert(lower(name));
  std::map<std::string, int> next_number;  // so that many equal names stay cheap
  std::vector<std::string> out;
  out.reserve(names.size());
  for (const std::string& name : names) {
    const std::string base = plain(name);
    int& number = next_number.try_emplace(lower(base), 2).first->second;
    std::string candidate = base;
    while (!used.insert(lower(candidate)).second) candidate = base + "_" + std::to_string(number++);
    out.push_back(candidate);
  }
  return out;
}

}  // namespace lamella
