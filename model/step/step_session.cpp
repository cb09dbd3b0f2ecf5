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
#include <algorithm>
#include <istream>
#include <mutex>
#include <streambuf>

#include "model/step/placement_operator.h"
#include "model/step/text.h"

namespace lamella::step {
namespace {

std::mutex& import_mutex() {
  static std::mutex mutex;
  return mutex;
}

/// Hands a text to the parser in pieces, so that progress shows and a cancel ends the reading at the next piece.
class TextSource : public std::streambuf {
 public:
  TextSource(std::string_view text, const Progress& progress) : text_(text), progress_(progress) {}

 protected:
  int_type underflow() override {
    if (next_ >= text_.size() || progress_.cancelled()) return traits_type::eof();
    // The first part of the stage was the check of the text.
    progress_.report("reading", 0.3 + 0.7 * static_cast<double>(next_) / static_cast<double>(text_.size()));
    constexpr std::size_t kPiece = std::size_t{1} << 20;
    const std::size_t size = std::min(kPiece, text_.size() - next_);
    // The stream only reads; its interface wants pointers to non-const.
    char* begin = const_cast<char*>(text_.data()) + next_;
    setg(begin, begin, begin + size);
    next_ += size;
    return traits_type::to_int_type(*begin);
  }

 private:
  std::string_view text_;
  const Progress& progress_;
  std::size_t next_ = 0;
};

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

StepSession::StepSession(const std::string& name, std::string_view text, bool heal, const Progress& progress)
    : name_(name) {
  // The operators of a sequence that no resource defines are none.
  Interface_Static::SetCVal("read.step.sequence", heal ? "FromSTEP" : "none");
  Interface_Static::SetCVal("read.step.codepage", is_utf8(text) ? "UTF8" : "ISO8859-1");
  reader_.SetColorMode(Standard_True);
  reader_.SetNameMode(Standard_True);
  reader_.SetLayerMode(Standard_True);
  reader_.SetMatMode(Standard_True);
  reader_.SetSHUOMode(Standard_True);
  reader_.SetPropsMode(Standard_False);
  reader_.SetGDTMode(Standard_False);  // throws on a sound file of NIST's, and slicing has no use for it
  reader_.SetViewMode(Standard_False);
  TextSource source(text, progress);
  std::istream stream(&source);
  try {
    const IFSelect_ReturnStatus status = reader_.ChangeReader().ReadStream(name.c_str(), stream);
    progress.throw_if_cancelled();
    if (status != IFSelect_RetDone) throw InputError("not a readable STEP file", name_);
  } catch (const Standard_Failure& failure) {
    progress.throw_if_cancelled();
    throw InputError(std::string("the STEP file can't be read: ") + failure.GetMessageString(), name_);
  }
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
