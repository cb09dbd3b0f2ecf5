#pragma once

/// One name per quantity. Nothing else in the code may invent an epsilon for these.
namespace lamella::tolerance {

/// Smallest gap in mm within which two faces touch, whatever the file states (docs/command, "touching").
inline constexpr double kMinGap = 1e-6;

/// Relative position accuracy of the certified solver: times the largest coordinate of the model.
inline constexpr double kSolverRelative = 1e-12;

/// The certified solver stops at this many units in the last place of the largest coordinate, if that is larger.
inline constexpr double kSolverUlps = 4.0;

/// Relative to the model's size: boxes of the certified solver below this are undecided (a tangency).
inline constexpr double kUndecidedRelative = 1e-9;

/// Part of a voxel that a grid may fall short of the upper bound before it gains another voxel (docs/command).
inline constexpr double kGridSlack = 1e-6;

/// Largest edge tolerance in mm, as stated by the STEP reader, up to which a solid counts as accurate.
inline constexpr double kAccurateEdge = 1e-2;

/// Shares of rays repaired and of hits uncertain above which a run ends with exit code 3.
inline constexpr double kRepairedBudget = 1e-6;
inline constexpr double kUncertainBudget = 1e-6;

}  // namespace lamella::tolerance
