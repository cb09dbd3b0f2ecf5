#include "model/step/load_model.h"

#include <Interface_ParamType.hxx>
#include <StepData_StepReaderData.hxx>
#include <StepData_StepReaderTool.hxx>
#include <algorithm>
#include <limits>
#include <memory_resource>
#include <string>
#include <vector>

#include "core/error.h"
#include "model/step/entity_label.h"
#include "model/step/part21_lexer.h"

namespace lamella::step {
namespace {

Interface_ParamType type_of(const Value& value) {
  switch (value.kind) {
    case Value::Kind::missing:
      return Interface_ParamVoid;
    case Value::Kind::derived:
      return Interface_ParamMisc;
    case Value::Kind::number: {
      const bool whole = value.written.find_first_not_of("+-0123456789") == std::string_view::npos;
      return whole ? Interface_ParamInteger : Interface_ParamReal;
    }
    case Value::Kind::text:
      return Interface_ParamText;
    case Value::Kind::enumeration:
      return Interface_ParamEnum;
    case Value::Kind::reference:
      return Interface_ParamIdent;
    case Value::Kind::binary:
      return Interface_ParamHexa;
    case Value::Kind::list:
    case Value::Kind::typed:
      break;
  }
  return Interface_ParamSub;
}

/// What OpenCASCADE does with them grows with their square. Nets of control points have a list a row.
constexpr std::size_t kMaxLists = 10'000;
constexpr std::size_t kMaxParts = 1'000;

InputError too_much(const char* where, const char* what, std::size_t limit) {
  return InputError("more than " + std::to_string(limit) + " " + what, where, "is the file damaged?");
}

/// OpenCASCADE's records: one for each entity, each part of a complex one, and each list within, which stands before
/// the record it is in and is named "$n", the nth that is opened in its part.
class Records {
 public:
  /// Throws Cancelled.
  Records(const Part21& file, const Progress& progress);
  [[nodiscard]] Handle(StepData_StepReaderData) reader_data(Resource_FormatType code_page) const;

 private:
  struct Argument {
    const char* word = nullptr;
    Interface_ParamType type = Interface_ParamMisc;
  };
  struct Record {
    const char* ident = nullptr;
    const char* type = nullptr;
    std::size_t end = 0;  ///< of its arguments, which begin where the last record's end
  };

  void add_statement(const char* ident, const std::vector<Part>& parts);
  void add_record(const char* ident, const char* type, const std::vector<Value>& values);
  Argument add_value(const Value& value);
  const char* list_name(std::size_t n);
  /// A copy that ends in a zero and lives as long as the records, which don't copy it.
  const char* keep(std::string_view word);

  std::pmr::monotonic_buffer_resource words_;
  std::vector<Record> records_;
  std::vector<Argument> arguments_;
  std::vector<Argument> open_;           ///< arguments of the records that aren't ended yet
  std::vector<const char*> list_names_;  ///< "$1", "$2", ...
  const char* ident_ = nullptr;          ///< of the current entity
  std::size_t lists_ = 0;                ///< of its current part
  std::size_t header_size_ = 0;
};

constexpr const char* kNoIdent = "#0";  ///< of the header's records, and of a complex entity's further parts

Records::Records(const Part21& file, const Progress& progress) : words_(file.text().size() + 1) {
  for (const std::string_view statement : file.header()) add_statement(kNoIdent, Parser(statement).parts());
  header_size_ = records_.size();
  std::size_t done = 0;
  for (const Entity& entity : file.entities()) {
    if (done++ % 4096 == 0) {
      progress.throw_if_cancelled();
      // The first part of the stage was the check of the text.
      progress.report("reading", 0.3 + 0.3 * static_cast<double>(done) / static_cast<double>(file.entities().size()));
    }
    add_statement(keep(label_of(entity.number)), file.parts(entity));
  }
}

void Records::add_statement(const char* ident, const std::vector<Part>& parts) {
  if (parts.size() > kMaxParts) throw too_much(ident, "parts", kMaxParts);
  ident_ = ident;
  for (const Part& part : parts) {
    lists_ = 0;
    add_record(ident, keep(part.written), part.values);
    ident = kNoIdent;
  }
}

void Records::add_record(const char* ident, const char* type, const std::vector<Value>& values) {
  const std::size_t first = open_.size();
  for (const Value& value : values) open_.push_back(add_value(value));
  arguments_.insert(arguments_.end(), open_.begin() + static_cast<std::ptrdiff_t>(first), open_.end());
  open_.resize(first);
  records_.push_back({ident, type, arguments_.size()});
}

Records::Argument Records::add_value(const Value& value) {
  const Interface_ParamType type = type_of(value);
  if (type != Interface_ParamSub) return {keep(value.written), type};
  static constexpr const char* kPlainList = "/* (SUB) */";
  const char* name = list_name(++lists_);
  if (lists_ > kMaxLists) throw too_much(ident_, "lists", kMaxLists);
  add_record(name, value.is(Value::Kind::list) ? kPlainList : keep(value.written), value.items);
  return {name, type};
}

const char* Records::list_name(std::size_t n) {
  while (list_names_.size() < n) {
    std::string name = std::to_string(list_names_.size() + 1);
    list_names_.push_back(keep(name.insert(0, 1, '$')));
  }
  return list_names_[n - 1];
}

const char* Records::keep(std::string_view word) {
  char* const copy = static_cast<char*>(words_.allocate(word.size() + 1, 1));
  *std::copy(word.begin(), word.end(), copy) = '\0';
  return copy;
}

Handle(StepData_StepReaderData) Records::reader_data(Resource_FormatType code_page) const {
  constexpr std::size_t kMaxCount = std::numeric_limits<int>::max();
  if (std::max(records_.size(), arguments_.size()) > kMaxCount) throw too_much("DATA", "values", kMaxCount);
  const auto count = static_cast<int>(records_.size());
  const Handle(StepData_StepReaderData) data = new StepData_StepReaderData(
      static_cast<int>(header_size_), count, static_cast<int>(arguments_.size()), code_page);
  std::size_t argument = 0;
  for (int i = 1; i <= count; ++i) {
    const Record& record = records_[static_cast<std::size_t>(i) - 1];
    data->SetRecord(i, record.ident, record.type, static_cast<int>(record.end - argument));
    for (; argument < record.end; ++argument)
      data->AddStepParam(i, arguments_[argument].word, arguments_[argument].type);
    data->InitParams(i);
  }
  return data;
}

}  // namespace

Handle(StepData_StepModel) load_model(const Part21& file, Resource_FormatType code_page,
                                      const Handle(StepData_Protocol) & protocol, const Progress& progress) {
  const Records records(file, progress);
  const Handle(StepData_StepModel) model = new StepData_StepModel;
  model->SetSourceCodePage(code_page);
  StepData_StepReaderTool tool(records.reader_data(code_page), protocol);
  tool.SetErrorHandle(Standard_True);
  tool.PrepareHeader({});
  tool.Prepare({});
  tool.LoadModel(model);
  if (model->Protocol().IsNull()) model->SetProtocol(protocol);
  return model;
}

}  // namespace lamella::step
