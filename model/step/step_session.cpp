#include "model/step/step_session.h"

#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Message_ProgressRange.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_DocumentFile.hxx>
#include <StepBasic_ExternalIdentificationAssignment.hxx>
#include <TCollection_HAsciiString.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <mutex>

#include "model/step/load_model.h"
#include "model/step/placement_operator.h"
#include "model/step/text.h"

namespace lamella::step {
namespace {

std::mutex& import_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// OpenCASCADE's progress as ours.
class TransferProgress : public Message_ProgressIndicator {
 public:
  explicit TransferProgress(const Progress& progress) : progress_(progress) {}
  Standard_Boolean UserBreak() override { return progress_.cancelled(); }

 protected:
  void Show(const Message_ProgressScope&, const Standard_Boolean) override {
    progress_.report("transferring", GetPosition());
  }

 private:
  const Progress& progress_;
};

}  // namespace

struct ImportGuard::State {
  std::unique_lock<std::mutex> lock{import_mutex()};
  Message_SequenceOfPrinters printers;
  bool auto_naming = true;
};

ImportGuard::ImportGuard() : state_(std::make_unique<State>()) {
  state_->printers = Message::DefaultMessenger()->Printers();
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPCAFControl_Controller::Init();
  state_->auto_naming = XCAFDoc_ShapeTool::AutoNaming();
  XCAFDoc_ShapeTool::SetAutoNaming(Standard_False);
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  Interface_Static::SetIVal("read.precision.mode", 0);
  Interface_Static::SetIVal("read.maxprecision.mode", 0);
  Interface_Static::SetIVal("read.step.product.mode", 1);
}

ImportGuard::~ImportGuard() {
  XCAFDoc_ShapeTool::SetAutoNaming(state_->auto_naming);
  Message::DefaultMessenger()->ChangePrinters() = state_->printers;
}

StepSession::StepSession(const std::string& name, const Part21& text, bool heal, const Progress& progress)
    : name_(name) {
  // The operators of a sequence that no resource defines are none.
  Interface_Static::SetCVal("read.step.sequence", heal ? "FromSTEP" : "none");
  reader_.SetColorMode(Standard_True);
  reader_.SetNameMode(Standard_True);
  reader_.SetLayerMode(Standard_True);
  reader_.SetMatMode(Standard_True);
  reader_.SetSHUOMode(Standard_True);
  reader_.SetPropsMode(Standard_False);
  reader_.SetGDTMode(Standard_False);  // throws on a sound file of NIST's, and slicing has no use for it
  reader_.SetViewMode(Standard_False);
  const Handle(XSControl_WorkSession) session = reader_.Reader().WS();
  const auto code_page = is_utf8(text.text()) ? Resource_FormatType_UTF8 : Resource_FormatType_iso8859_1;
  try {
    const auto protocol = Handle(StepData_Protocol)::DownCast(session->Protocol());
    session->SetModel(load_model(text, code_page, protocol, progress));
    constexpr int kBeginTransfer = 4;
    session->InitTransferReader(kBeginTransfer);
  } catch (const Standard_Failure& failure) {
    throw InputError(std::string("the STEP file can't be read: ") + failure.GetMessageString(), name_);
  }
  progress.throw_if_cancelled();
}

StepSession::~StepSession() {
  if (!document_.IsNull()) XCAFApp_Application::GetApplication()->Close(document_);
}

Handle(StepData_StepModel) StepSession::model() const { return reader_.Reader().StepModel(); }

Handle(Transfer_TransientProcess) StepSession::process() const {
  return reader_.Reader().WS()->TransferReader()->TransientProcess();
}

namespace {

/// Takes the file names out of external references: nothing but the file given may ever be opened.
void forget_external_files(const Handle(StepData_StepModel) & model) {
  const Handle(TCollection_HAsciiString) nothing = new TCollection_HAsciiString("");
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    if (const auto file = Handle(StepBasic_DocumentFile)::DownCast(entity)) file->SetId(nothing);
    if (const auto other = Handle(StepBasic_ExternalIdentificationAssignment)::DownCast(entity)) {
      other->SetAssignedId(nothing);
    }
  }
}

}  // namespace

void StepSession::transfer(const Progress& progress) {
  forget_external_files(model());
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document_);
  try {
    const Handle(TransferProgress) indicator = new TransferProgress(progress);
    reader_.Transfer(document_, indicator->Start());
    mirrored_uses_ = mirrored_uses(model(), process()->Graph(), name_);
  } catch (const Standard_Failure& failure) {
    progress.throw_if_cancelled();
    throw InputError(std::string("the STEP file's content can't be converted: ") + failure.GetMessageString(), name_);
  }
  progress.throw_if_cancelled();
}

}  // namespace lamella::step
