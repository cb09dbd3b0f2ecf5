#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>

#include "export/xml_guard.h"

// libxml2's own names, declared here so that only sources include its headers.
struct _xmlError;
struct _xmlTextReader;

namespace lamella {

/// A file opened for libxml2's reader with everything switched off that could reach beyond the file, every byte seen by
/// an XmlGuard first.
class XmlInput {
 public:
  /// What to do with a violation of the schema that the reader validates against.
  using OnInvalid = std::function<void(std::int64_t line, const std::string& what)>;

  /// Throws InputError when the file can't be read.
  explicit XmlInput(const std::filesystem::path& file, OnInvalid on_invalid = {});
  XmlInput(const XmlInput&) = delete;
  XmlInput& operator=(const XmlInput&) = delete;

  [[nodiscard]] _xmlTextReader* get() const { return reader_.get(); }
  /// Advances to the next node; false at the end of the file. Throws InputError when the XML isn't well-formed or is
  /// refused.
  bool read();

  /// Line of the current node (an estimate beyond 65534, where libxml2 stops counting nodes' lines).
  [[nodiscard]] std::int64_t line() const;
  [[nodiscard]] std::int64_t bytes_read() const { return bytes_read_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  static int on_read(void* self, char* buffer, int length);
  static void on_error(void* self, _xmlError* error);

  struct Free {
    void operator()(_xmlTextReader* reader) const;
  };

  std::string name_;
  OnInvalid on_invalid_;
  std::ifstream stream_;
  XmlGuard guard_;
  std::exception_ptr refusal_;
  std::string error_;  ///< libxml2's first complaint
  int error_line_ = 0;
  std::int64_t bytes_read_ = 0;
  std::unique_ptr<_xmlTextReader, Free> reader_;
};

}  // namespace lamella
