#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lamella {

/// Looks at the bytes of an XML file before the parser does and refuses what is hostile in any file of ours: document
/// type declarations (and with them every entity), encodings other than UTF-8, tags of over a mebibyte or with over 64
/// attributes (libxml2 compares each with each), nesting deeper than 64, and schema locations, which would have the
/// validator fetch what they name. Constant memory, linear time.
/// Whether the rest is well-formed is left to the parser.
class XmlGuard {
 public:
  /// `name` stands for the file in messages.
  explicit XmlGuard(std::string name) : name_(std::move(name)) {}

  /// Takes the next bytes of the file. Throws InputError with file and line.
  void feed(std::string_view bytes);

  [[nodiscard]] std::int64_t line() const { return line_; }

 private:
  enum class State { text, tag_begin, declaration, tag, quoted, comment, instruction, data_section };

  void take(char c);
  void begin_tag(char c);
  void begin_declaration(char c);
  void inside_tag(char c);
  void end_tag();
  [[nodiscard]] bool ends_with(std::string_view ending) const { return std::string_view(recent_).ends_with(ending); }
  [[noreturn]] void refuse(const char* what) const;

  std::string name_;
  State state_ = State::text;
  std::int64_t position_ = 0;
  std::int64_t line_ = 1;
  std::string recent_;  ///< the last characters of a comment, a declaration or an attribute's name
  char quote_ = '"';
  char last_ = ' ';
  bool closing_ = false;
  std::int64_t tag_bytes_ = 0;
  int attributes_ = 0;
  int depth_ = 0;
};

}  // namespace lamella
