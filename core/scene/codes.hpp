// The error codes of validation. explanations.cpp says what each means.
#pragma once
#include <core/scene/diagnostic.hpp>

namespace rt::scene::codes {

inline constexpr Code kUnknownKey{301};
inline constexpr Code kMissingKey{302};
inline constexpr Code kWrongKind{303};
inline constexpr Code kNotANumber{304};
inline constexpr Code kNotFinite{305};
inline constexpr Code kOutOfRange{306};
inline constexpr Code kNotWhole{307};
inline constexpr Code kAngle{308};
inline constexpr Code kColor{309};
inline constexpr Code kChoice{310};
inline constexpr Code kBool{311};
inline constexpr Code kLength{312};
inline constexpr Code kDuplicateName{313};
inline constexpr Code kName{314};
inline constexpr Code kUnknownMaterial{315};
inline constexpr Code kUnknownTexture{316};
inline constexpr Code kUnknownType{317};
inline constexpr Code kZeroScale{318};
inline constexpr Code kDirection{319};
inline constexpr Code kBounds{320};
inline constexpr Code kExclusive{321};
inline constexpr Code kVersion{322};
inline constexpr Code kPath{323};
inline constexpr Code kNoLoader{324};
inline constexpr Code kOneType{325};
inline constexpr Code kFrames{326};
inline constexpr Code kTarget{327};
inline constexpr Code kMotion{328};
inline constexpr Code kKeyframes{329};
inline constexpr Code kOverlap{330};
inline constexpr Code kOverride{331};
inline constexpr Code kTextureCycle{349};
inline constexpr Code kTooManyPixels{713};
inline constexpr Code kNoPlugin{520};
inline constexpr Code kReservedRow{521};
inline constexpr Code kBadFallback{522};
inline constexpr Code kTypeName{523};

} // namespace rt::scene::codes
