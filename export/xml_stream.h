#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamella {

/// Reads an XML file of any size element by element, in constant memory, with libxml2's reader.
///
/// Input is hostile: see XmlGuard for what is refused outright; nothing is ever fetched from a network or another file.
/// Unknown elements and attributes are errors. All members throw InputError with file and line.
class XmlStream {
 public:
  /// `name_space` is that of every element.
  XmlStream(const std::filesystem::path& file, std::string name_space);
  ~XmlStream();
  XmlStream(const XmlStream&) = delete;
  XmlStream& operator=(const XmlStream&) = delete;

  /// Whether the next thing in the current element is a child of this name.
  [[nodiscard]] bool at(std::string_view name);
  /// Goes into the next child, which must have this name and no attributes but these.
  void enter(std::string_view name, std::initializer_list<std::string_view> attributes = {});
  /// Goes out of the current element, which must have nothing more in it.
  void leave();
  /// All text up to the end of the current element, which has no children.
  [[nodiscard]] std::string text();
  /// Reads on to the end of the file, which must hold nothing more.
  void finish();

  /// Attributes of the element entered last.
  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] std::string attribute(std::string_view name) const;
  [[nodiscard]] double number(std::string_view name) const;
  /// NaN when the attribute is absent.
  [[nodiscard]] double number_or_unknown(std::string_view name) const;
  [[nodiscard]] std::int64_t integer(std::string_view name, std::int64_t least, std::int64_t most) const;
  /// Exactly `count` numbers.
  [[nodiscard]] std::vector<double> numbers(std::string_view name, std::size_t count) const;

  /// Bytes read so far.
  [[nodiscard]] std::int64_t bytes_read() const;
  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const;

 private:
  struct Reader;
  std::unique_ptr<Reader> reader_;
};

}  // namespace lamella
