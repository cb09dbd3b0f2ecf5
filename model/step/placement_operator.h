#pragma once

#include <Interface_Graph.hxx>
#include <StepData_StepModel.hxx>
#include <string>
#include <vector>

/// Private to model/step: placements that the import reads as less than they say.
namespace lamella::step {

/// The NEXT_ASSEMBLY_USAGE_OCCURRENCEs whose CARTESIAN_TRANSFORMATION_OPERATOR_3D is left-handed. The import takes
/// axis 1, axis 3 and origin of such an operator, so it places the instance without its mirror image in axis 2.
/// Throws InputError for operators that this reader can't follow: those that scale, or that mirror an item mapped
/// into a shape or a placement stated from the assembly to the part. `name` is the file's.
[[nodiscard]] std::vector<Handle(Standard_Transient)> mirrored_uses(const Handle(StepData_StepModel) & model,
                                                                    const Interface_Graph& graph,
                                                                    const std::string& name);

}  // namespace lamella::step
