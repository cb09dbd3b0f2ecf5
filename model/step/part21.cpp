#include "model/step/part21.h"

#include <algorithm>
#include <charconv>
#include <limits>

#include "model/step/part21_lexer.h"

namespace lamella::step {
namespace {

constexpr std::size_t kMaxFaults = 50;

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return result;
}

}  // namespace

std::vector<int> Value::refs() const {
  std::vector<int> result;
  for (const Value& item : items) {
    if (item.ref() != 0) result.push_back(item.ref());
  }
  return result;
}

double Value::real_or(double fallback) const {
  if (is(Kind::number)) return number;
  return is(Kind::typed) && items.size() == 1 ? items.front().real_or(fallback) : fallback;
}

bool Value::is_true(bool fallback) const {
  if (!is(Kind::enumeration)) return fallback;
  return text == "T" || text == "t";
}

const Value& Part::operator[](std::size_t i) const {
  static const Value kMissing;
  return i < values.size() ? values[i] : kMissing;
}

Part21::Part21(std::string_view text, const Progress& progress) : text_(text) { index(progress); }

void Part21::add_fault(int line, int entity, std::string what) {
  if (faults_.size() < kMaxFaults) faults_.push_back({line, entity, std::move(what)});
}

/// One pass that cuts the text into statements at the semicolons outside strings and comments.
void Part21::index(const Progress& progress) {
  std::size_t next_report = 0;
  Scanner scanner(text_);
  while (true) {
    const Scanner::Statement statement = scanner.next();
    line_ = scanner.line();
    if (statement.fault != nullptr) add_fault(statement.line, 0, statement.fault);
    if (statement.at_end) break;
    const std::string_view words = text_.substr(statement.begin, statement.end - statement.begin);
    if (!seen_any_) recognised_ = words == "ISO-10303-21";
    seen_any_ = true;
    index_statement(statement.begin, statement.end, statement.line);
    if (statement.end >= next_report) {
      progress.throw_if_cancelled();
      progress.report("reading", 0.3 * static_cast<double>(statement.end) / static_cast<double>(text_.size()));
      next_report = statement.end + (std::size_t{1} << 20);
    }
  }
}

void Part21::index_statement(std::size_t begin, std::size_t end, int line) {
  const std::string_view statement = text_.substr(begin, end - begin);
  if (statement.starts_with('#')) return index_entity(statement, begin, line);
  const std::string word = upper(statement.substr(0, 64));
  if (word == "DATA" || word.starts_with("DATA(") || word.starts_with("DATA ")) {
    in_data_ = true;
  } else if (word == "ENDSEC") {
    in_data_ = false;
  } else if (word == "END-ISO-10303-21") {
    complete_ = !in_data_;
  } else if (in_data_) {
    add_fault(line, 0, "a statement that is no entity");
  } else {
    index_header(statement);
  }
}

void Part21::index_header(std::string_view statement) {
  const std::vector<Part> parts = Parser(statement).parts();
  if (!parts.empty()) header_.push_back(statement);
  for (const Part& part : parts) {
    if (part.keyword != "FILE_SCHEMA" || part[0].items.empty()) continue;
    schema_ = decode_string(part[0].items.front().text);
  }
}

void Part21::index_entity(std::string_view statement, std::size_t begin, int line) {
  int number = 0;
  const auto [after, error] = std::from_chars(statement.data() + 1, statement.data() + statement.size(), number);
  std::size_t i = static_cast<std::size_t>(after - statement.data());
  if (error != std::errc() || number <= 0) return add_fault(line, 0, "an entity number that can't be read");
  while (i < statement.size() && is_space(statement[i])) ++i;
  if (i >= statement.size() || statement[i] != '=') return add_fault(line, number, "'=' is missing after the number");
  ++i;
  const std::size_t size = statement.size() - i;
  if (size > std::numeric_limits<std::uint32_t>::max()) return add_fault(line, number, "the entity is too long");
  const KeywordScan scan = scan_keywords(statement.substr(i));
  if (scan.fault != nullptr) return add_fault(line, number, scan.fault);
  const auto position = static_cast<std::uint32_t>(entities_.size());
  if (!by_number_.emplace(number, position).second) return add_fault(line, number, "the number is used twice");
  entities_.push_back({number, line, begin + i, static_cast<std::uint32_t>(size)});
  for (const std::string_view keyword : scan.keywords) by_keyword_[upper(keyword)].push_back(position);
  if (!Parser(statement.substr(i)).parts().empty() || unreadable_.entity != 0) return;
  unreadable_ = {
      line, number,
      "an attribute is no value (a number that is malformed, infinite or none?), or something follows the entity"};
}

void Part21::blank_entity(std::string& text, int number) const {
  const Entity* entity = find(number);
  if (entity == nullptr) return;
  const std::size_t hash = text.rfind('#', entity->begin);
  const std::size_t end = text.find(';', entity->begin + entity->size);
  for (std::size_t i = hash; i < std::min(end + 1, text.size()); ++i) {
    if (text[i] != '\n') text[i] = ' ';
  }
}

const Entity* Part21::find(int number) const {
  const auto found = by_number_.find(number);
  return found == by_number_.end() ? nullptr : &entities_[found->second];
}

std::vector<int> Part21::with_keyword(const std::string& keyword) const {
  std::vector<int> result;
  const auto found = by_keyword_.find(keyword);
  if (found == by_keyword_.end()) return result;
  for (const std::uint32_t position : found->second) result.push_back(entities_[position].number);
  return result;
}

std::vector<Part> Part21::parts(int number) const {
  const Entity* entity = find(number);
  return entity == nullptr ? std::vector<Part>() : parts(*entity);
}

std::vector<Part> Part21::parts(const Entity& entity) const {
  return Parser(text_.substr(entity.begin, entity.size)).parts();
}

Part Part21::part(int number, std::string_view keyword) const {
  for (Part& candidate : parts(number)) {
    if (keyword.empty() || candidate.keyword == keyword) return std::move(candidate);
  }
  return {};
}

std::string Part21::keyword_of(int number) const {
  const Entity* entity = find(number);
  if (entity == nullptr) return {};
  const KeywordScan scan = scan_keywords(text_.substr(entity->begin, entity->size));
  if (scan.keywords.size() == 1) return upper(scan.keywords.front());
  std::string result = "(";
  for (const std::string_view keyword : scan.keywords) {
    if (result.size() > 1) result += ' ';
    result += upper(keyword);
  }
  return result += ')';
}

std::vector<int> Part21::references(const Entity& entity) const {
  return scan_references(text_.substr(entity.begin, entity.size));
}

}  // namespace lamella::step
