#include "export/xml_guard.h"

#include "core/error.h"

namespace lamella {

namespace {

constexpr std::int64_t kMaxTagBytes = std::int64_t{1} << 20;
constexpr int kMaxAttributes = 64;
constexpr int kMaxDepth = 64;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kDataSection = "[CDATA[";

/// The end of both xsi:schemaLocation and xsi:noNamespaceSchemaLocation, whatever the prefix.
constexpr std::string_view kSchemaLocation = "chemaLocation";

bool is_white(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

}  // namespace

void XmlGuard::feed(std::string_view bytes) {
  for (char c : bytes) {
    take(c);
    last_ = c;
    ++position_;
    if (c == '\n') ++line_;
  }
}

void XmlGuard::take(char c) {
  // A zero byte betrays UTF-16 and UTF-32; a first byte that is no '<' every other encoding, for UTF-8 is forced on the
  // parser and has no other reading of that byte.
  if (c == '\0') refuse("a zero byte: the file is not UTF-8 text");
  const auto at = static_cast<std::size_t>(position_);
  const bool mark = at < kByteOrderMark.size() && c == kByteOrderMark[at];
  if (position_ == 0 && c != '<' && !mark) refuse("the file does not begin with '<', so it is not XML in UTF-8");
  switch (state_) {
    case State::text:
      if (c == '<') state_ = State::tag_begin;
      break;
    case State::tag_begin:
      begin_tag(c);
      break;
    case State::declaration:
      begin_declaration(c);
      break;
    case State::tag:
      inside_tag(c);
      break;
    case State::quoted:
      if (++tag_bytes_ > kMaxTagBytes) refuse("a tag of over a mebibyte");
      if (c == quote_) state_ = State::tag;
      break;
    case State::comment:
    case State::instruction:
    case State::data_section: {
      recent_ += c;
      const std::string_view ending = state_ == State::comment ? "-->" : state_ == State::instruction ? "?>" : "]]>";
      if (ends_with(ending)) state_ = State::text;
      if (recent_.size() > 2) recent_.erase(0, recent_.size() - 2);
      break;
    }
  }
}

void XmlGuard::begin_tag(char c) {
  recent_.clear();
  if (c == '!') {
    state_ = State::declaration;
  } else if (c == '?') {
    state_ = State::instruction;
  } else {
    state_ = State::tag;
    closing_ = c == '/';
    tag_bytes_ = 0;
    attributes_ = 0;
    if (c == '>') end_tag();
  }
}

void XmlGuard::begin_declaration(char c) {
  recent_ += c;
  if (recent_ == "--") {
    recent_.clear();
    state_ = State::comment;
  } else if (recent_ == kDataSection) {
    recent_.clear();
    state_ = State::data_section;
  } else if (recent_ != "-" && !kDataSection.starts_with(recent_)) {
    refuse("a document type declaration, which files of ours never have");
  }
}

void XmlGuard::inside_tag(char c) {
  if (++tag_bytes_ > kMaxTagBytes) refuse("a tag of over a mebibyte");
  if (c == '=') {
    if (++attributes_ > kMaxAttributes) refuse("a tag with over 64 attributes");
    if (ends_with(kSchemaLocation)) refuse("a schema location, which would have a validator fetch other files");
  } else if (!is_white(c)) {
    if (is_white(last_)) recent_.clear();
    recent_ += c;
  }
  if (c == '"' || c == '\'') {
    quote_ = c;
    state_ = State::quoted;
  } else if (c == '>') {
    end_tag();
  }
}

void XmlGuard::end_tag() {
  state_ = State::text;
  if (closing_) {
    --depth_;
  } else if (last_ != '/') {
    if (++depth_ > kMaxDepth) refuse("elements nested over 64 deep");
  }
}

void XmlGuard::refuse(const char* what) const {
  throw InputError(std::string("refused XML: ") + what, name_ + ":" + std::to_string(line_));
}

}  // namespace lamella
