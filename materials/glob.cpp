#include "materials/glob.h"

#include <utility>
#include <vector>

#include "core/utf8.h"

namespace lamella {

namespace {

constexpr char32_t kBrokenByte = 0x110000;  // stands for a byte that isn't UTF-8; equal to no character

std::u32string decode(std::string_view text) {
  std::u32string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint c = decode_utf8(text, at);
    out.push_back(c.length > 0 ? c.value : kBrokenByte);
    at += c.length > 0 ? c.length : 1;
  }
  return out;
}

/// One step of a pattern: a run of anything, or a test on one character.
struct Item {
  enum class Kind { run, any, literal, set } kind = Kind::any;
  char32_t literal = 0;
  bool inverted = false;
  std::vector<std::pair<char32_t, char32_t>> ranges{};

  [[nodiscard]] bool accepts(char32_t c) const {
    if (kind == Kind::any) return true;
    if (kind == Kind::literal) return c == literal;
    for (const auto& [first, last] : ranges) {
      if (first <= c && c <= last) return !inverted;
    }
    return inverted;
  }
};

/// Turns a pattern into items; `fault()` says why it can't.
class GlobParser {
 public:
  explicit GlobParser(std::string_view pattern) : pattern_(decode(pattern)) {
    while (at_ < pattern_.size() && fault_.empty()) item();
  }

  [[nodiscard]] const std::vector<Item>& items() const { return items_; }
  [[nodiscard]] const std::string& fault() const { return fault_; }

 private:
  void item() {
    const char32_t c = pattern_[at_++];
    if (c == U'*') {
      items_.push_back({.kind = Item::Kind::run});
    } else if (c == U'?') {
      items_.push_back({.kind = Item::Kind::any});
    } else if (c == U'[') {
      set();
    } else {
      --at_;
      items_.push_back({.kind = Item::Kind::literal, .literal = character()});
    }
  }

  /// One character that stands for itself, perhaps behind a backslash.
  char32_t character() {
    char32_t c = pattern_[at_++];
    if (c == U'\\') {
      if (at_ == pattern_.size()) {
        fault_ = "it ends with a single '\\'";
        return c;
      }
      c = pattern_[at_++];
    }
    if (c == kBrokenByte) fault_ = "it isn't UTF-8 text";
    return c;
  }

  void set() {
    Item item{.kind = Item::Kind::set};
    if (at_ < pattern_.size() && pattern_[at_] == U'!') {
      item.inverted = true;
      ++at_;
    }
    for (bool first = true; at_ < pattern_.size() && (first || pattern_[at_] != U']') && fault_.empty();
         first = false) {
      const char32_t low = character();
      char32_t high = low;
      if (at_ + 1 < pattern_.size() && pattern_[at_] == U'-' && pattern_[at_ + 1] != U']') {
        ++at_;
        high = character();
      }
      item.ranges.emplace_back(low, high);
    }
    if (at_ == pattern_.size() && fault_.empty()) fault_ = "'[' has no ']'; write \\[ for a bracket";
    ++at_;
    items_.push_back(std::move(item));
  }

  std::u32string pattern_;
  std::size_t at_ = 0;
  std::vector<Item> items_;
  std::string fault_;
};

}  // namespace

bool matches_glob(std::string_view pattern, std::string_view text) {
  const GlobParser parsed(pattern);
  if (!parsed.fault().empty()) return false;
  const std::vector<Item>& items = parsed.items();
  const std::u32string characters = decode(text);
  // Only the last run met needs to be tried longer: an earlier one can't gain anything by taking more.
  std::size_t item = 0;
  std::size_t at = 0;
  std::size_t run_item = items.size();
  std::size_t run_at = 0;
  while (at < characters.size()) {
    if (item < items.size() && items[item].kind == Item::Kind::run) {
      run_item = item++;
      run_at = at;
    } else if (item < items.size() && items[item].accepts(characters[at])) {
      ++item;
      ++at;
    } else if (run_item < items.size()) {
      item = run_item + 1;
      at = ++run_at;
    } else {
      return false;
    }
  }
  while (item < items.size() && items[item].kind == Item::Kind::run) ++item;
  return item == items.size();
}

std::optional<std::string> glob_fault(std::string_view pattern) {
  const GlobParser parsed(pattern);
  if (parsed.fault().empty()) return std::nullopt;
  return parsed.fault();
}

std::string escape_glob(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint c = decode_utf8(text, at);
    const std::size_t length = c.length > 0 ? c.length : 1;
    if (c.length == 0 || !is_xml_character(c.value)) {
      out += '?';
    } else {
      if (c.value == U'*' || c.value == U'?' || c.value == U'[' || c.value == U'\\') out += '\\';
      out += text.substr(at, length);
    }
    at += length;
  }
  return out;
}

}  // namespace lamella
