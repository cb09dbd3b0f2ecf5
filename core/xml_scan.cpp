#include "core/xml_scan.h"

#include <algorithm>
#include <cctype>
#include <cstdint>

#include "core/error.h"
#include "core/utf8.h"
#include "core/xml.h"

namespace lamella::detail {

namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Walks the text once, markup by markup.
class Scanner {
 public:
  Scanner(std::string_view text, const std::string& name, int first_line)
      : text_(text), name_(name), first_line_(first_line) {}

  void run() {
    check_characters();
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
    while (at_ < text_.size()) text_[at_] == '<' ? markup() : character_data();
    if (depth_ > 0) fail("the file ends inside an element", "is it truncated?");
    if (elements_ == 0) fail("no XML element", "");
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& hint) const {
    const auto line = first_line_ + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw InputError(what, name_ + ":" + std::to_string(line), hint);
  }

  void check_characters() {
    while (at_ < text_.size()) {
      const CodePoint c = decode_utf8(text_, at_);
      if (c.length == 0) fail("not UTF-8 text", "save the file as UTF-8");
      if (!is_xml_character(c.value)) fail("a control character that XML forbids", "remove it");
      at_ += c.length;
    }
    at_ = 0;
  }

  [[nodiscard]] bool looking_at(std::string_view prefix) const { return text_.substr(at_).starts_with(prefix); }

  /// Moves behind the next `end`, which must come.
  void skip_past(std::string_view end, const char* what) {
    const std::size_t found = text_.find(end, at_);
    if (found == std::string_view::npos) fail(std::string(what) + " doesn't end", "is the file truncated?");
    at_ = found + end.size();
  }

  void markup() {
    if (looking_at("<!--")) {
      at_ += 4;
      skip_past("-->", "a comment");
    } else if (looking_at("<![CDATA[")) {
      if (depth_ == 0) fail("text outside the root element", "");
      skip_past("]]>", "a CDATA section");
    } else if (looking_at("<?")) {
      processing_instruction();
    } else if (looking_at("<!")) {
      fail("a document type declaration, which is refused", "remove <!DOCTYPE ...> and every entity");
    } else if (looking_at("</")) {
      if (--depth_ < 0) fail("an end tag without its start", "");
      skip_past(">", "an end tag");
    } else {
      start_tag();
    }
  }

  void processing_instruction() {
    const std::size_t begin = at_;
    skip_past("?>", "a processing instruction");
    std::string body(text_.substr(begin, at_ - begin));
    if (!body.starts_with("<?xml") || !is_space(body[5])) return;
    std::transform(body.begin(), body.end(), body.begin(), [](unsigned char c) { return std::tolower(c); });
    const std::size_t encoding = body.find("encoding");
    if (encoding == std::string::npos) return;
    if (body.find("utf-8", encoding) == std::string::npos && body.find("us-ascii", encoding) == std::string::npos) {
      fail("an encoding other than UTF-8", "save the file as UTF-8");
    }
  }

  void start_tag() {
    if (depth_ == 0 && elements_ > 0) fail("a second root element", "an XML file has exactly one");
    if (++elements_ > kMaxXmlElements) fail("too many elements", "settings have at most 2097152");
    if (++depth_ > XmlDocument::kMaxDepth) fail("elements nested too deeply", "at most 64 levels are read");
    int attributes = 0;
    for (++at_; at_ < text_.size() && text_[at_] != '>'; ++at_) {
      const char c = text_[at_];
      if (c == '<') fail("'<' inside a tag", "write &lt;");
      if (c == '"' || c == '\'') attribute_value(c);
      if (c == '=' && ++attributes > kMaxXmlAttributes) fail("too many attributes in one element", "at most 256");
    }
    if (at_ >= text_.size()) fail("a tag doesn't end", "is the file truncated?");
    if (text_[at_ - 1] == '/') --depth_;
    ++at_;
  }

  /// Leaves the scanner on the closing quote.
  void attribute_value(char quote) {
    for (++at_; at_ < text_.size() && text_[at_] != quote; ++at_) {
      if (text_[at_] == '<') fail("'<' inside an attribute", "write &lt;");
      if (text_[at_] == '&') reference();
    }
    if (at_ >= text_.size()) fail("an attribute doesn't end", "is a quote missing?");
  }

  void character_data() {
    for (; at_ < text_.size() && text_[at_] != '<'; ++at_) {
      if (depth_ == 0 && !is_space(text_[at_])) fail("text outside the root element", "");
      if (text_[at_] == '&') reference();
    }
  }

  /// Accepts one reference and leaves the scanner on its ';'.
  void reference() {
    const std::size_t end = text_.find(';', at_);
    const std::size_t length = end == std::string_view::npos ? 0 : end - at_ - 1;
    const std::string_view body = text_.substr(at_ + 1, std::min<std::size_t>(length, 12));
    const bool predefined = body == "amp" || body == "lt" || body == "gt" || body == "quot" || body == "apos";
    if (!predefined && !is_character_reference(body)) {
      fail("an entity that isn't one of XML's own five", "write & as &amp;");
    }
    at_ = end;
  }

  static bool is_character_reference(std::string_view body) {
    if (!body.starts_with('#')) return false;
    const bool hex = body.starts_with("#x");
    body.remove_prefix(hex ? 2 : 1);
    if (body.empty() || body.size() > 8) return false;
    std::uint64_t value = 0;
    for (const char c : body) {
      const auto byte = static_cast<unsigned char>(c);
      if (hex ? !std::isxdigit(byte) : !std::isdigit(byte)) return false;
      const int digit = std::isdigit(byte) ? c - '0' : std::tolower(byte) - 'a' + 10;
      value = value * (hex ? 16 : 10) + static_cast<std::uint64_t>(digit);
    }
    return value <= 0x10FFFF && is_xml_character(static_cast<char32_t>(value));
  }

  std::string_view text_;
  const std::string& name_;
  int first_line_;
  std::size_t at_ = 0;
  std::size_t elements_ = 0;
  int depth_ = 0;
};

}  // namespace

void scan_xml(std::string_view text, const std::string& name, int first_line) { Scanner(text, name, first_line).run(); }

}  // namespace lamella::detail
