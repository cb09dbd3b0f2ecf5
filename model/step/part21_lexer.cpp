#include "model/step/part21_lexer.h"

#include <charconv>
#include <cmath>
#include <string>

namespace lamella::step {
namespace {

bool is_word(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '!';
}
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Index after the string whose opening quote is at `i`; npos when it doesn't end. A quote closes the string only where
/// what follows may follow a string: some exporters leave quotes inside undoubled.
std::size_t after_string(std::string_view text, std::size_t i) {
  while (true) {
    i = text.find('\'', i + 1);
    if (i == std::string_view::npos) return i;
    if (i + 1 < text.size() && text[i + 1] == '\'') {
      ++i;
      continue;
    }
    const std::size_t next = text.find_first_not_of(" \t\n\v\f\r", i + 1);
    if (next == std::string_view::npos || std::string_view(",);/").find(text[next]) != std::string_view::npos)
      return i + 1;
  }
}

/// Index after the comment or string that begins at `i`; npos when it doesn't end. `i` itself if none begins there.
std::size_t after_quoted(std::string_view text, std::size_t i) {
  if (text[i] == '\'') return after_string(text, i);
  if (text[i] == '/' && i + 1 < text.size() && text[i + 1] == '*') {
    const std::size_t end = text.find("*/", i + 2);
    return end == std::string_view::npos ? end : end + 2;
  }
  return i;
}

}  // namespace

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

void Scanner::skip_blanks() {
  while (at_ < text_.size()) {
    if (is_space(text_[at_])) {
      if (text_[at_] == '\n') ++line_;
      ++at_;
    } else if (text_[at_] != '/' || !skip_comment()) {
      return;
    }
  }
}

bool Scanner::skip_comment() {
  const std::size_t end = after_quoted(text_, at_);
  if (end == at_) return false;
  const std::size_t stop = end == std::string_view::npos ? text_.size() : end;
  for (; at_ < stop; ++at_) {
    if (text_[at_] == '\n') ++line_;
  }
  return true;
}

bool Scanner::skip_string() {
  const std::size_t end = after_string(text_, at_);
  const std::size_t stop = end == std::string_view::npos ? text_.size() : end;
  for (; at_ < stop; ++at_) {
    if (text_[at_] == '\n') ++line_;
  }
  return end != std::string_view::npos;
}

Scanner::Statement Scanner::next() {
  skip_blanks();
  Statement statement;
  statement.begin = at_;
  statement.line = line_;
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (c == ';') {
      statement.end = at_++;
      while (statement.end > statement.begin && is_space(text_[statement.end - 1])) --statement.end;
      return statement;
    }
    if (c == '\'') {
      if (!skip_string()) statement.fault = "a string that doesn't end";
    } else if (c != '/' || !skip_comment()) {
      if (c == '\n') ++line_;
      ++at_;
    }
  }
  statement.end = text_.size();
  statement.at_end = true;
  if (statement.begin < text_.size() && statement.fault == nullptr) statement.fault = "a statement that doesn't end";
  return statement;
}

KeywordScan scan_keywords(std::string_view entity) {
  KeywordScan scan;
  entity = trim(entity);
  const int outermost = entity.starts_with('(') ? 1 : 0;
  int depth = 0;
  for (std::size_t i = 0; i < entity.size();) {
    const std::size_t after = after_quoted(entity, i);
    if (after == std::string_view::npos) {
      scan.fault = "a string or comment that doesn't end";
      return scan;
    }
    if (after != i) {
      i = after;
      continue;
    }
    const char c = entity[i];
    if (c == '(') ++depth;
    if (c == ')' && --depth < 0) break;
    if (depth == outermost && is_word(c)) {
      const std::size_t first = i;
      while (i < entity.size() && is_word(entity[i])) ++i;
      scan.keywords.push_back(entity.substr(first, i - first));
      continue;
    }
    ++i;
  }
  if (depth != 0) scan.fault = "a bracket is missing";
  if (scan.keywords.empty() && scan.fault == nullptr) scan.fault = "the entity's type is missing";
  return scan;
}

std::vector<int> scan_references(std::string_view entity) {
  std::vector<int> result;
  for (std::size_t i = 0; i < entity.size();) {
    const std::size_t after = after_quoted(entity, i);
    if (after == std::string_view::npos) break;
    if (after != i) {
      i = after;
      continue;
    }
    if (entity[i++] != '#') continue;
    int number = 0;
    const char* begin = entity.data() + i;
    const auto [end, error] = std::from_chars(begin, entity.data() + entity.size(), number);
    if (error == std::errc() && number > 0) result.push_back(number);
    i += static_cast<std::size_t>(end - begin);
  }
  return result;
}

char Parser::peek() {
  while (at_ < text_.size()) {
    if (is_space(text_[at_])) {
      ++at_;
      continue;
    }
    if (text_[at_] != '/') return text_[at_];
    const std::size_t after = after_quoted(text_, at_);
    if (after == at_) return '/';
    at_ = after == std::string_view::npos ? text_.size() : after;
  }
  return '\0';
}

bool Parser::take(char c) {
  if (peek() != c) return false;
  ++at_;
  return true;
}

std::string_view Parser::word() {
  const std::size_t first = at_;
  while (at_ < text_.size() && is_word(text_[at_])) ++at_;
  return text_.substr(first, at_ - first);
}

std::vector<Part> Parser::parts() {
  std::vector<Part> result;
  const bool complex = take('(');
  do {
    Part part;
    if (!parse_part(part)) return {};
    result.push_back(std::move(part));
  } while (complex && peek() != ')' && peek() != '\0');
  if (complex && !take(')')) return {};
  if (peek() != '\0') return {};  // something follows the entity
  return result;
}

bool Parser::parse_part(Part& part) {
  if (!is_word(peek())) return false;
  part.written = word();
  for (const char c : part.written) part.keyword.push_back(c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c);
  return take('(') && parse_list(part.values, 0);
}

bool Parser::parse_list(std::vector<Value>& items, int depth) {
  constexpr int kMaxDepth = 64;
  if (depth > kMaxDepth) return false;
  if (take(')')) return true;
  while (true) {
    Value value;
    if (!parse_value(value, depth + 1)) return false;
    items.push_back(std::move(value));
    if (take(')')) return true;
    if (!take(',')) return false;
  }
}

bool Parser::parse_value(Value& value, int depth) {
  const char c = peek();
  const std::size_t first = at_;
  if (c == '(') {
    ++at_;
    value.kind = Value::Kind::list;
    return parse_list(value.items, depth);
  }
  if (is_word(c) && !is_digit(c) && c != '-') {
    value.kind = Value::Kind::typed;
    value.text = value.written = word();
    return take('(') && parse_list(value.items, depth);
  }
  if (!parse_atom(value, c)) return false;
  value.written = text_.substr(first, at_ - first);
  return true;
}

/// A value that holds no others and begins with `c`.
bool Parser::parse_atom(Value& value, char c) {
  switch (c) {
    case '$':
      ++at_;
      return true;
    case '*':
      ++at_;
      value.kind = Value::Kind::derived;
      return true;
    case '\'':
      return parse_delimited(value, Value::Kind::text, c);
    case '.':
      return parse_delimited(value, Value::Kind::enumeration, c);
    case '"':
      return parse_delimited(value, Value::Kind::binary, c);
    case '#': {
      ++at_;
      value.kind = Value::Kind::reference;
      const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value.reference);
      at_ = static_cast<std::size_t>(end - text_.data());
      return error == std::errc() && value.reference > 0;
    }
    default:
      return (is_digit(c) || c == '-' || c == '+') && parse_number(value);
  }
}

bool Parser::parse_number(Value& value) {
  value.kind = Value::Kind::number;
  const std::size_t first = text_[at_] == '+' ? at_ + 1 : at_;
  const auto [end, error] = std::from_chars(text_.data() + first, text_.data() + text_.size(), value.number);
  if (error != std::errc() || !std::isfinite(value.number)) return false;
  at_ = static_cast<std::size_t>(end - text_.data());
  return true;
}

bool Parser::parse_delimited(Value& value, Value::Kind kind, char delimiter) {
  value.kind = kind;
  const std::size_t first = at_ + 1;
  std::size_t end = kind == Value::Kind::text ? after_string(text_, at_) : text_.find(delimiter, first);
  if (end == std::string_view::npos) return false;
  if (kind != Value::Kind::text) ++end;
  value.text = text_.substr(first, end - 1 - first);
  at_ = end;
  return true;
}

}  // namespace lamella::step
