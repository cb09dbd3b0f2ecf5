#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/progress.h"

/// Private to model/step: a STEP file's entities as they are written (ISO 10303-21), before any import heals them.
namespace lamella::step {

/// One attribute's value.
struct Value {
  enum class Kind { missing, derived, number, text, enumeration, reference, list, typed, binary };
  Kind kind = Kind::missing;
  double number = 0.0;       ///< number
  int reference = 0;         ///< reference: the entity's number
  std::string_view text;     ///< text (as in the file, without the outer quotes), enumeration (without dots), typed
  std::string_view written;  ///< as in the file, with quotes and dots; typed: the keyword; list: nothing
  std::vector<Value> items;  ///< list; typed: the one value inside

  [[nodiscard]] bool is(Kind k) const { return kind == k; }
  /// Number of the entity referred to, 0 when the value isn't a reference.
  [[nodiscard]] int ref() const { return is(Kind::reference) ? reference : 0; }
  /// Entities a list refers to.
  [[nodiscard]] std::vector<int> refs() const;
  /// The number, also inside a typed value such as LENGTH_MEASURE(25.4); `fallback` when it is none.
  [[nodiscard]] double real_or(double fallback) const;
  [[nodiscard]] bool is_true(bool fallback = true) const;
};

/// A keyword with its attributes; a complex entity has several.
struct Part {
  std::string keyword;       ///< upper case
  std::string_view written;  ///< the keyword as in the file
  std::vector<Value> values;

  /// The attribute at `i`, a missing value beyond the end.
  [[nodiscard]] const Value& operator[](std::size_t i) const;
};

/// Where an entity stands in the text.
struct Entity {
  int number = 0;
  int line = 0;
  std::uint64_t begin = 0;  ///< of what follows the '='
  std::uint32_t size = 0;   ///< up to the ';'
};

struct SyntaxFault {
  int line = 0;
  int entity = 0;  ///< 0 outside entities
  std::string what;
};

/// Index of a file's entities. Holds views of the text, which must outlive it. Time and memory are linear in the text.
class Part21 {
 public:
  explicit Part21(std::string_view text, const Progress& progress = {});

  [[nodiscard]] std::string_view text() const { return text_; }
  [[nodiscard]] const std::vector<Entity>& entities() const { return entities_; }
  /// Null when the file has no such entity.
  [[nodiscard]] const Entity* find(int number) const;
  /// Entities with this keyword (upper case), complex ones by each of their parts, in the file's order.
  [[nodiscard]] std::vector<int> with_keyword(const std::string& keyword) const;
  /// By keyword (upper case) the places of its entities in entities(), ascending; complex ones by each of their parts.
  [[nodiscard]] const std::unordered_map<std::string, std::vector<std::uint32_t>>& by_keyword() const {
    return by_keyword_;
  }
  [[nodiscard]] bool has(const std::string& keyword) const { return by_keyword_.contains(keyword); }
  /// The keywords of the entity, "A", or "(A B C)" for a complex one.
  [[nodiscard]] std::string keyword_of(int number) const;

  /// All parts, in the file's order; empty when there is no such entity or it doesn't parse.
  [[nodiscard]] std::vector<Part> parts(int number) const;
  [[nodiscard]] std::vector<Part> parts(const Entity& entity) const;
  /// The only part, or that with this keyword; a part without values when there is none.
  [[nodiscard]] Part part(int number, std::string_view keyword = {}) const;
  /// Every entity this one refers to, in order, repeats included.
  [[nodiscard]] std::vector<int> references(const Entity& entity) const;

  /// The statements outside DATA that parse, without their semicolons, in the file's order.
  [[nodiscard]] const std::vector<std::string_view>& header() const { return header_; }
  /// First string of FILE_SCHEMA, empty when there is none.
  [[nodiscard]] const std::string& schema() const { return schema_; }
  /// At most 50, in the file's order. What statements with faults say is left out of the index.
  [[nodiscard]] const std::vector<SyntaxFault>& faults() const { return faults_; }
  /// Overwrites an entity with spaces in `text`, the text this was made of.
  void blank_entity(std::string& text, int number) const;
  /// The first entity in sound brackets that holds something which is no value (NAN, 1.E400, --3.); number 0 if none.
  [[nodiscard]] const SyntaxFault& unreadable() const { return unreadable_; }
  /// Whether the text begins as a STEP file does.
  [[nodiscard]] bool recognised() const { return recognised_; }
  /// Whether DATA and the file are ended as they must be; false for a file cut short.
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] int lines() const { return line_; }

 private:
  void index(const Progress& progress);
  void index_statement(std::size_t begin, std::size_t end, int line);
  void index_entity(std::string_view statement, std::size_t begin, int line);
  void index_header(std::string_view statement);
  void add_fault(int line, int entity, std::string what);

  std::string_view text_;
  std::vector<std::string_view> header_;
  std::vector<Entity> entities_;
  std::unordered_map<int, std::uint32_t> by_number_;
  std::unordered_map<std::string, std::vector<std::uint32_t>> by_keyword_;
  std::vector<SyntaxFault> faults_;
  SyntaxFault unreadable_;
  std::string schema_;
  bool seen_any_ = false;
  bool recognised_ = false;
  bool complete_ = false;
  bool in_data_ = false;
  int line_ = 1;
};

/// A string of the file as UTF-8: directives \S\ \P.\ \X\ \X2\ \X4\ and doubled quotes resolved, raw high bytes kept as
/// they are if they are UTF-8, else taken as Latin-1.
[[nodiscard]] std::string decode_string(std::string_view text);

}  // namespace lamella::step
