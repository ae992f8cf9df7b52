// Every tolerance of the tests, each with the reason for its size. u = 2^-53.
#pragma once
#include <core/numeric/rounding.hpp>

namespace rt::tolerance {

/// Elementary functions: the bound that elementary.cpp derives, in units in the last place of the
/// exact value.
inline constexpr double kElementaryUlps = 1;
/// What the derivation leaves beyond the last rounding (sine's 0.35 u and tan's 0.45 u are the
/// largest).
inline constexpr double kElementaryUlpsDerived = 0.96;

/// IEC 61966-2-1 rounds its constants: the two branches of the curve miss each other by up
/// to 2.9e-8 (encoded).
inline constexpr double kSrgbBranchGap = 3e-8;

/// Centres that the legacy program printed with four digits, computed in single precision.
inline constexpr double kPrintedCenter = 1e-3;

/// World units: planes nearer than this to a ray's start were passed over by the program that rt replaces.
inline constexpr double kOriginalPlaneDistance = 1e-5;

/// Poses against closed forms, as a share of the scene's size: the bar of the animation issue. The
/// worst of tests/animation, 96 steps of four overlapping motions included, is below 1e-15.
inline constexpr double kClosedForm = 1e-12;

/// Relative error of a short chain of n rounded operations.
inline double roundings(int n) { return numeric::gamma(n); }

/// STABILITY.md R1: total reflection is decided right this far, in radians, from the critical angle.
inline constexpr double kCriticalAngle = 1e-12;
/// STABILITY.md R2: 1000 parallel slabs, as an angle in radians; and lengths in pictures of such.
inline constexpr double kSlabChain = 1e-12;
/// Two refractions at a ball, in radians: each sine carries a few roundings of coordinates of about 5
/// and is steepest, 1 / cos, at the largest height tested (0.9 of the radius).
inline constexpr double kBall = 1e-13;
/// An angle across the seam or beside the pole of a background, in radians: far below a texel.
inline constexpr double kSeamStep = 1e-9;
/// STABILITY.md R4: a white furnace, against 1.
inline constexpr double kFurnace = 1e-12;

/// Angle-weighted corner normals against a sum in extended precision: the bar of the mesh issue.
inline constexpr double kCornerNormal = 1e-12;
/// Angles between vectors in radians, from 2^-100 to pi, against the same.
inline constexpr double kAngle = 1e-15;

/// Numbers of other programs: half a unit of the last printed digit, a tenth more for their own f32 sums.
inline constexpr double kPrintedDigits = 1.1;

/// The authors' FLIP rounds its white point and inverse colour matrix to 9 decimals.
inline constexpr double kFlipReference = 1e-6;

/// Distance of a hit against binary128, relative: the project's bar.
inline constexpr double kHitDistance = 1e-12;
/// Geometric normals against binary128, degrees: the project's bar, for triangles as thin as 1e-6.
inline constexpr double kNormalDegrees = 1e-10;
/// Distance of o + t d from the surface of a plugin's exact shape, in u of the ray's coordinates: the project's bar for spheres.
inline constexpr double kAnalyticSurface = 8;
/// Gap between parallel surfaces that no ray may skip, relative to the coordinates: the project's bar.
inline constexpr double kSmallestGap = 1e-9;

/// STABILITY.md S1: distance of a hit from its sphere, in u max(1, D/r) r.
inline constexpr double kSphereError = 8;
/// STABILITY.md S1, S2: tangents nearer than this, in u max(1, D/r) of the radius, may go either way.
inline constexpr double kTangent = 16;
/// STABILITY.md S4: t on a ball a million times the camera's height, relative.
inline constexpr double kFloorDistance = 1e-9;
/// STABILITY.md T2: t on needles, in u times the condition of the problem.
inline constexpr double kNeedleDistance = 8;
/// STABILITY.md R1: angle of what is refracted 1e-6 rad or more from total reflection.
inline constexpr double kRefractedAngle = 1e-9;
/// STABILITY.md A1: a turned position against the closed form, relative to its distance from the axis.
inline constexpr double kTurned = 1e-12;
/// STABILITY.md C2: share of display white from which a pixel is wrong.
inline constexpr double kWrongPixel = 1.0 / 255;
/// STABILITY.md 5: the largest difference of any pixel from binary128 up to offsets of 1e6.
inline constexpr double kLargestDifference = 1e-6;

/// Distances of hits in Precision::f32, as a share of the size of the whole: coordinates are off by 2^-24, and a
/// ray that grazes a surface meets it up to 1700 times as far off, the worst that was seen in 10^5 hits.
inline constexpr double kF32Distance = 2e-4;

} // namespace rt::tolerance
