#pragma once

#include <STEPCAFControl_Reader.hxx>
#include <TDocStd_Document.hxx>
#include <memory>
#include <string>
#include <vector>

#include "core/progress.h"
#include "model/step/entity_index.h"
#include "model/step/part21.h"

/// Private to model/step: one run of OpenCASCADE's STEP import.
namespace lamella::step {

/// Holds OpenCASCADE's process-wide settings as this reader needs them, and its messages off the terminal, for as long
/// as it lives. Only one lives at a time; others wait.
class ImportGuard {
 public:
  ImportGuard();
  ~ImportGuard();
  ImportGuard(const ImportGuard&) = delete;
  ImportGuard& operator=(const ImportGuard&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The import of one file's text.
class StepSession {
 public:
  /// Reads `text` of the file `name`, all of whose entities parse; `heal` lets the import repair shapes. Throws
  /// InputError, Cancelled.
  StepSession(const std::string& name, const Part21& text, bool heal, const Progress& progress);
  ~StepSession();

  /// Makes shapes of the entities; no file is read. Throws InputError, Cancelled.
  void transfer(const Progress& progress);

  [[nodiscard]] const Handle(TDocStd_Document) & document() const { return document_; }
  [[nodiscard]] Handle(StepData_StepModel) model() const;
  [[nodiscard]] Handle(Transfer_TransientProcess) process() const;
  [[nodiscard]] EntityIndex entities() const { return {model(), process(), mirrored_uses_}; }

 private:
  std::string name_;
  STEPCAFControl_Reader reader_;
  Handle(TDocStd_Document) document_;
  std::vector<Handle(Standard_Transient)> mirrored_uses_;
};

}  // namespace lamella::step
