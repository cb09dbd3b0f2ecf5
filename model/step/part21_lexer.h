#pragma once

#include <string_view>
#include <vector>

#include "model/step/part21.h"

/// Private to model/step: the text level of ISO 10303-21.
namespace lamella::step {

[[nodiscard]] constexpr bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

/// Without white space at both ends.
[[nodiscard]] std::string_view trim(std::string_view text);

/// Cuts a text into statements at the semicolons outside strings and comments.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  struct Statement {
    std::size_t begin = 0;        ///< first character, after white space and comments
    std::size_t end = 0;          ///< of the ';'
    int line = 0;                 ///< of the first character
    bool at_end = false;          ///< no statement any more
    const char* fault = nullptr;  ///< what is left open at the end of the text
  };
  [[nodiscard]] Statement next();
  [[nodiscard]] int line() const { return line_; }

 private:
  void skip_blanks();
  bool skip_comment();
  bool skip_string();

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

/// Keywords on the outermost level of an entity, and what is wrong with its brackets or strings.
struct KeywordScan {
  std::vector<std::string_view> keywords;
  const char* fault = nullptr;
};
[[nodiscard]] KeywordScan scan_keywords(std::string_view entity);

[[nodiscard]] std::vector<int> scan_references(std::string_view entity);

/// Parses what follows an entity's '='. Nesting deeper than 64 or any other fault ends in no parts.
class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}
  [[nodiscard]] std::vector<Part> parts();

 private:
  [[nodiscard]] bool parse_part(Part& part);
  [[nodiscard]] bool parse_list(std::vector<Value>& items, int depth);
  [[nodiscard]] bool parse_value(Value& value, int depth);
  [[nodiscard]] bool parse_atom(Value& value, char c);
  [[nodiscard]] bool parse_number(Value& value);
  [[nodiscard]] bool parse_delimited(Value& value, Value::Kind kind, char delimiter);
  [[nodiscard]] std::string_view word();
  /// The next character that isn't blank or comment, '\0' at the end.
  [[nodiscard]] char peek();
  [[nodiscard]] bool take(char c);

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace lamella::step
