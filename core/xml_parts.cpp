#include "core/xml_parts.h"

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace lamella {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 18;
constexpr std::string_view kSpace = " \t\r\n";

}  // namespace

XmlParts::XmlParts(const std::filesystem::path& path, std::uint64_t most_bytes)
    : name_(path.string()), most_bytes_(most_bytes), stream_(path, std::ios::binary) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) {
    throw InputError("can't read XML file", name_, "no such file");
  }
  if (!stream_.is_open()) throw InputError("can't read XML file", name_, "is it readable?");
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (!failure && size > most_bytes_) {
    throw InputError("XML file too large", name_, "at most " + std::to_string(most_bytes_ >> 20) + " MiB are read");
  }
  read_root();
}

std::optional<XmlDocument> XmlParts::next() {
  if (is_done_) return std::nullopt;
  int depth = 0;
  for (;;) {
    const std::size_t length = skip_text();
    if (depth == 0) check_between(length);
    switch (skip_markup()) {
      case Markup::start:
        ++depth;
        break;
      case Markup::end:
        if (--depth < 0) {
          read_end();
          return std::nullopt;
        }
        if (depth > 0) break;
        [[fallthrough]];
      case Markup::empty: {
        if (depth > 0) break;
        const int line = first_line_;
        return XmlDocument::parse(take(), name_, line);
      }
      case Markup::other:
        break;
    }
  }
}

/// Reads more of the file; false at its end.
bool XmlParts::load() {
  if (begin_ > kChunk) {
    buffer_.erase(0, begin_);
    at_ -= std::exchange(begin_, 0);
  }
  const std::size_t size = buffer_.size();
  if (size - begin_ > XmlDocument::kMaxBytes)
    fail("a part of the XML file is too large", "at most 64 MiB are read of one");
  buffer_.resize(size + kChunk);
  stream_.read(buffer_.data() + size, static_cast<std::streamsize>(kChunk));
  if (stream_.bad()) throw InputError("can't read XML file", name_, "is it readable?");
  const auto count = static_cast<std::size_t>(stream_.gcount());
  buffer_.resize(size + count);
  bytes_ += count;
  if (bytes_ > most_bytes_) fail("XML file too large", "it grew while it was read");
  return count > 0;
}

/// Whether so many bytes follow.
bool XmlParts::has(std::size_t bytes) {
  while (buffer_.size() - at_ < bytes) {
    if (!load()) return false;
  }
  return true;
}

/// Goes to the next '<'; how many bytes that was.
std::size_t XmlParts::skip_text() {
  for (std::size_t length = 0;;) {
    const std::size_t found = buffer_.find('<', at_);
    const std::size_t end = std::min(found, buffer_.size());
    length += end - at_;
    at_ = end;
    if (found != std::string::npos) return length;
    if (!load()) fail("the file ends inside an element", "is it truncated?");
  }
}

void XmlParts::skip_past(const char* end, const char* what) {
  const std::string_view ending(end);
  for (;;) {
    const std::size_t found = buffer_.find(ending, at_);
    if (found != std::string::npos) {
      at_ = found + ending.size();
      return;
    }
    // The ending may lie across the edge.
    at_ = std::max(at_, buffer_.size() - (ending.size() - 1));
    if (!load()) fail(std::string(what) + " doesn't end", "is the file truncated?");
  }
}

/// Goes past the markup that begins here. What it holds is judged when the whole is parsed.
XmlParts::Markup XmlParts::skip_markup() {
  const auto begins = [&](std::string_view prefix) {
    return has(prefix.size()) && std::string_view(buffer_).substr(at_).starts_with(prefix);
  };
  if (begins("<!--")) {
    at_ += 4;
    skip_past("-->", "a comment");
  } else if (begins("<![CDATA[")) {
    skip_past("]]>", "a CDATA section");
  } else if (begins("<!")) {
    fail("a document type declaration, which is refused", "remove <!DOCTYPE ...> and every entity");
  } else if (begins("<?")) {
    skip_past("?>", "a processing instruction");
  } else if (begins("</")) {
    skip_past(">", "an end tag");
    return Markup::end;
  } else {
    return skip_start_tag();
  }
  return Markup::other;
}

XmlParts::Markup XmlParts::skip_start_tag() {
  char quote = '\0';
  for (++at_; has(1); ++at_) {
    const char c = buffer_[at_];
    if (quote != '\0') {
      if (c == quote) quote = '\0';
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '>') {
      ++at_;
      return buffer_[at_ - 2] == '/' ? Markup::empty : Markup::start;
    }
  }
  fail("a tag doesn't end", "is the file truncated?");
}

/// What has been looked at, which leaves the buffer.
std::string XmlParts::take() {
  std::string text = buffer_.substr(begin_, at_ - begin_);
  begin_ = at_;
  first_line_ += static_cast<int>(std::count(text.begin(), text.end(), '\n'));
  return text;
}

void XmlParts::read_root() {
  for (;;) {
    skip_text();
    const std::size_t tag = at_;  // nothing has been taken, so that loading doesn't move it
    const Markup markup = skip_markup();
    if (markup == Markup::other) continue;
    if (markup == Markup::end) fail("an end tag without its start", "");
    const std::size_t end = buffer_.find_first_of(" \t\r\n/>", tag + 1);
    root_name_ = buffer_.substr(tag + 1, end - tag - 1);
    is_done_ = markup == Markup::empty;
    std::string text = take();
    if (!is_done_) text += "</" + root_name_ + ">";
    root_ = XmlDocument::parse(text, name_);
    if (is_done_) read_end();
    return;
  }
}

/// Between the root's children may be blanks and comments.
void XmlParts::check_between(std::size_t length) {
  (void)has(3);
  const std::string_view text = std::string_view(buffer_).substr(at_ - length, length);
  const std::string_view rest = std::string_view(buffer_).substr(at_);
  if (text.find_first_not_of(kSpace) != std::string_view::npos || rest.starts_with("<![")) {
    fail("<" + root_name_ + "> holds text", "remove the text");
  }
  if (rest.starts_with("<?")) fail("a processing instruction within <" + root_name_ + ">", "remove it");
}

/// The root's end tag, or the root without children, has been passed: nothing more than blanks and comments may follow.
void XmlParts::read_end() {
  if (!is_done_) {
    const std::string_view text = std::string_view(buffer_).substr(begin_, at_ - begin_);
    std::string_view tag = text.substr(text.rfind("</") + 2);
    tag = tag.substr(0, tag.find_last_not_of(" \t\r\n>") + 1);
    if (tag != root_name_) fail("</" + std::string(tag) + "> closes <" + root_name_ + ">", "check the tags");
  }
  is_done_ = true;
  while (load()) continue;
  // What stands before the end tag belongs to no child, and is looked at like what stands behind it.
  const std::string start = at_ > begin_ ? "<" + root_name_ + ">" : "<" + root_name_ + "/>";
  (void)XmlDocument::parse(start + buffer_.substr(begin_), name_, first_line_);
}

void XmlParts::fail(const std::string& what, const std::string& hint) const {
  const auto taken = buffer_.begin() + static_cast<std::ptrdiff_t>(begin_);
  const auto end = buffer_.begin() + static_cast<std::ptrdiff_t>(at_);
  throw InputError(what, name_ + ":" + std::to_string(first_line_ + std::count(taken, end, '\n')), hint);
}

}  // namespace lamella
