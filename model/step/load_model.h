#pragma once

#include <StepData_Protocol.hxx>
#include <StepData_StepModel.hxx>

#include "core/progress.h"
#include "model/step/part21.h"

/// Private to model/step: from a text's statements to OpenCASCADE's entities.
namespace lamella::step {

/// The entities of a file, as OpenCASCADE's own reader makes them, without its lexer: that asks its stream for one
/// character at a time and takes two thirds of the reading. Its check of the records and all that follows is the
/// same. Every entity of `file` must parse. Throws InputError for entities of too many lists or
/// parts, Standard_Failure, Cancelled.
[[nodiscard]] Handle(StepData_StepModel)
    load_model(const Part21& file, Resource_FormatType code_page, const Handle(StepData_Protocol) & protocol,
               const Progress& progress);

}  // namespace lamella::step
