#include "model/step/load_model.h"

#include <BRepPrimAPI_MakeBox.hxx>
#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_ReportEntity.hxx>
#include <STEPControl_Controller.hxx>
#include <StepData_StepWriter.hxx>
#include <StepData_WriterLib.hxx>
#include <StepFile_Read.hxx>
#include <XSControl_WorkSession.hxx>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>

#include "model/step/text.h"
#include "tests/model/step/step_files.h"
#include "tests/support/corpus.h"

namespace lamella::step {
namespace {

using test::CorpusFile;
using test::read_text;
using test::replaced;
using ::testing::HasSubstr;

Handle(StepData_Protocol) protocol() {
  STEPControl_Controller::Init();
  const Handle(XSControl_WorkSession) session = new XSControl_WorkSession;
  session->SelectNorm("STEP");
  return Handle(StepData_Protocol)::DownCast(session->Protocol());
}

Resource_FormatType code_page_of(const std::string& text) {
  return is_utf8(text) ? Resource_FormatType_UTF8 : Resource_FormatType_iso8859_1;
}

Handle(StepData_StepModel) load(const std::string& text) {
  const auto with = protocol();
  return load_model(Part21(text), code_page_of(text), with, {});
}

/// By OpenCASCADE's own lexer.
Handle(StepData_StepModel) read_by_opencascade(const std::string& text) {
  const auto with = protocol();
  const Handle(StepData_StepModel) model = new StepData_StepModel;
  model->SetSourceCodePage(code_page_of(text));
  std::istringstream stream(text);
  EXPECT_EQ(StepFile_Read("text", &stream, model, with), 0);
  return model;
}

/// Every entity as OpenCASCADE writes it, or what its reading complained about: the writer puts that into a comment,
/// and never ends when it is longer than a line.
std::string dump(const Handle(StepData_StepModel) & model) {
  std::ostringstream out;
  StepData_StepWriter writer(model);
  const StepData_WriterLib library(protocol());
  for (Interface_EntityIterator header = model->Header(); header.More(); header.Next()) {
    out << header.Value()->DynamicType()->Name() << '\n';
  }
  for (int i = 1; i <= model->NbEntities(); ++i) {
    out << model->Value(i)->DynamicType()->Name() << '\n';
    const Handle(Interface_ReportEntity) report = model->ReportEntity(i);
    if (report.IsNull()) {
      writer.SendEntity(i, library);
      continue;
    }
    out << '#' << model->IdentLabel(model->Value(i));
    for (int k = 1; k <= report->Check()->NbFails(); ++k) out << ' ' << report->Check()->CFail(k);
    for (int k = 1; k <= report->Check()->NbWarnings(); ++k) out << ' ' << report->Check()->CWarning(k);
  }
  writer.Print(out);
  return out.str();
}

std::string sample() {
  const auto path = std::filesystem::path(::testing::TempDir()) / "lamella_load_model_test.step";
  test::write_part(path, BRepPrimAPI_MakeBox(1, 2, 3).Shape(), "box", {1, 0, 0}, "layer", {"steel", 7.85});
  return read_text(path);
}

void expect_same(const std::string& text) {
  ASSERT_FALSE(Part21(text).entities().empty());
  const std::string ours = dump(load(text));
  const std::string theirs = dump(read_by_opencascade(text));
  EXPECT_GT(ours.size(), text.size() / 4) << "all of it is there";
  if (ours == theirs) return;
  const auto at = static_cast<std::size_t>(std::mismatch(ours.begin(), ours.end(), theirs.begin(), theirs.end()).first -
                                           ours.begin());
  const std::size_t from = at < 200 ? 0 : at - 200;
  FAIL() << "ours:\n" << ours.substr(from, 400) << "\nOpenCASCADE's:\n" << theirs.substr(from, 400);
}

TEST(LoadModel, MakesWhatOpenCascadesReaderMakes) { expect_same(sample()); }

TEST(LoadModel, TakesCommentsBlanksAndStringsAsOpenCascadeDoes) {
  std::string text = replaced(sample(), "'box'", "'it''s;\n(a ''box''; #1)' \r\n");
  text = replaced(text, ",(0.,0.,0.))", " , /* (9.,9.) */ ( 0.\n,\t-0.E+0 ,0.0 ) )");
  expect_same(replaced(text, "\nDATA;", "\n/* #1=A(); */DATA;"));
}

TEST(LoadModel, ReadsWhatOpenCascadesLexerDoesNot) {
  const std::string text = sample();
  const std::string same = dump(load(text));
  EXPECT_EQ(dump(load(replaced(text, "'box'", "'box'\v\t/* ','(( */"))), same) << "a string ends before a comment";
  EXPECT_EQ(dump(load(replaced(text, ",(1.,0.,0.))", ",(10.e-1,\v0.,\f0.))"))), same);
  EXPECT_EQ(dump(load(replaced(text, "#10 = ", "ENDSEC;\nDATA;\n#10 = "))), same);
}

TEST(LoadModel, KeepsLatinLetters) { expect_same(replaced(sample(), "'box'", "'B\xFCgel \\X\\E4'")); }

TEST(LoadModel, ReportsWhatAnEntityLacksAsOpenCascadeDoes) {
  const std::string text = sample();
  const std::string wrong = replaced(text, ",(0.,0.,0.))", ",(0.,.T.,$))");
  expect_same(wrong);
  EXPECT_THAT(dump(load(wrong)), HasSubstr("Real"));
  expect_same(replaced(text, "CARTESIAN_POINT('',(0.,0.,0.))", "CARTESIAN_POINT('')"));
  expect_same(
      replaced(text, "CARTESIAN_POINT('',(0.,0.,0.))", "CARTESIAN_PINT('',(0.,0.,0.),\"0F\",A((1),B(2)),#999999,*)"));
}

TEST(LoadModel, RefusesEntitiesThatTakeOpenCascadeTooLong) {
  const auto end = std::string("ENDSEC;\nEND-ISO");
  std::string lists;
  for (int i = 0; i < 20000; ++i) lists += "(1),";
  EXPECT_THROW((void)load(replaced(sample(), end, "#9999=A(" + lists + "$);\n" + end)), InputError);
  std::string parts;
  for (int i = 0; i < 2000; ++i) parts += "A(1)";
  EXPECT_THROW((void)load(replaced(sample(), end, "#9999=(" + parts + ");\n" + end)), InputError);
}

TEST(LoadModel, EndsWhenCancelled) {
  const std::string text = sample();
  const std::atomic<bool> cancel = true;
  const Part21 file(text);
  EXPECT_THROW((void)load_model(file, Resource_FormatType_UTF8, protocol(), Progress({}, &cancel)), Cancelled);
}

class LoadModelCorpus : public ::testing::TestWithParam<CorpusFile> {};

TEST_P(LoadModelCorpus, MakesWhatOpenCascadesReaderMakes) { expect_same(read_text(GetParam().path())); }

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(LoadModelCorpus);
INSTANTIATE_TEST_SUITE_P(Files, LoadModelCorpus, ::testing::ValuesIn(test::corpus_files("ok")),
                         [](const auto& tested) { return test::test_name(tested.param); });

}  // namespace
}  // namespace lamella::step
